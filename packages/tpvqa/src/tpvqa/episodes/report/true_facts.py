"""What was true when, as far as the log of a simulated world tells."""

import re

from tpvqa.events.events import Acted, Started
from tpvqa.pddl import Atom
from tpvqa.pddl.atoms import holds_in

_DERIVED = re.compile(r"\(\s*:derived\s+\(\s*([^\s()]+)", re.IGNORECASE)


class TrueFacts:
    """Follows the true state from one action to the next.

    Args:
        started: Gives the true state at first; derived facts are not in the problem's, so they are
            not known.
        known: Whether the world tells what comes of actions at all.
    """

    def __init__(self, started: Started, *, known: bool):
        begun = started.initial if started.true_start is None else started.true_start
        self._state = set(begun)
        self._derived = {name.lower() for name in _DERIVED.findall(started.domain)}
        self._known = known

    def take(self, acted: Acted) -> None:
        """Follow an action; from one of which nothing is known, nothing is known any more."""
        if acted.truth is None:
            self._known = False
        else:
            self._state -= set(acted.truth.removed)
            self._state |= set(acted.truth.added)

    def holds(self, fact: str) -> bool | None:
        """Whether a fact, given as PDDL, is true now; None where that is not known."""
        if not self._known or fact.strip("()").split(" ")[0] in self._derived:
            return None
        if fact.startswith(("(>", "(<")):
            values = (Atom.parse(each) for each in self._state if each.startswith("(= "))
            return holds_in(Atom.parse(fact), frozenset(values))
        return fact in self._state
