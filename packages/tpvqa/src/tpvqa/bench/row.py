"""What is kept of an episode: one line of a file, and later one row of a table."""

from typing import Annotated

from pydantic import ConfigDict, Field, ValidationError

from tpvqa.bench.cell import Cell
from tpvqa.events.events import BELIEVED
from tpvqa.told import ToldModel, first_fault

Count = Annotated[int, Field(ge=0)]


class EpisodeRow(ToldModel):
    """One episode in figures.

    Attributes:
        completed: All goals hold in truth and the trial ended believing so.
        because: Why it ended.
        believed_goal: It ended believing that the goal holds.
        reached: The goal held in truth when it ended, whatever was believed.
        longest_repeat: Most repeats of one action in a row.
        failures: Actions that failed in truth, or undid something.
        wasted: Actions that could do nothing: their effects held already, or a precondition did
            not.
        dead: Tries of skills that never work, of those whose preconditions held in truth.
        named: Tries of a skill that never works when the monitor first said so; None where it
            never did.
        misnamed: Skills that work, of which it said the same.
        first_plan: Actions of the first plan.
        seconds: Wall time.
        trust: The factor by which the VLM's answers are worth more or less than its calibration
            says, as the monitor has learned by the end; None where it learns no such thing.
        goal: How probable the monitor took the goal to be at the end; None where it does not say.
        requests: To a server, where the VLM counts them; so are `prompt_tokens` and
            `completion_tokens`.
        error: What went wrong in the program; empty where nothing did.
        answers: How many answers were of which kind: "way|subject|truth|reply|P(yes)".
        decisions: How many decisions were of which kind: "before|truth|went on".
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    task: str
    monitor: str
    vlm: str
    world: str
    condition: str = ""
    seed: int
    episode: Count
    completed: bool = False
    because: str = "error"
    believed_goal: bool = False
    reached: bool = False
    actions: Count = 0
    questions: Count = 0
    looks: Count = 0
    repeats: Count = 0
    replans: Count = 0
    longest_repeat: Count = 0
    failures: Count = 0
    wasted: Count = 0
    dead: Count = 0
    named: Count | None = None
    misnamed: Count = 0
    first_plan: Count = 0
    seconds: float = Field(default=0.0, ge=0, allow_inf_nan=False)
    trust: float | None = None
    goal: float | None = None
    requests: Count | None = None
    prompt_tokens: Count | None = None
    completion_tokens: Count | None = None
    error: str = ""
    answers: dict[str, Count] = Field(default_factory=dict)
    decisions: dict[str, Count] = Field(default_factory=dict)

    @property
    def cell(self) -> Cell:
        """The cell it belongs to."""
        return Cell(self.task, self.monitor, self.vlm, self.world, self.condition)

    @property
    def ending(self) -> str:
        """How it ended, in the words of the report."""
        if self.error:
            return "error"
        if self.completed:
            return "goal"
        if self.believed_goal:
            return BELIEVED
        return self.because


def row_fault(error: ValidationError) -> str:
    """What is wrong with something that is no row, and with which field of it."""
    first = first_fault(error)
    return ": ".join(filter(None, (".".join(map(str, first["loc"])), first["msg"])))
