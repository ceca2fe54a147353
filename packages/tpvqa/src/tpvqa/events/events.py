"""Every step of an episode as a typed event: the one log that everything else reads."""

from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter, field_serializer

from tpvqa.config import Limits, TrialConfig
from tpvqa.events.decision import Decision
from tpvqa.events.usage import Record, UsageRecord
from tpvqa.questions import Way
from tpvqa.vlm import Reply
from tpvqa.worlds import Report
from tpvqa.worlds.outcome import Failure

SCHEMA: Literal[2] = 2
"""Of the log. That of tpvqa 0.1, which did not say its number, was 1."""


class _Event(Record):
    number: int = -1
    time: float = 0.0

    def stamp(self, number: int, time: float) -> None:
        """Say where in the log it stands. Whoever writes it does so, once: a copy would cost more
        than all else that happens to an event."""
        self.__dict__.update(number=number, time=round(time, 4))


class Started(_Event):
    """The first event: everything that is needed to run the trial again.

    Attributes:
        schema_number: Of the log's format.
        version: Of tpvqa.
        config: What was asked for. `simulation` is None where the world is not simulated.
        task: The task's name.
        monitor: Specification of the monitor, as all that follow with its defaults filled in.
        vlm: Specification of the VLM.
        world: Specification of the world.
        planner: Specification of the planner.
        noise_model: Whether the VLM answers from the truth, for experiments; it is no VLM then.
        domain: Text of the file, as are `problem`, `questions`, `rules` (the world file) and
            `priors`.
        initial: The facts that hold at first, as the problem says.
        true_start: Those that truly hold where a simulated world begins otherwise; for judges.
        goal: The goal in words.
        calibration: What the monitor was told of the VLM's answers, where it weighs them.
        experience: What it was told of earlier trials.
        risk: Where it may report "done", if it states a risk.
        parameters: All that the VLM's answers depend on besides pictures and questions, where it
            says so: model, digest of the prompt, size of pictures, samples, way of asking.
    """

    kind: Literal["started"] = "started"
    schema_number: Literal[2] = Field(
        default=SCHEMA, validation_alias="schema", serialization_alias="schema"
    )
    version: str
    config: TrialConfig
    task: str
    monitor: str
    vlm: str
    world: str
    planner: str
    noise_model: bool = False
    domain_file: str
    problem_file: str
    questions_file: str | None = None
    world_file: str | None = None
    domain: str
    problem: str
    questions: str | None = None
    rules: str | None = None
    priors: str | None = None
    initial: tuple[str, ...]
    true_start: tuple[str, ...] | None = None
    goal: str
    calibration: dict[str, Any] | None = None
    experience: dict[str, Any] | None = None
    risk: dict[str, Any] | None = None
    parameters: dict[str, str] | None = None

    @field_serializer("config")
    def _whole(self, config: TrialConfig) -> dict[str, Any]:
        """With what is None, which a log leaves out elsewhere."""
        return config.model_dump(mode="json", by_alias=True)

    @property
    def limits(self) -> Limits:
        """When the trial is ended without success."""
        return self.config.limits


class ActionRecord(Record):
    """A ground action, and how it is said."""

    name: str
    arguments: tuple[str, ...]
    said: str

    def pddl(self) -> str:
        """The action as PDDL writes it."""
        return f"({' '.join((self.name, *self.arguments))})"


class PlanMade(_Event):
    """A planner's result: a plan, or why there is none.

    A plan that is only `considered` is not followed: a monitor wanted to know what it would be.
    `limit` is that of the time, in seconds, where it passed. `without` are actions that it was not
    to have, `towards` facts that it was to bring about instead of the goal, as PDDL writes them.
    Where actions last, `times` are when the plan's steps come.
    """

    kind: Literal["plan made"] = "plan made"
    state: tuple[str, ...]
    result: Literal["plan", "unsolvable", "timed out", "crashed"]
    plan: tuple[ActionRecord, ...] = ()
    cost: int = 0
    planner: str = ""
    seconds: float = 0.0
    limit: float | None = None
    reason: str = ""
    considered: bool = False
    without: tuple[str, ...] = ()
    towards: tuple[str, ...] = ()
    times: tuple[float, ...] | None = None


class FrameRecord(Record):
    """A camera image that was saved beside the log; see `observation.Frame`.

    Attributes:
        file: Where it lies in the episode's folder.
        depth: Where its depth image lies, if it has one.
    """

    view: str
    file: str
    media_type: str
    source: str = ""
    stamp: float | None = None
    intrinsics: dict[str, float] | None = None
    depth: str | None = None


class SensedRecord(Record):
    """A fact that the robot measured itself, and how probable the reading makes it."""

    atom: str
    probability: float = Field(ge=0, le=1)


class Observed(_Event):
    """A look at the world. One `during` an action was taken while the action ran; `facts` are what
    the robot sensed itself."""

    kind: Literal["observed"] = "observed"
    look: int
    view: str | None = None
    world_time: float
    frames: tuple[FrameRecord, ...] = ()
    detail: dict[str, Any] = Field(default_factory=dict)
    facts: tuple[SensedRecord, ...] = ()
    during: bool = False
    snapshot: dict[str, Any] | None = None


class QuestionRecord(Record):
    """A question as it was asked."""

    text: str
    way: Way
    atom: str | None = None
    action: str | None = None
    expected: bool = True
    alike: tuple[str, ...] | None = None
    wording: int | None = Field(default=None, ge=1)


class Asked(_Event):
    """Questions about the latest look. `before` is the look before the latest action, where its
    pictures are shown, too, with questions about effects."""

    kind: Literal["asked"] = "asked"
    look: int
    questions: tuple[QuestionRecord, ...]
    person: bool = False
    before: int | None = None


class AnswerRecord(Record):
    """An answer as it came."""

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
    usage: UsageRecord | None = None


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
    def acts(self) -> bool:
        """Whether the action is executed now."""
        return (
            self.when == "before" and self.decision is Decision.GO_ON and self.onward == self.step
        )

    @property
    def course(self) -> str:
        """The decision as it is shown: to go on elsewhere in the plan has words of its own."""
        natural = self.step + (self.when == "after")
        if self.decision is not Decision.GO_ON or self.onward == natural:
            return self.decision
        return "go back" if self.onward < natural else "skip ahead"


class Acting(_Event):
    """An action is about to be executed."""

    kind: Literal["acting"] = "acting"
    step: int
    action: ActionRecord
    attempt: int


class OutcomeRecord(Record):
    """What truly came of an action, for judging; see `worlds.outcome.Outcome`."""

    failure: Failure | None = None
    undone: str | None = None
    undoing: str = ""
    added: tuple[str, ...] = ()
    removed: tuple[str, ...] = ()

    @property
    def succeeded(self) -> bool:
        """Whether the action did what its effects say, or they held already."""
        return self.failure is None


class Acted(_Event):
    """What the robot's skill reports, and what the robot sensed then (`facts`). `truth` is what a
    simulated world knows, for judging."""

    kind: Literal["acted"] = "acted"
    report: Report
    seconds: float
    message: str = ""
    facts: tuple[SensedRecord, ...] = ()
    truth: OutcomeRecord | None = None
    snapshot: dict[str, Any] | None = None


class Waited(_Event):
    """Time passed while actions ran, until the world's `clock` showed this. `truth` is what a
    simulated world knows of what happened meanwhile, for judging."""

    kind: Literal["waited"] = "waited"
    clock: float
    truth: OutcomeRecord | None = None
    snapshot: dict[str, Any] | None = None


EndedBecause = Literal[
    "goal",
    "limit of repeats",
    "limit of replans",
    "limit of actions",
    "limit of time",
    "no plan",
    "planner timed out",
    "planner crashed",
    "gave up",
    "world refused",
    "cancelled",
    "budget spent",
]
CAN_BE_GONE_ON_WITH = ("cancelled", "budget spent")
"""Ends that are none: the trial goes on from there where it is resumed."""


class Resumed(_Event):
    """The trial goes on after an interruption, in a world that cannot be put back: it may have
    changed while nobody watched, so what was being checked is checked again."""

    kind: Literal["resumed"] = "resumed"


class ListenerDropped(_Event):
    """Something that was told of events broke, and is told of no more. The trial goes on."""

    kind: Literal["listener dropped"] = "listener dropped"
    listener: str
    error: str


class Ended(_Event):
    """The last event."""

    kind: Literal["ended"] = "ended"
    because: EndedBecause
    message: str = ""
    believed_goal: bool
    goal_holds: bool | None = None
    completed: bool | None = None
    unmet: tuple[str, ...] | None = None
    actions: int
    questions: int
    looks: int
    repeats: int
    replans: int
    usage: UsageRecord | None = None
    cost: float | None = None

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
    | Waited
    | Resumed
    | ListenerDropped
    | Ended
)

EVENT: TypeAdapter[Event] = TypeAdapter(Annotated[Event, Field(discriminator="kind")])
"""Reads and writes one event as JSON."""
