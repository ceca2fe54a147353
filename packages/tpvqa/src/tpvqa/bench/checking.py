"""Sees before a bench that everything that it names is there and fits together."""

from collections.abc import Hashable, Mapping, Sequence
from importlib.util import find_spec

from tpvqa.bench.cell import Cell
from tpvqa.bench.condition import settings_of
from tpvqa.bench.own_task import OwnTask
from tpvqa.bench.stage import shared_planner, stage
from tpvqa.bench.stated_risk import unstated
from tpvqa.config import TrialConfig
from tpvqa.errors import BenchError, MissingExtraError, UnknownNameError
from tpvqa.planning import Unsolvable
from tpvqa.plugins import Kind, load_spec, takes
from tpvqa.tasks import find_task
from tpvqa.vlm.capabilities import is_noise_model
from tpvqa.worlds.capabilities import is_simulated


def check(cells: Sequence[Cell], common: TrialConfig, own: Mapping[str, OwnTask]) -> None:
    """See that every part of every cell is there, and can be made.

    Args:
        cells: What is to be run.
        common: What all trials share.
        own: Tasks of the user's own, by name.

    Raises:
        TpvqaError: A task, monitor, VLM, world or planner is not there, lacks an extra, does not
            take its arguments or does not fit to the others; an option is one of none of them.
    """
    need_extras()
    for task in dict.fromkeys(cell.task for cell in cells):
        if task not in own:
            find_task(task)
    _names(cells, common)
    noise = [is_noise_model(load_spec(Kind.VLM, cell.vlm)) for cell in cells]
    if common.vlm.answers is not None and cells and all(noise):
        raise BenchError(
            f"--{common.vlm.answers[0]}: all these VLMs are noise models, which answer from the "
            "truth by the seed, always the same. Their answers are not recorded; leave it out"
        )
    tried: set[Hashable] = set()
    for cell in cells:
        seen = (cell.vlm, cell.world)
        parts = {(cell.task, cell.monitor), (cell.task, *seen), cell.condition}
        if parts <= tried:
            continue
        cell.carried  # noqa: B018 — says what is wrong with it
        here = stage(cell.task, own.get(cell.task))
        with here.trial(unstated(cell).config(common, 0)) as trial:
            if seen not in tried:
                trial.check()
        tried |= {*parts, seen}


def need_extras() -> None:
    """See that what makes tables and figures is installed.

    Raises:
        MissingExtraError: It is not.
    """
    for package in ("scipy", "matplotlib", "pyarrow"):
        if find_spec(package) is None:
            raise MissingExtraError(package, "bench", "A bench")


def _names(cells: Sequence[Cell], common: TrialConfig) -> None:
    taken: set[str] = set()
    for kind, specs in (
        (Kind.MONITOR, {cell.monitor: None for cell in cells}),
        (Kind.VLM, {cell.vlm: None for cell in cells}),
        (Kind.WORLD, {cell.world: None for cell in cells}),
    ):
        for spec in specs:
            target = load_spec(kind, spec)
            taken |= takes(target)
            if kind is Kind.WORLD and not is_simulated(target):
                raise BenchError(
                    f"The world {spec!r} is not simulated: nobody knows what is true in it, so no "
                    "bench can judge it. Choose a simulated one, e.g. symbolic"
                )
    for option in common.plugin_options():
        if cells and option not in taken and "*" not in taken:
            raise UnknownNameError(
                "--option of these worlds, monitors or VLMs called", option, taken - {"arguments"}
            )


def see_plans(cells: Sequence[Cell], common: TrialConfig, own: Mapping[str, OwnTask]) -> None:
    """See that tasks of the user's own have a plan, where it is known how the world is at first.

    Raises:
        BenchError: There is none for one of them.
    """
    told = any({"start", "priors"} & settings_of(cell.condition).keys() for cell in cells)
    if told or common.start.priors is not None or common.start.what != "known":
        return
    for name in dict.fromkeys(cell.task for cell in cells if cell.task in own):
        task = stage(name, own[name]).task
        if task.left_open:
            continue
        result = shared_planner(common.planner.spec).plan(task, timeout=common.planner.timeout)
        if isinstance(result, Unsolvable):
            raise BenchError(f"{name}: there is no plan from the start: {result.reason}")
