"""Arguments that a robot's skill does not take."""

from collections.abc import Iterable, Sequence
from typing import Protocol

from tpvqa.pddl import Action, State, Task
from tpvqa.pddl.schema import TRUE


class Rebinding(Protocol):
    """An argument that the robot's skill does not take: it is what holds in truth."""

    @property
    def action(self) -> str:
        """The action's name."""

    @property
    def parameters(self) -> Sequence[str]:
        """Its parameters."""

    @property
    def argument(self) -> str:
        """The one that is not taken."""

    def apply(self, action: Action, state: State, task: Task) -> Action:
        """The action that the skill truly is."""


def as_skill(action: Action, rebind: Iterable[Rebinding]) -> Action:
    """What the robot does in an action, whatever the arguments are that its skill does not take:
    actions that differ in nothing else are one skill, and work or fail together."""
    free = [each.parameters.index(each.argument) for each in rebind if each.action == action.name]
    if not free:
        return action
    taken = tuple(each for place, each in enumerate(action.arguments) if place not in free)
    return Action(action.name, taken, TRUE, ())
