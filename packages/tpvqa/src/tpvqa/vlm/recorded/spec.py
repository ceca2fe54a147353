"""What `recorded:MODEL[:HALF][:fresh]` says: whose answers, and whether errors last."""

from dataclasses import dataclass, replace
from enum import StrEnum

from tpvqa.errors import PluginError
from tpvqa.pddl import Task
from tpvqa.vlm.other_words import SHARED, split_words, with_words
from tpvqa.vlm.recorded.answers import Recordings, models, recordings


class Errors(StrEnum):
    """How errors at different looks hang together."""

    LASTING = "lasting"  # as the record shows
    FRESH = "fresh"  # every look is drawn anew; what nothing meant until this could be said


@dataclass(frozen=True, slots=True)
class RecordedSpec:
    """The arguments of a recorded model.

    Attributes:
        model: Its name.
        half: Half of the problems, 0 or 1; None for all.
        errors: How they hang together; None where that is not said.
        words: How often what lasts in another wording is what lasts in the first one.
    """

    model: str
    half: int | None
    errors: Errors | None
    words: float = SHARED

    @classmethod
    def parse(cls, arguments: str) -> "RecordedSpec":
        """Read MODEL[:HALF][:fresh] or MODEL[:HALF][:lasting], perhaps with :words:SHARE.

        Raises:
            PluginError: It is something else.
        """
        said, share = split_words(arguments)
        model, *words = said.split(":")
        errors = Errors(words.pop()) if words and words[-1] in (*Errors,) else None
        half = words.pop() if words and words[-1] in ("0", "1") else None
        if not model or words:
            raise PluginError(
                f"'recorded:{arguments}' is not understood. Write recorded:MODEL, or "
                "recorded:MODEL:HALF (0 or 1) for half of its problems, either with :fresh behind "
                f"it for errors that do not last; with a model of {', '.join(models())}."
            )
        return cls(model, None if half is None else int(half), errors, share)

    def told(self, task: Task) -> Recordings:
        """The answers that it stands for in the environment of a task.

        Raises:
            UnknownNameError: No such model was recorded, or not in that environment.
        """
        environment = "blocksworld" if task.domain_name == "blocksworld" else "igibson"
        return recordings(self.model, environment, self.half)

    def other_half(self) -> "RecordedSpec":
        """The same with the problems that this one leaves out; itself where it has all."""
        return self if self.half is None else replace(self, half=1 - self.half)

    def with_errors(self, errors: Errors) -> "RecordedSpec":
        """The same in full, with what errors are like where it does not say."""
        return replace(self, errors=self.errors or errors)

    def __str__(self) -> str:
        half = "" if self.half is None else f":{self.half}"
        said = f"{self.model}{half}" + (f":{self.errors}" if self.errors else "")
        return with_words(said, self.words)
