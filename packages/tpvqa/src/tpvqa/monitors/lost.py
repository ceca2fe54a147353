"""What tells joint states that no plan leads on from: no plan needs it, so nobody would ask."""

from tpvqa.belief.deciding.outlook import Outlook
from tpvqa.belief.filtering.belief import Belief
from tpvqa.pddl import Atom, State

LIKELY = 0.02
"""Joint states that are less probable are not thought of."""


def lost(belief: Belief, ahead: Outlook) -> frozenset[Atom]:
    """What is so only where the goal is out of reach.

    A key that is believed to lie where nobody can take it from may be looked for there before the
    trial is given up.

    Args:
        belief: Says what is likely.
        ahead: Says where no plan leads on.
    """
    likely = [number for number, weight in belief.ranked() if weight >= LIKELY]
    astray = [number for number in likely if ahead.no_way(number)]
    if not astray:
        return frozenset()
    on = next((number for number in likely if number not in astray), None)
    usual: State = belief.model.task.init if on is None else belief.model.state(on)
    return frozenset[Atom]().union(*(belief.model.state(n) ^ usual for n in astray))
