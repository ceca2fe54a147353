"""The paper's simulator on a set of pictures: needs no renderer at run time."""
