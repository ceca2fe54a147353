"""Answers beside the truth, from trials of any tasks that are run for it."""

from collections.abc import Callable, Mapping, Sequence

from tpvqa.belief import LabelledAnswer
from tpvqa.belief.calibrating.own_words import OwnWords
from tpvqa.bench.checking import check
from tpvqa.bench.grid import Grid
from tpvqa.bench.labelled import gather
from tpvqa.bench.own_task import OwnTask
from tpvqa.config import TrialConfig


def label_trials(
    vlm: str,
    trials: int,
    *,
    tasks: Sequence[str] = (),
    own: Mapping[str, OwnTask],
    world: str | None = None,
    monitor: str = "tpvqa",
    common: TrialConfig,
    heard: OwnWords | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> list[LabelledAnswer]:
    """Run trials of every task, and label all answers in them.

    Args:
        vlm: Specification of the VLM.
        trials: Of every task.
        tasks: Shipped tasks.
        own: Tasks of the user's own, by name.
        world: Specification of the world; None for that of a trial in which none is named.
        monitor: Who asks.
        common: What all trials share: seed, rates of faults, limits, planner.
        heard: Takes in what the robot itself said.
        progress: Told how many trials are done and how many there are.

    Raises:
        TpvqaError: Something is not there, or a trial cannot be run.
    """
    grid = Grid(
        tasks=tasks,
        own=own,
        monitors=(monitor,),
        vlms=(vlm,),
        worlds=() if world is None else (world,),
    )
    cells = grid.cells()
    check(cells, common, own)
    rows: list[LabelledAnswer] = []
    done, total = 0, trials * len(cells)
    progress(done, total)

    def one() -> None:
        nonlocal done
        done += 1
        progress(done, total)

    for cell in cells:
        rows += gather(cell, common, range(trials), own=own.get(cell.task), done=one, heard=heard)
    return rows
