"""What a bench compares: cells of one task under one monitor with one VLM."""

from dataclasses import dataclass
from typing import Any

from tpvqa.config import TrialConfig
from tpvqa.errors import BenchError

RATES = ("failure", "disturbance", "spontaneous")


@dataclass(frozen=True, slots=True, order=True)
class Cell:
    """One cell of a table.

    Attributes:
        task: A shipped task.
        monitor: Specification of the monitor.
        vlm: Specification of the VLM.
        world: Specification of the world.
        condition: What differs from other cells, with commas; empty for nothing. `failure=0.4`,
            `disturbance=0.5` or `spontaneous=0.05`: true rates of faults. `believed=oracle:0.9`:
            the monitor is given that VLM's calibration. `carried=30`: what is learned is passed
            on through so many episodes.
    """

    task: str
    monitor: str
    vlm: str
    world: str
    condition: str = ""

    def config(self, common: TrialConfig, episode: int) -> TrialConfig:
        """The configuration of one episode of this cell.

        Args:
            common: What all cells share: seed, rates of faults, limits.
            episode: Its number, which gives it the same faults in every cell.
        """
        return common.but(
            task=self.task,
            monitor={"spec": self.monitor},
            vlm={"spec": self.vlm},
            world={"spec": self.world},
            episode=episode,
            simulation=self.rates(),
        )

    def rates(self) -> dict[str, Any]:
        """The rates of faults that its condition gives.

        Raises:
            BenchError: The condition is not understood.
        """
        try:
            return {name: float(value) for name, value in self._settings() if name in RATES}
        except ValueError:
            raise self._not_understood() from None

    @property
    def believed(self) -> str | None:
        """The VLM for which the monitor takes the one that answers; None where it knows better."""
        return dict(self._settings()).get("believed")

    @property
    def carried(self) -> int:
        """How many episodes in a row pass on what was learned; 0 where each begins anew."""
        value = dict(self._settings()).get("carried", "0")
        if not value.isdecimal():
            raise self._not_understood()
        return int(value)

    def _settings(self) -> list[tuple[str, str]]:
        found = []
        for part in self.condition.split(",") if self.condition else []:
            name, _, value = part.partition("=")
            if name not in (*RATES, "believed", "carried"):
                raise self._not_understood()
            found.append((name, value))
        return found

    def _not_understood(self) -> BenchError:
        return BenchError(
            f"The condition {self.condition!r} is not understood. Write settings with commas: "
            f"rates of faults ({', '.join(RATES)}), believed=VLM, carried=EPISODES; for example "
            "failure=0.4"
        )

    def __str__(self) -> str:
        parts = (self.task, self.monitor, self.vlm, self.world, self.condition)
        return " / ".join(filter(None, parts))
