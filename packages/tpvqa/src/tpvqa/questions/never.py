"""Facts that no camera shows, as patterns: (free ?h), (not (near ?x))."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from tpvqa.pddl import Literal, Task
from tpvqa.pddl.pattern import Pattern

_NEGATED = re.compile(r"\(\s*not\s*(\([^()]*\))\s*\)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class NeverAsked:
    """A pattern of literals that are not asked about.

    Attributes:
        fact: The form of the fact. With `actions` given, a variable named like a parameter is the
            action's own argument.
        positive: False for the negative literal alone; None for both.
        actions: The actions at which it is not asked; empty for everywhere.
        because: Why, in words.
    """

    fact: Pattern
    positive: bool | None = None
    actions: frozenset[str] = frozenset()
    because: str = ""

    @staticmethod
    def parse(text: str, task: Task) -> "NeverAsked":
        """Read `(free ?h)`, `(near ?x - container)` or `(not (on ?x fridge))`.

        Raises:
            PDDLError: It is not such a pattern, or does not fit the task.
        """
        negated = _NEGATED.fullmatch(text.strip())
        fact = Pattern.parse(negated[1] if negated else text, task)
        return NeverAsked(fact, False if negated else None)

    def matches(
        self, literal: Literal, action: str | None, arguments: Mapping[str, str], task: Task
    ) -> bool:
        """Whether a literal is not asked about at an action.

        Args:
            literal: The literal.
            action: The action's name; None where the question belongs to none.
            arguments: The action's arguments by parameter, without the question mark.
            task: Gives the objects' types.
        """
        if self.positive not in (None, literal.positive):
            return False
        if self.actions and action not in self.actions:
            return False
        bound = {f"?{name}": value for name, value in arguments.items()} if self.actions else {}
        return self.fact.match(literal.atom, bound, task) is not None

    @property
    def everywhere(self) -> bool:
        """Whether it takes in every literal of its predicate, whatever the action."""
        plain = all(kind is None for kind in self.fact.types) and not self.actions
        return plain and self.positive is None and len(self.fact.variables) == len(self.fact.terms)
