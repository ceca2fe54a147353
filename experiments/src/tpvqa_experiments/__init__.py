"""The experiments of tpvqa: the paper's, and that of the belief monitor."""
