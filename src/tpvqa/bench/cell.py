"""What a bench compares: cells of one task under one monitor with one VLM."""

from dataclasses import dataclass, replace

from tpvqa.trial import TrialConfig


@dataclass(frozen=True, slots=True, order=True)
class Cell:
    """One cell of a table.

    Attributes:
        task: A shipped task.
        monitor: Specification of the monitor.
        vlm: Specification of the VLM.
        world: Specification of the world.
    """

    task: str
    monitor: str
    vlm: str
    world: str

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
        )

    def __str__(self) -> str:
        return f"{self.task} / {self.monitor} / {self.vlm} / {self.world}"
