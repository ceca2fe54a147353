"""What a robot has learned from its trials: how often actions fail, how far the VLM can be trusted.

Kept from one trial to the next, as one small JSON file.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import ConfigDict, Field, ValidationError, field_validator, model_validator

from tpvqa.belief.answers.bounds import MOST, Counted
from tpvqa.belief.answers.trust import GRID, Trust
from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.belief.calibrating.writing import read_json, write_json
from tpvqa.errors import CalibrationError, PlacedError
from tpvqa.told import ToldModel, first_fault

if TYPE_CHECKING:
    from tpvqa.belief.answers.biases import Biases
    from tpvqa.belief.calibrating.beta import Beta
    from tpvqa.belief.calibrating.counted import CountedFaults
    from tpvqa.belief.filtering.faults import Rates
    from tpvqa.belief.learning.chances import Chances

Some = Annotated[float, Field(gt=0, le=MOST, strict=True)]
Cases = tuple[Some, Some]
Count = Annotated[float, Field(ge=0, le=MOST, strict=True)]
Rate = Annotated[float, Field(gt=0, lt=1, strict=True)]


class Experience(ToldModel):
    """What was learned so far.

    Attributes:
        version: Of the file.
        failure: Cases for and against an action failing, prior ones included.
        disturbance: Cases for and against a failure disturbing something.
        spontaneous: Cases for and against something being undone after a success; None in files of
            before it was learned.
        redone: Cases for and against doing again what is done undoing something; None in files of
            before it was learned.
        trust: Probabilities of the factors by which the VLM's answers are worth more or less than
            its calibration says (`trust.GRID`); None where nothing was learned of them.
        biases: By predicate what its answers were like (`biases.Row`); none in files of before it
            was learned.
        vlm: Which VLM that was.
        calibration: Which calibration (`Calibration.fingerprint`).
        domain: The name of the last trial's domain; empty in files of before it was kept.
        trials: How many trials that is from.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    version: Literal[1, 2] = 2
    failure: Cases
    disturbance: Cases
    spontaneous: Cases | None = None
    redone: Cases | None = None
    trust: (
        Annotated[
            tuple[Count, ...],
            Field(min_length=len(GRID), max_length=len(GRID)),
        ]
        | None
    ) = None
    biases: dict[str, tuple[tuple[Rate, Rate, Count, Count, Count], ...]] = Field(
        default_factory=dict
    )
    vlm: str = ""
    calibration: str = ""
    domain: str = ""
    trials: Counted = 0

    @model_validator(mode="before")
    @classmethod
    def _of_today(cls, data: object) -> object:
        """Of a file of version 1 what it knows of failures: its factors were others."""
        if isinstance(data, dict) and data.get("version") == 1:
            return {**data, "version": 2, "trust": None, "biases": {}}
        return data

    @field_validator("trust")
    @classmethod
    def _some(cls, weights: tuple[float, ...] | None) -> tuple[float, ...] | None:
        if weights is not None and sum(weights) <= 0:
            raise ValueError("the probabilities add up to nothing")
        return weights

    @field_validator("biases")
    @classmethod
    def _no_more_yeses_than_answers(
        cls, told: dict[str, tuple[tuple[float, float, float, float, float], ...]]
    ) -> dict[str, tuple[tuple[float, float, float, float, float], ...]]:
        if any(row[2] > row[3] + row[4] + 1e-6 for rows in told.values() for row in rows):
            raise ValueError("more yeses than answers")
        return told

    @staticmethod
    def of(
        chances: "Chances", trust: Trust | None, trials: int, biases: "Biases | None" = None
    ) -> "Experience":
        """What a monitor has learned by the end of a trial."""
        return Experience(
            failure=_cases(chances.failure),
            disturbance=_cases(chances.disturbance),
            spontaneous=_cases(chances.spontaneous) if chances.spontaneous.yes > 0 else None,
            redone=_cases(chances.redone) if chances.redone.yes > 0 else None,
            trust=None if trust is None else trust.weights,
            biases={} if biases is None else dict(biases.told),
            trials=trials,
        )

    def chances(
        self, rates: "Rates | None" = None, counted: "CountedFaults | None" = None
    ) -> "Chances":
        """The rates of faults to begin the next trial with.

        Args:
            rates: Give those of changes that a file does not tell.
            counted: Tells the rates of single skills.
        """
        from tpvqa.belief.calibrating.beta import Beta
        from tpvqa.belief.learning.chances import Chances  # late, as numpy takes a while

        chances = Chances(rates, counted=counted)
        chances.failure = Beta(*self.failure)
        chances.disturbance = Beta(*self.disturbance)
        if self.spontaneous is not None:
            chances.spontaneous = Beta(*self.spontaneous)
        if self.redone is not None:
            chances.redone = Beta(*self.redone)
        return chances

    def trusting(self) -> Trust | None:
        """How far to trust the VLM in the next trial; None where nothing was learned of it."""
        if self.trust is None:
            return None
        trust = Trust()
        trust.weights = self.trust
        return trust

    def with_vlm(self, vlm: str, calibration: Calibration | None) -> "Experience":
        """What it says of a robot with this VLM: of another one, or with another calibration, how
        far to trust it has to be learned anew."""
        known = {"vlm": vlm, "calibration": "" if calibration is None else calibration.fingerprint}
        nothing = self.trust is None and not self.biases
        same = nothing or (self.vlm, self.calibration) == tuple(known.values())
        return self.model_copy(update=known if same else {**known, "trust": None, "biases": {}})

    @classmethod
    def load(cls, path: Path) -> "Experience | None":
        """Read a file that `save` wrote; None where there is none yet.

        Raises:
            CalibrationError: It cannot be read, or is broken.
        """
        try:
            return cls.model_validate_json(read_json(path, what="experience"))
        except PlacedError as error:
            if isinstance(error.__cause__, FileNotFoundError):
                return None
            raise CalibrationError(f"{error}. Name another file to learn anew") from error
        except ValidationError as error:
            first = first_fault(error)
            place = ".".join(map(str, first["loc"])) or "the file"
            raise CalibrationError(
                f"{path}: it is no experience, or a damaged one ({place}: {first['msg']}). Name "
                "another file to learn anew"
            ) from error

    def save(self, path: Path) -> None:
        """Write it, all or nothing.

        Raises:
            WriteError: It cannot be written.
        """
        write_json(path, self, remedy="Name another file with --experience")


def _cases(beta: "Beta") -> tuple[float, float]:
    """Cases for and against; a rate that was believed for certain can be learned again."""
    fewer = max(1.0, max(beta.yes, beta.no) / MOST)
    return max(beta.yes / fewer, 1e-3), max(beta.no / fewer, 1e-3)
