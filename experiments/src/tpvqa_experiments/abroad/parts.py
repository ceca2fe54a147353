"""The cells of every part of the bench abroad."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from tpvqa.bench.cell import Cell
from tpvqa.bench.own_task import OwnTask
from tpvqa_experiments.paper import TASKS

BELIEF = "belief"
MONITORS = (
    BELIEF,
    *("tpvqa", "tpvqa:5", "vote:5"),
    *("lead:2", "lead:3", "lead:4", "lead:6"),
    *("blind:2", "blind:3", "blind:5"),
)
SEEING = "seeing"
"""What stands in rows for the limit: who knows the true state after every action."""
REPEATING = tuple(f"{SEEING}:{times}" for times in range(1, 6))
"""And for that of repetition: who sees what can be seen, and does the rest so many times."""
VLM = "oracle:0.8"
SYMBOLIC = "symbolic"
UNBOUND = "limits=none"
SHIPPED = (*TASKS, "build_tower")
DEAD = {
    "clean_dishes": ("dead=wash", "dead=pick_up _ _ left"),
    "serve_breakfast": ("dead=turn_on", "dead=pick_up bread", "dead=pick_up _ _ left"),
    "eat_apple": ("dead=open", "dead=pick_up _ _ left"),
    "build_tower": ("dead=moveblock red",),
}
"""Skills of shipped tasks that never work; without the left hand there is another way."""
ELSEWHERE = "elsewhere=1"
NOTHING = "start=unknown"
RATES = ("failure=0.6", "failure=0.8,actions=400x")
"""At .8 who sees all takes over fifty actions a step in a sixth of the trials: that would bind."""


class Part(StrEnum):
    """A part of the bench: a row of the table of what the monitor must reach."""

    OTHERS = "others"
    OWN = "own"
    SENSED = "sensed"
    ELSEWHERE = "elsewhere"
    NOTHING = "nothing"
    DEAD = "dead"
    FAILURE = "failure"
    SHIPPED = "shipped"


@dataclass(frozen=True, slots=True, kw_only=True)
class Extent:
    """How much of each part is run.

    Attributes:
        others: Domains of others, by name; the monitors are told nothing of the VLM there.
        own: Domains of one's own, by name.
        sensed: The same with what the robot's own sensors tell.
        blocks: Problems of the shipped blocksworld.
        tasks: Shipped tasks.
        monitors: Specifications of monitors.
        vlms: Specifications of noise models.
        episodes: Of every cell.
        others_episodes: Of every cell of others' domains.
        more: Settings that every condition has besides, with commas.
    """

    others: Mapping[str, OwnTask] = field(default_factory=dict)
    own: Mapping[str, OwnTask] = field(default_factory=dict)
    sensed: Mapping[str, OwnTask] = field(default_factory=dict)
    blocks: Mapping[str, OwnTask] = field(default_factory=dict)
    tasks: Sequence[str] = SHIPPED
    monitors: Sequence[str] = MONITORS
    vlms: Sequence[str] = (VLM,)
    episodes: int = 300
    others_episodes: int = 100
    more: str = ""

    def cells(self, part: Part) -> Iterator[tuple[Cell, int]]:
        """The cells of a part, each with its number of episodes."""
        match part:
            case Part.OTHERS:
                for cell in self._cross(self.others, ("",)):
                    yield cell, self.others_episodes
            case Part.OWN:
                for cell in self._cross(self.own, ("",)):
                    yield cell, self.episodes
            case Part.SENSED:
                for cell in self._cross(self.sensed, ("",)):
                    yield cell, self.episodes
            case Part.ELSEWHERE:
                for cell in self._cross((*self.household, *self.own), (ELSEWHERE,)):
                    yield cell, self.episodes
            case Part.NOTHING:
                for cell in self._cross((*self.blocks, *self.household), (NOTHING,)):
                    yield cell, self.episodes
            case Part.DEAD:
                for task in self.tasks:
                    for cell in self._cross((task,), DEAD.get(task, ())):
                        yield cell, self.episodes
            case Part.FAILURE:
                for cell in self._cross(self.tasks, RATES):
                    yield cell, self.episodes
            case Part.SHIPPED:
                for cell in self._cross(self.tasks, ("",)):
                    yield cell, self.episodes

    @property
    def household(self) -> list[str]:
        """The tasks of the paper among those that are run."""
        return [task for task in self.tasks if task in TASKS]

    @property
    def tasks_of_files(self) -> dict[str, OwnTask]:
        """All tasks that are not shipped, by name."""
        return {**self.others, **self.own, **self.sensed, **self.blocks}

    def _cross(
        self, tasks: Mapping[str, OwnTask] | Sequence[str], conditions: Sequence[str]
    ) -> Iterator[Cell]:
        for condition in conditions:
            told = ",".join(filter(None, (UNBOUND, condition, self.more)))
            for vlm in self.vlms:
                for task in tasks:
                    for monitor in self.monitors:
                        yield Cell(task, monitor, vlm, SYMBOLIC, told)


def limits_of(part: Part) -> tuple[str, ...]:
    """The limits beside the monitors of a part.

    Where a skill is dead there are none: they plan as if every skill worked.
    """
    if part is Part.DEAD:
        return ()
    return (*(REPEATING if part in (Part.OWN, Part.SENSED) else ()), SEEING)


def is_limit(monitor: str) -> bool:
    """Whether a row is that of a limit, and of no monitor."""
    return monitor.partition(":")[0] == SEEING


def believes(monitor: str) -> bool:
    """Whether a monitor is the belief monitor, in any form."""
    return monitor.partition(":")[0] == BELIEF
