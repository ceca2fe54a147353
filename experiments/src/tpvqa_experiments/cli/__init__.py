"""`tpvqa bench`, the commands of the experiments."""
