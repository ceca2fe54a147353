"""A plan, replayed step by step."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from tpvqa.pddl.atoms import Literal, State
from tpvqa.pddl.conditions import Condition, Conjunction, holds, supporting
from tpvqa.pddl.ground import Action
from tpvqa.pddl.task import Task


@dataclass(frozen=True, slots=True)
class Validation:
    """Whether a plan reaches the goal, and where it fails if it does not.

    Attributes:
        states: The states that the plan goes through, the first one included, up to the failure.
        failed_step: Number of the step, from 0, whose precondition does not hold; the number of
            steps where the goal does not hold at the end; None for a valid plan.
        failed: The literals that do not hold there.
    """

    states: tuple[State, ...]
    failed_step: int | None = None
    failed: tuple[Literal, ...] = ()
    action: Action | None = None

    @property
    def valid(self) -> bool:
        """Whether the plan reaches the goal."""
        return self.failed_step is None

    def __str__(self) -> str:
        if self.valid:
            return f"valid in {len(self.states) - 1} steps"
        numbers = self.action is not None and self.action.changes
        never = (
            "a number that cannot be worked out" if numbers else "a condition that can never hold"
        )
        missing = ", ".join(map(str, self.failed)) or never
        if self.action is None:
            return f"the goal does not hold at the end: {missing}"
        assert self.failed_step is not None
        return f"step {self.failed_step + 1}, {self.action}, needs {missing}"


def validate(task: Task, actions: Sequence[Action], state: State | None = None) -> Validation:
    """Replay a plan from a state (the task's initial one by default).

    Args:
        task: The task.
        actions: The plan.
        state: Where it starts.
    """
    states = [task.init if state is None else state]
    for step, action in enumerate(actions):
        full = task.extend(states[-1])
        able = holds(action.precondition, full)
        if not able or (action.changes and not task.applicable(states[-1], action)):
            failed = tuple(_failing(action.precondition, full))
            return Validation(tuple(states), step, failed, action)
        states.append(task.apply(states[-1], action))
    full = task.extend(states[-1])
    if not holds(task.goal, full):
        return Validation(tuple(states), len(actions), tuple(_failing(task.goal, full)))
    return Validation(tuple(states))


def _failing(condition: Condition, state: State) -> Iterator[Literal]:
    """The literals that keep a condition from holding."""
    if isinstance(condition, Conjunction):
        for part in condition.parts:
            yield from _failing(part, state)
    elif not holds(condition, state):
        yield from (literal for literal in supporting(condition, state) if not literal.holds(state))
