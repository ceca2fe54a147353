"""What a bench compares: cells of one task under one monitor with one VLM."""

from dataclasses import dataclass, replace
from typing import Any

from tpvqa.errors import BenchError
from tpvqa.trial import TrialConfig

RATES = ("failure", "disturbance", "spontaneous")


@dataclass(frozen=True, slots=True, order=True)
class Cell:
    """One cell of a table.

    Attributes:
        task: A shipped task.
        monitor: Specification of the monitor.
        vlm: Specification of the VLM.
        world: Specification of the world.
        condition: Rates of faults that differ from those of other cells, e.g. `failure=0.4` or
            `failure=0.4,disturbance=0.5`; empty for none.
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
        return replace(
            common,
            task=self.task,
            monitor=self.monitor,
            vlm=self.vlm,
            world=self.world,
            episode=episode,
            **self.rates(),
        )

    def rates(self) -> dict[str, Any]:
        """The rates of faults that its condition gives.

        Raises:
            BenchError: The condition is not understood.
        """
        found = {}
        for part in self.condition.split(",") if self.condition else []:
            name, _, value = part.partition("=")
            try:
                found[name] = float(value)
            except ValueError:
                found[""] = 0.0
        if not found.keys() <= set(RATES):
            raise BenchError(
                f"The condition {self.condition!r} is not understood. Write rates of faults with "
                f"commas, of {', '.join(RATES)}, e.g. failure=0.4"
            )
        return found

    def __str__(self) -> str:
        parts = (self.task, self.monitor, self.vlm, self.world, self.condition)
        return " / ".join(filter(None, parts))
