"""`tpvqa dataset`, the commands about sets of pictures."""
