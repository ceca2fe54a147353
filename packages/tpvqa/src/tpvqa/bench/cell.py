"""What a bench compares: cells of one task under one monitor with one VLM."""

from dataclasses import dataclass

from pydantic import ValidationError

from tpvqa.bench.condition import changes_of, not_understood, settings_of
from tpvqa.config import TrialConfig


@dataclass(frozen=True, slots=True, order=True)
class Cell:
    """One cell of a table.

    Attributes:
        task: A shipped task, or one of the bench's own (see `tpvqa.bench.own_task`).
        monitor: Specification of the monitor.
        vlm: Specification of the VLM.
        world: Specification of the world.
        condition: What differs from other cells, with commas; empty for nothing. `failure=0.4`,
            `disturbance=0.5` or `spontaneous=0.05`: true rates of faults. `repeats=3`,
            `replans=3`, `actions=30` or `seconds=60`: limits; `limits=none`: none that bind.
            `redo=risky`: what comes of doing again what is done. `planner=fast-downward:optimal`:
            who plans. `wording=paper`: how whole actions are asked about. `believed=oracle:0.9`:
            the monitor is given that VLM's calibration.
            `carried=30`: what is learned is passed on through so many episodes.
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

        Raises:
            BenchError: The condition is not understood.
        """
        changes = changes_of(self.condition)
        try:
            return common.but(
                task=self.task,
                monitor={"spec": self.monitor},
                vlm={"spec": self.vlm},
                world={"spec": self.world},
                episode=episode,
                **changes,
            )
        except ValidationError:
            raise not_understood(self.condition) from None

    @property
    def believed(self) -> str | None:
        """The VLM for which the monitor takes the one that answers; None where it knows better."""
        return settings_of(self.condition).get("believed")

    @property
    def carried(self) -> int:
        """How many episodes in a row pass on what was learned; 0 where each begins anew."""
        value = settings_of(self.condition).get("carried", "0")
        if not value.isdecimal():
            raise not_understood(self.condition)
        return int(value)

    def __str__(self) -> str:
        parts = (self.task, self.monitor, self.vlm, self.world, self.condition)
        return " / ".join(filter(None, parts))
