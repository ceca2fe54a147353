"""Facts that a camera shows only from certain places."""

from collections.abc import Sequence
from dataclasses import dataclass

from tpvqa.pddl import Atom, State, Task
from tpvqa.pddl.pattern import Pattern


@dataclass(frozen=True, slots=True)
class ShownRule:
    """A form of fact that is shown only where something else holds.

    Attributes:
        fact: The form.
        where: What has to hold; its variables are those of the fact.
    """

    fact: Pattern
    where: tuple[Pattern, ...]

    def needed(self, atom: Atom, task: Task) -> frozenset[Atom] | None:
        """What has to hold so that a fact is shown; None where it has not this form."""
        binding = self.fact.match(atom, {}, task)
        if binding is None:
            return None
        return frozenset(pattern.ground(binding) for pattern in self.where)


def shown(rules: Sequence[ShownRule], atom: Atom, state: State, task: Task) -> bool:
    """Whether a fact is shown in a state, derived atoms included; the first rule of it counts."""
    needed = (rule.needed(atom, task) for rule in rules)
    return next((each <= state for each in needed if each is not None), True)
