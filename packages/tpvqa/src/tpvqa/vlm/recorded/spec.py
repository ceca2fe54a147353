"""What `recorded:…` says: whose answers, and whether errors last."""

from dataclasses import dataclass, replace
from enum import StrEnum

from tpvqa.errors import PluginError
from tpvqa.pddl import Task
from tpvqa.vlm.other_words import SHARED, split_words, with_words
from tpvqa.vlm.recorded.answers import Recordings, models, recordings
from tpvqa.vlm.recorded.lasting import Lasting, lasting
from tpvqa.vlm.recorded.table import is_table, recordings_in

BLOCKS, HOUSEHOLD = "blocksworld", "igibson"
"""The environments of the recorded models: a domain of the first name, and all others."""


class Errors(StrEnum):
    """How errors at different looks hang together."""

    LASTING = "lasting"  # as the record shows
    FRESH = "fresh"  # every look is drawn anew; what nothing meant until this could be said


@dataclass(frozen=True, slots=True)
class RecordedSpec:
    """The arguments of a recorded model.

    Attributes:
        model: Its name; none where a table holds one alone.
        half: Half of the problems, 0 or 1; None for all.
        errors: How they hang together; None where that is not said.
        words: How often what lasts in another wording is what lasts in the first one.
        table: The file of answers of the user's own; None for those that are shipped.
    """

    model: str
    half: int | None
    errors: Errors | None
    words: float = SHARED
    table: str | None = None

    @classmethod
    def parse(cls, arguments: str) -> "RecordedSpec":
        """Read MODEL[:HALF][:fresh] or MODEL[:HALF][:lasting], perhaps with :words:SHARE; instead
        of MODEL also FILE or FILE:MODEL.

        Raises:
            PluginError: It is something else.
        """
        said, share = split_words(arguments)
        model, *words = said.split(":")
        errors = Errors(words.pop()) if words and words[-1] in (*Errors,) else None
        half = words.pop() if words and words[-1] in ("0", "1") else None
        table = model if cls.names_table(model) else None
        if table is not None:
            model = words.pop() if len(words) == 1 else ""
        if not (model or table) or words:
            raise PluginError(
                f"'recorded:{arguments}' is not understood. Write recorded:MODEL, or "
                "recorded:MODEL:HALF (0 or 1) for half of its problems, either with :fresh behind "
                f"it for errors that do not last; with a model of {', '.join(models())}, or "
                "instead of it a table of answers (.csv, .csv.gz), and behind that the model "
                "where it has several."
            )
        return cls(model, None if half is None else int(half), errors, share, table)

    @staticmethod
    def names_table(arguments: str) -> bool:
        """Whether such arguments begin with a table of the user's own."""
        return is_table(arguments.partition(":")[0])

    def told(self, task: Task) -> Recordings:
        """The answers that it stands for in the environment of a task.

        Raises:
            UnknownNameError: No such model was recorded, or not in that environment.
            RecordError: The table is broken, or holds no answers of that kind.
        """
        if self.table is not None:
            return recordings_in(self.table, self.model, task.domain_name, self.half)
        environment = BLOCKS if task.domain_name == BLOCKS else HOUSEHOLD
        return recordings(self.model, environment, self.half)

    def lasts(self, told: Recordings) -> Lasting | None:
        """What share of the answers lasts; None for answers that are drawn anew at every look.

        A table does not tell: it is that of all recorded models.
        """
        if self.errors is Errors.FRESH:
            return None
        if self.table is None:
            return lasting(told.model, told.environment)
        return lasting("", BLOCKS if told.environment == BLOCKS else HOUSEHOLD)

    def other_half(self) -> "RecordedSpec":
        """The same with the problems that this one leaves out; itself where it has all."""
        return self if self.half is None else replace(self, half=1 - self.half)

    def with_errors(self, errors: Errors) -> "RecordedSpec":
        """The same in full, with what errors are like where it does not say."""
        return replace(self, errors=self.errors or errors)

    def __str__(self) -> str:
        half = "" if self.half is None else f":{self.half}"
        whose = ":".join(filter(None, (self.table, self.model)))
        said = f"{whose}{half}" + (f":{self.errors}" if self.errors else "")
        return with_words(said, self.words)
