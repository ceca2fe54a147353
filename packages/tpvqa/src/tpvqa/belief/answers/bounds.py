"""How far anything that was answered or sensed is believed, however sure it is of itself, and how
much of it is counted."""

from typing import Annotated

from pydantic import Field

BOUND = 6.0
"""No single answer is worth more than this log likelihood ratio (odds of 403 to 1): a network that
is sure of itself is still wrong now and then, in ways that no training set of its size shows. Nor
is a single reading of a sensor."""
EDGE = 1e-4
"""P(yes) is cut to [EDGE, 1 - EDGE]: what is beyond says how a number was rounded."""
MOST = 1e6
"""So many cases of anything, at most: more would never be unlearned."""
Counted = Annotated[int, Field(ge=0, le=10**15, strict=True)]
"""How much something was learned from, as files tell it."""
