"""Kinds of domains known from planning competitions, written anew, with problems drawn by chance.

What happens in them is that of the domains of these names; words and problems are of our own. What
would be used up, as soil by sampling it, is not, and what is counted there has places here: a
disturbance must not lead into a dead end.
"""

from tpvqa_experiments.abroad.classical.journeys import KINDS as JOURNEYS
from tpvqa_experiments.abroad.classical.kind import Kind
from tpvqa_experiments.abroad.classical.skills import KINDS as SKILLS

KINDS: dict[str, Kind] = {**SKILLS, **JOURNEYS}
"""Kinds by name."""

__all__ = ["KINDS", "Kind"]
