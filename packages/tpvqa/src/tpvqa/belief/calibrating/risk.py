"""A risk that can be stated: how probable the goal must be for "done" to be wrong seldom enough.

Conformal risk control (Angelopoulos, Bates, Fisch, Lei and Schuster 2022). Of n trials, g is what
the monitor believed of the goal where it ended in "done". With a threshold t a trial ends in "done"
where g > t only; it loses 1 where the goal is false then, else nothing. That loss never grows with
t. So with t the smallest for which (losses + 1) / (n + 1) is at most α, a further trial loses
with a probability of at most α, in the mean over calibrations: all that is assumed is that it and
the n are exchangeable. That t is the (m + 1)-th largest g of the trials that ended in a wrong
"done", m = ⌊α(n + 1) - 1⌋.
"""

from collections.abc import Mapping
from fractions import Fraction
from math import ceil, floor
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import ConfigDict, Field, ValidationError, model_validator

from tpvqa.belief.calibrating.writing import read_json, write_json
from tpvqa.errors import CalibrationError, PlacedError
from tpvqa.told import ToldModel, first_fault

Goal = Annotated[float, Field(ge=0, le=1)]
_PLACES = 12
"""Digits of a probability that count; sums of weights are not exact beyond."""


def confidence(goal: float) -> float:
    """A goal's probability, as it is compared: within 0 and 1, without what rounding adds."""
    return min(max(round(goal, _PLACES), 0.0), 1.0)


def least_trials(risk: float) -> int:
    """The fewest trials of which a risk can be stated: 49 for .02, 19 for .05."""
    return ceil(1 / _exact(risk)) - 1


def _exact(risk: float) -> Fraction:
    """As it was written: 0.07 · 100 is 7."""
    return Fraction(repr(risk))


class _Model(ToldModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class RiskBound(_Model):
    """Where "done" may be reported.

    Attributes:
        risk: At most this share of all trials end in "done" with the goal false.
        above: The probability of the goal above which "done" is reported.
        trials: Trials that it was learnt from.
        wrong: How many of them ended in "done" with the goal false, without a bound.
    """

    risk: Annotated[float, Field(gt=0, lt=1)]
    above: Goal
    trials: Annotated[int, Field(gt=0)]
    wrong: Annotated[int, Field(ge=0)] = 0

    def allows(self, goal: float) -> bool:
        """Whether "done" may be reported where the goal has a probability."""
        return confidence(goal) > self.above


class RiskCalibration(_Model):
    """What came of trials without a bound; kept as one JSON file.

    Attributes:
        version: Of the file.
        made_with: Under which conditions they were run, by name.
        seed: Their seed; their episodes are the first so many.
        trials: How many there were, however they ended.
        wrong: What was believed of the goal where they ended in "done" and it was false.
        right: The same where it was true.
    """

    version: Literal[1] = 1
    made_with: Mapping[str, str] = {}
    seed: int = 0
    trials: Annotated[int, Field(gt=0)]
    wrong: tuple[Goal, ...] = ()
    right: tuple[Goal, ...] = ()

    @model_validator(mode="after")
    def _counts(self) -> Self:
        if (done := len(self.wrong) + len(self.right)) > self.trials:
            raise ValueError(f"{done} of {self.trials} trials ended in done")
        return self

    def bound(self, risk: float) -> RiskBound:
        """Where "done" may be reported, so that it is wrong in at most this share of all trials.

        Raises:
            CalibrationError: There are too few trials to say so.
        """
        least = least_trials(risk)
        if self.trials < least:
            raise CalibrationError(
                f"a risk of {risk:g} takes at least {least} trials, and these are {self.trials}. "
                "Run more (`tpvqa risk --trials N`), or state a larger risk"
            )
        allowed = floor(_exact(risk) * (self.trials + 1) - 1)
        worst = sorted(map(confidence, self.wrong), reverse=True)
        above = worst[allowed] if len(worst) > allowed else 0.0
        return RiskBound(risk=risk, above=above, trials=self.trials, wrong=len(worst))

    def completed(self, bound: RiskBound) -> float:
        """The share of these trials that end in "done" rightly under a bound."""
        return sum(map(bound.allows, self.right)) / self.trials

    def mistaken(self, bound: RiskBound) -> float:
        """The share of these trials that end in "done" wrongly under a bound."""
        return sum(map(bound.allows, self.wrong)) / self.trials

    @classmethod
    def load(cls, path: Path) -> "RiskCalibration":
        """Read a file that `save` wrote.

        Raises:
            CalibrationError: It cannot be read, is of another version, or is broken.
        """
        remedy = "Name the file that `tpvqa risk --out FILE` wrote"
        try:
            return cls.model_validate_json(read_json(path, what="risk calibration"))
        except PlacedError as error:
            raise CalibrationError(f"{error}. {remedy}") from error
        except ValidationError as error:
            first = first_fault(error)
            place = ".".join(map(str, first["loc"])) or "file"
            raise CalibrationError(
                f"{path}: it is no risk calibration, or a damaged one ({place}: {first['msg']}). "
                f"{remedy}"
            ) from error

    def save(self, path: Path) -> None:
        """Write it, all or nothing.

        Raises:
            WriteError: The file cannot be written.
        """
        write_json(path, self, remedy="Name another file with --out")
