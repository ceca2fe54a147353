"""A figure beside what it must be."""

from dataclasses import asdict, dataclass
from typing import Any

from tpvqa_experiments.belief.resampling import Estimate


@dataclass(frozen=True, slots=True)
class Check:
    """One figure beside its target.

    Attributes:
        condition: Where it is measured, in the words of the table.
        what: The figure.
        target: What it must be.
        measured: The figure with its interval; None where it was not measured.
        reached: Whether it is; None where it was not measured, or is there to compare with.
        note: What else there is to say.
    """

    condition: str
    what: str
    target: str
    measured: Estimate | None
    reached: bool | None
    note: str = ""

    def flat(self) -> dict[str, Any]:
        """As plain values."""
        row = asdict(self)
        found = row.pop("measured") or {"value": None, "low": None, "high": None}
        return {**row, "measured": found["value"], "low": found["low"], "high": found["high"]}
