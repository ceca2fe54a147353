"""Every step of an episode as a typed event: the one log that terminal, report and replay read."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from tpvqa.monitors import Decision
from tpvqa.questions import Way
from tpvqa.vlm import Reply
from tpvqa.worlds import Report


class _Event(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    number: int = -1
    time: float = 0.0


class Limits(BaseModel):
    """When a trial is ended without success.

    Attributes:
        repeats: Repeats of one step's action in a row.
        replans: Replans in the trial.
        actions: Actions executed in the trial, repeats included.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    repeats: int = 10
    replans: int = 10
    actions: int = 60


class Started(_Event):
    """The first event: everything that is needed to run the trial again.

    `domain`, `problem`, `questions` and `rules` (the world file) are the texts of the files. A
    `noise_model` answers from the truth, for experiments; it is no VLM.
    """

    kind: Literal["started"] = "started"
    version: str
    task: str
    domain_file: str
    problem_file: str
    questions_file: str | None = None
    world_file: str | None = None
    domain: str
    problem: str
    questions: str | None = None
    rules: str | None = None
    initial: tuple[str, ...]
    goal: str
    monitor: str
    vlm: str
    noise_model: bool = False
    world: str
    planner: str
    seed: int
    episode: int
    limits: Limits
    settings: dict[str, Any] = Field(default_factory=dict)


class ActionRecord(BaseModel):
    """A ground action, and how it is said."""

    model_config = ConfigDict(frozen=True)

    name: str
    arguments: tuple[str, ...]
    said: str


class PlanMade(_Event):
    """A planner's result: a plan, or why there is none.

    A plan that is only `considered` is not followed: a monitor wanted to know what it would be.
    """

    kind: Literal["plan made"] = "plan made"
    state: tuple[str, ...]
    result: Literal["plan", "unsolvable", "timed out", "crashed"]
    plan: tuple[ActionRecord, ...] = ()
    cost: int = 0
    planner: str = ""
    seconds: float = 0.0
    reason: str = ""
    considered: bool = False


class FrameRecord(BaseModel):
    """A camera image that was saved beside the log."""

    model_config = ConfigDict(frozen=True)

    view: str
    file: str
    media_type: str
    source: str = ""


class Observed(_Event):
    """A look at the world."""

    kind: Literal["observed"] = "observed"
    look: int
    view: str | None = None
    world_time: float
    frames: tuple[FrameRecord, ...] = ()
    detail: dict[str, Any] = Field(default_factory=dict)
    snapshot: dict[str, Any] | None = None


class QuestionRecord(BaseModel):
    """A question as it was asked."""

    model_config = ConfigDict(frozen=True)

    text: str
    way: Way
    atom: str | None = None
    action: str | None = None
    expected: bool = True
    alike: tuple[str, ...] | None = None


class Asked(_Event):
    """Questions about the latest look."""

    kind: Literal["asked"] = "asked"
    look: int
    questions: tuple[QuestionRecord, ...]
    person: bool = False


class AnswerRecord(BaseModel):
    """An answer as it came."""

    model_config = ConfigDict(frozen=True)

    reply: Reply
    p_yes: float | None = Field(default=None, ge=0, le=1)
    source: str = ""
    text: str = ""
    p_cannot_see: float | None = Field(default=None, ge=0, le=1)
    leftover: float | None = None
    seconds: float = 0.0


class Answered(_Event):
    """The answers, in the order of the questions."""

    kind: Literal["answered"] = "answered"
    answers: tuple[AnswerRecord, ...]
    snapshot: dict[str, Any] | None = None


class Believed(_Event):
    """A change of the believed state."""

    kind: Literal["believed"] = "believed"
    added: tuple[str, ...] = ()
    removed: tuple[str, ...] = ()


class Decided(_Event):
    """A monitor's verdict.

    Attributes:
        onto: The step of the plan to go on with; None for the natural one (the action itself
            before it, the next one after it).
        belief: The probabilities of facts, as far as the monitor keeps them.
    """

    kind: Literal["decided"] = "decided"
    when: Literal["before", "after"]
    step: int
    action: str
    decision: Decision
    reason: str
    onto: int | None = None
    belief: dict[str, float] = Field(default_factory=dict)

    @property
    def onward(self) -> int:
        """The step of the plan that comes now, where the trial goes on."""
        return self.step + (self.when == "after") if self.onto is None else self.onto

    @property
    def course(self) -> str:
        """The decision as it is shown: to go on elsewhere in the plan has words of its own."""
        if self.decision is not Decision.GO_ON:
            return self.decision
        natural = self.step + (self.when == "after")
        if self.onward == natural:
            return self.decision
        return "go back" if self.onward < natural else "skip ahead"


class Acting(_Event):
    """An action is about to be executed."""

    kind: Literal["acting"] = "acting"
    step: int
    action: ActionRecord
    attempt: int


class Acted(_Event):
    """What the robot's skill reports. `truth` is what a simulated world knows, for judging."""

    kind: Literal["acted"] = "acted"
    report: Report
    seconds: float
    message: str = ""
    truth: dict[str, Any] | None = None
    snapshot: dict[str, Any] | None = None


EndedBecause = Literal[
    "goal",
    "limit of repeats",
    "limit of replans",
    "limit of actions",
    "no plan",
    "planner timed out",
    "planner crashed",
    "gave up",
    "world refused",
    "cancelled",
]


class Resumed(_Event):
    """The trial goes on after an interruption, in a world that cannot be put back: it may have
    changed while nobody watched, so what was being checked is checked again."""

    kind: Literal["resumed"] = "resumed"


class Ended(_Event):
    """The last event."""

    kind: Literal["ended"] = "ended"
    because: EndedBecause
    message: str = ""
    believed_goal: bool
    goal_holds: bool | None = None
    completed: bool | None = None
    actions: int
    questions: int
    looks: int
    repeats: int
    replans: int

    @property
    def ending(self) -> str:
        """How it ended: `because`, but for a goal that was believed and does not hold."""
        if self.completed is False and self.believed_goal:
            return BELIEVED
        return self.because


BELIEVED = "believed done and was not"
"""How an episode ended whose goal is believed and does not hold."""

Event = (
    Started
    | PlanMade
    | Observed
    | Asked
    | Answered
    | Believed
    | Decided
    | Acting
    | Acted
    | Resumed
    | Ended
)

EVENT: TypeAdapter[Event] = TypeAdapter(Annotated[Event, Field(discriminator="kind")])
"""Reads and writes one event as JSON."""
