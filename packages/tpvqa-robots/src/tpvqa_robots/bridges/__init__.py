"""Other people's frameworks on one side, a trial of tpvqa on the other."""
