"""What can be done one after the other without a look."""

from typing import NamedTuple

from tpvqa.belief.deciding.annotated import AnnotatedPlan
from tpvqa.pddl import Action

Way = tuple[int, AnnotatedPlan]
"""A place in a plan, and that plan."""


class Followed(NamedTuple):
    """To end, where there is no way; or a way with each step repeated, and what follows it.

    Attributes:
        way: Its number among those compared; None to end.
        times: How often each step is done.
        then: What follows; None for the end.
    """

    way: int | None
    times: int = 0
    then: "Followed | None" = None


class Onward(NamedTuple):
    """What comes after an action.

    Attributes:
        actions: What is followed.
        rest: What is meant to come after that, where it is too long to be followed.
        begins: Where in a plan that rest begins; None where there is none.
    """

    actions: tuple[Action, ...]
    rest: tuple[Action, ...]
    begins: Way | None = None
