"""The seam that every monitor implements."""

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

from tpvqa.monitors.requests import Request
from tpvqa.monitors.verdict import Verdict
from tpvqa.observation import SensedFact
from tpvqa.pddl import Action, State, Task
from tpvqa.planning import Plan
from tpvqa.questions import QuestionBook

Check = Generator[Request, Any, Verdict]
"""A check: yields requests, is sent what came of each, returns a verdict."""


@dataclass(frozen=True, slots=True)
class Step:
    """Where a trial stands.

    Attributes:
        task: The task.
        book: Turns facts and actions into questions.
        plan: The plan that is being followed.
        index: The step of the plan, from 0.
        state: What is believed to be true, before the action.
        attempt: How often this step's action has been repeated so far.
        trouble: After the action, what the robot's own skill says went wrong; never the truth.
        reported: After the action, whether the skill reports that it failed; None where it reports
            nothing, as the program was killed in its middle.
        sensed: After the action, what the robot's own sensors tell; never the truth either.
        actions_left: Actions that the trial still allows; None for any number.
        replans_left: Replans that it still allows; None for any number.
        repeats_left: Repeats of this action that it still allows; None for any number.
    """

    task: Task
    book: QuestionBook
    plan: Plan
    index: int
    state: State
    attempt: int = 0
    trouble: str = ""
    reported: bool | None = None
    sensed: tuple[SensedFact, ...] = ()
    actions_left: int | None = None
    replans_left: int | None = None
    repeats_left: int | None = None

    @property
    def action(self) -> Action:
        """The action of this step."""
        return self.plan.actions[self.index]


@runtime_checkable
class Monitor(Protocol):
    """Decides, before and after every action, whether to go on, repeat or replan.

    A monitor does no input or output: it yields requests, and the loop performs and logs them.
    One instance watches one trial and may remember what it has seen. What else it may be stands in
    `monitors.capabilities`.
    """

    @property
    def name(self) -> str:
        """What the log calls it."""

    def before(self, step: Step) -> Check:
        """Check before the action is executed."""

    def after(self, step: Step) -> Check:
        """Check after the action was executed."""
