"""Cells of every task under every monitor, with every VLM, in every world and condition."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.belief.calibrating.shipped import shipped_calibration
from tpvqa.bench.cell import Cell
from tpvqa.bench.own_task import OwnTask
from tpvqa.defaults import SYMBOLIC, default_vlm, default_world
from tpvqa.errors import BenchError
from tpvqa.monitors.capabilities import asks_actions
from tpvqa.plugins import Kind, load_spec, split
from tpvqa.tasks import find_task
from tpvqa.vlm.capabilities import answers_facts_only
from tpvqa.vlm.making import in_full
from tpvqa.worlds.capabilities import has_pictures


@dataclass(frozen=True, slots=True, kw_only=True)
class Grid:
    """What is crossed.

    Attributes:
        tasks: Shipped tasks.
        own: Tasks of the user's own, by name; after the shipped ones.
        monitors: Specifications of monitors.
        vlms: Specifications of VLMs; none for that of a trial in which none is named.
        worlds: Specifications of worlds; none for that of a trial in which none is named.
        conditions: As in `Cell`.
    """

    tasks: Sequence[str] = ()
    own: Mapping[str, OwnTask] = field(default_factory=dict)
    monitors: Sequence[str]
    vlms: Sequence[str] = ()
    worlds: Sequence[str] = ()
    conditions: Sequence[str] = ("",)

    def cells(self) -> list[Cell]:
        """The cells, those of one VLM in one world and condition together.

        Cells whose VLM has no answers to what their monitor asks are left out.

        Raises:
            TpvqaError: A name is unknown, or a VLM has to be named.
        """
        found = dict.fromkeys(
            Cell(task, monitor, vlm, world, condition)
            for condition in self.conditions
            for task in (*self.tasks, *self.own)
            for vlm, world in self._seen(task)
            for monitor in self.monitors
            if can_answer(vlm, monitor)
        )
        groups = list(dict.fromkeys((cell.vlm, cell.world, cell.condition) for cell in found))
        return sorted(found, key=lambda cell: groups.index((cell.vlm, cell.world, cell.condition)))

    def _seen(self, task: str) -> list[tuple[str, str]]:
        """The VLMs of a task, each with its worlds."""
        files = None if task in self.own else find_task(task)
        if self.vlms:
            return [
                (vlm, world)
                for vlm in map(in_full, self.vlms)
                for world in self.worlds or [default_world(files, vlm)]
            ]
        return [
            (default_vlm(files, pictures=has_pictures(load_spec(Kind.WORLD, world))), world)
            for world in self.worlds or [_of_chance(default_world(files))]
        ]


def _of_chance(world: str) -> str:
    """A script tells the same story in every episode: many of them are told by chance instead."""
    return SYMBOLIC if split(world)[0] == "scripted" else world


def can_answer(vlm: str, monitor: str) -> bool:
    """Whether a VLM has any answers to what a monitor asks; recorded ones know no whole actions."""
    return not (
        answers_facts_only(load_spec(Kind.VLM, vlm))
        and asks_actions(load_spec(Kind.MONITOR, monitor))
    )


def known_calibrations(cells: Iterable[Cell], given: Calibration | None) -> dict[Cell, Calibration]:
    """What the monitors of cells are told where it is not what is shipped for their VLM.

    Args:
        cells: Any.
        given: The user's own calibration.

    Raises:
        BenchError: A condition wants the calibration of a VLM for which there is none.
    """
    found = {}
    for cell in cells:
        told, believed = given, cell.believed
        if believed is not None and (given is None or given.vlm != believed):
            told = shipped_calibration(believed)
            if told is None:
                raise BenchError(
                    f"The condition {cell.condition!r} needs a calibration of {believed}, and "
                    f"none is shipped. Make one (`tpvqa calibrate --vlm {believed} --trials N`) "
                    "and name it with --calibration"
                )
        if told is not None:
            found[cell] = told
    return found
