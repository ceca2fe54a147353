"""What is kept of an episode: one line of a file, and later one row of a table."""

import re
from typing import Annotated, Self

from pydantic import ConfigDict, Field, ValidationError, field_validator, model_validator

from tpvqa.bench.cell import Cell
from tpvqa.errors import shown
from tpvqa.events.events import BELIEVED
from tpvqa.questions import Way
from tpvqa.told import ToldModel, first_fault
from tpvqa.vlm import Reply

MOST = 10**9
"""Of whatever is counted in an episode; no trial comes near it, and tables can add it up."""
Count = Annotated[int, Field(ge=0, le=MOST)]

_ANSWERS = re.compile(
    rf"({'|'.join(Way)})\|(.*)\|([01])\|({'|'.join(Reply)})\|(-?0\.00|0\.[0-9]{{2}}|1\.00)?",
    re.DOTALL,
)
_DECISIONS = re.compile(r"(before|after)\|[01]\|[01]")


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
    trust: float | None = Field(default=None, ge=0, allow_inf_nan=False)
    goal: float | None = Field(default=None, ge=0, le=1)
    requests: Count | None = None
    prompt_tokens: Count | None = None
    completion_tokens: Count | None = None
    error: str = ""
    answers: dict[str, Count] = Field(default_factory=dict)
    decisions: dict[str, Count] = Field(default_factory=dict)

    @field_validator("answers")
    @classmethod
    def _are_answers(cls, answers: dict[str, int]) -> dict[str, int]:
        for kind in answers:
            split_answers(kind)
        return answers

    @field_validator("decisions")
    @classmethod
    def _are_decisions(cls, decisions: dict[str, int]) -> dict[str, int]:
        for kind in decisions:
            if not _DECISIONS.fullmatch(kind):
                raise ValueError(f"{shown(kind)} is no kind of decision")
        return decisions

    @model_validator(mode="after")
    def _agrees_with_itself(self) -> Self:
        """Of what is given alone: rows of earlier versions say less, and those of who sees all
        (`tpvqa bench abroad`) never that the goal was reached."""
        if {"completed", "believed_goal"} <= self.model_fields_set:
            if self.completed and not self.believed_goal:
                raise ValueError("completed, and did not end believing so")
            if self.believed_goal and self.reached and not self.completed:
                raise ValueError("not completed, and its goal was reached and believed")
        return self

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


def split_answers(kind: str) -> tuple[Way, str, bool, Reply, float | None]:
    """What a key of a row's answers says: way, subject, truth, reply and P(yes).

    Raises:
        ValueError: It is none.
    """
    match = _ANSWERS.fullmatch(kind)
    if match is None:
        raise ValueError(f"{shown(kind)} is no kind of answer")
    way, subject, truth, reply, p_yes = match.groups()
    return Way(way), subject, truth == "1", Reply(reply), float(p_yes) if p_yes else None


def row_fault(error: ValidationError) -> str:
    """What is wrong with something that is no row, and with which field of it."""
    first = first_fault(error)
    said = first["msg"].removeprefix("Value error, ")
    return ": ".join(filter(None, (".".join(map(str, first["loc"])), said)))
