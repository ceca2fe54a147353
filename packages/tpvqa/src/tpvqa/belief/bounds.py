"""How far anything that was answered or sensed is believed, however sure it is of itself."""

BOUND = 6.0
"""No single answer is worth more than this log likelihood ratio (odds of 403 to 1): a network that
is sure of itself is still wrong now and then, in ways that no training set of its size shows. Nor
is a single reading of a sensor."""
EDGE = 1e-4
"""P(yes) is cut to [EDGE, 1 - EDGE]: what is beyond says how a number was rounded."""
