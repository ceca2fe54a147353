"""`tpvqa bench run`: many episodes of anybody's tasks, monitors and VLMs."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tpvqa.cli.bench_running import EXIT, bench_bar, finish, listed
from tpvqa.cli.notices import about_own_files
from tpvqa.cli.options import trial_options
from tpvqa.cli.plugged import PartGroup
from tpvqa.cli.saying import tell
from tpvqa.config.layers import Key, Layer

if TYPE_CHECKING:
    from tpvqa.belief.calibrating.calibration import Calibration
    from tpvqa.bench.grid import Grid
    from tpvqa.bench.own_task import OwnTask
    from tpvqa.config import TrialConfig

MONITORS = "tpvqa,belief,tp"
_TASK: tuple[Key, ...] = tuple(
    ("task", name) for name in ("name", "domain", "problem", "questions", "world_file")
)
_CROSSED: tuple[Key, ...] = (("world", "spec"), ("vlm", "spec"), ("monitor", "spec"))
_OF_ONE: tuple[Key, ...] = (
    *(("monitor", name) for name in ("majority", "experience", "risk", "risk_file")),
    ("episode",),
)

bench_app = typer.Typer(
    help="Many episodes: completion rates, accuracy, figures.",
    no_args_is_help=True,
    cls=PartGroup,
)


def register(app: typer.Typer) -> None:
    """Add the commands."""
    bench_app.command(epilog=EXIT)(run)
    app.add_typer(bench_app, name="bench")


@bench_app.callback()
def _bench() -> None:
    """Many episodes: completion rates, accuracy, figures."""


@trial_options(*_TASK, *_CROSSED, *_OF_ONE)
def run(
    tasks: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[TASK]...",
            help="Shipped tasks (see `tpvqa tasks`), your own problem files or logic programs "
            "(.lp), or folders of them. Without --domain, the domain.pddl beside a problem is "
            "taken; so are a questions.yaml and a world.yaml beside problem or domain, unless "
            "others are named.",
        ),
    ] = None,
    *,
    layers: Sequence[Layer],
    domain: Annotated[
        Path | None,
        typer.Option(help="Your own domain, which all problems are of, or a logic program (.lp)."),
    ] = None,
    problem: Annotated[
        list[Path] | None,
        typer.Option(help="Your own problem, or a folder of them; may be given several times."),
    ] = None,
    questions: Annotated[Path | None, typer.Option(help="Questions for your domain.")] = None,
    world_file: Annotated[
        Path | None, typer.Option(help="What disturbances undo in your domain, and what is sensed.")
    ] = None,
    monitors: Annotated[
        str | None,
        typer.Option(
            "--monitors",
            "--monitor",
            help=f"Monitors, with commas; all are compared with the first. Default: {MONITORS}.",
        ),
    ] = None,
    vlm: Annotated[
        str | None,
        typer.Option("--vlm", "--vlms", help="VLMs, with commas. Default: as of `tpvqa run`."),
    ] = None,
    worlds: Annotated[
        str | None,
        typer.Option(
            "--worlds", "--world", help="Worlds, with commas. Default: symbolic, or the task's own."
        ),
    ] = None,
    conditions: Annotated[
        list[str] | None,
        typer.Option(
            help="What differs between cells: settings with commas, conditions with semicolons (or "
            "the option several times), e.g. ';failure=0.4,actions=30', where nothing before the "
            "semicolon stands for no change. Settings: failure, disturbance, spontaneous, redo, "
            "moved, dead, elsewhere, repeats, replans, actions, seconds, limits=none, planner, "
            "believed, carried."
        ),
    ] = None,
    episodes: Annotated[int, typer.Option(help="Of every cell.", min=1)] = 100,
    risk_trials: Annotated[
        int | None,
        typer.Option(
            help="Of other seeds, for every cell that states a risk (belief:risk=.02). "
            "Default: 199.",
            min=1,
        ),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(help="Local processes. Default: one a core.", min=1)
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(help="Address of a Dask scheduler, e.g. tcp://host:8786.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder; a bench that was stopped goes on.")] = Path(
        "bench-run"
    ),
    as_json: Annotated[bool, typer.Option("--json", help="Print the table as JSON.")] = False,
) -> None:
    """Run episodes of any tasks under any monitors, with any VLMs, in any worlds and conditions."""
    import os

    from tpvqa.bench.checking import check, see_plans
    from tpvqa.bench.compared import run_compared
    from tpvqa.bench.condition import normalised
    from tpvqa.bench.grid import Grid
    from tpvqa.bench.stated_risk import TRIALS
    from tpvqa.config.layers import combined
    from tpvqa.plugins import Kind, load_spec
    from tpvqa.vlm.capabilities import is_noise_model

    config = combined(layers)
    given = {key for layer in layers for key in layer.values}
    shipped, own = _tasks(tasks or [], [*(problem or [])], domain, questions, world_file, config)
    named = config.monitor.named if ("monitor", "spec") in given else MONITORS
    grid = Grid(
        tasks=shipped,
        own=own,
        monitors=_some(monitors, named, "--monitors"),
        vlms=_some(vlm, config.vlm.spec or "", "--vlm"),
        worlds=_some(worlds, config.world.spec or "", "--worlds"),
        conditions=tuple(
            dict.fromkeys(
                normalised(part) for text in conditions or [""] for part in text.split(";")
            )
        ),
    )
    calibration = _calibration(config)
    of_one = dict.fromkeys(("calibration", "risk", "risk_file"))
    common = config.but(task={name: None for _, name in _TASK}, monitor=of_one)
    beside = about_own_files(
        (each.origin for each in own.values()),
        questions=questions or config.task.questions,
        world_file=world_file or config.task.world_file,
    )
    cells = grid.cells()
    given_truth = [cell for cell in cells if is_noise_model(load_spec(Kind.VLM, cell.vlm))]
    check(given_truth, common.but(options={}), own)  # what is refused needs no advice before
    see_plans(cells, common, own)
    for notice in (*beside, *_notices(grid, calibration)):
        tell(f"note: {notice}", error=True)
    with bench_bar(out) as progress:
        results = run_compared(
            grid,
            out,
            episodes=episodes,
            common=common,
            calibration=calibration,
            risk_trials=risk_trials or TRIALS,
            workers=workers or os.cpu_count() or 1,
            scheduler=scheduler,
            progress=progress,
        )
    finish(results, out, as_json=as_json)


def _some(text: str | None, default: str, option: str) -> tuple[str, ...]:
    from tpvqa.errors import BenchError

    found = listed(default if text is None else text)
    if text is not None and not found:
        raise BenchError(f"{option} names nothing; leave it out, or write names with commas")
    return found


def _tasks(
    named: Sequence[str],
    problems: list[Path],
    domain: Path | None,
    questions: Path | None,
    world_file: Path | None,
    config: "TrialConfig",
) -> "tuple[tuple[str, ...], Mapping[str, OwnTask]]":
    """The shipped tasks, and the user's own by their names."""
    from tpvqa.bench.own_task import own_tasks
    from tpvqa.errors import BenchError
    from tpvqa.tasks import domain_and_problem, is_program

    shipped = [name for name in named if not _is_path(name)]
    problems = [Path(name) for name in named if _is_path(name)] + problems
    if not problems and domain is not None and is_program(domain):
        problems = [domain]
    file = config.task
    of_file = domain_and_problem(file.domain, file.problem)
    if not shipped and not problems:
        if file.name is not None:
            shipped = [file.name]
        elif of_file[0] is not None and of_file[1] is not None:
            problems = [Path(of_file[1])]
            domain, questions, world_file = (
                given or (None if known is None else Path(known))
                for given, known in (
                    (domain, of_file[0]),
                    (questions, file.questions),
                    (world_file, file.world_file),
                )
            )
        else:
            raise BenchError(
                "No task is named. Name shipped ones (see `tpvqa tasks`), or problems of your own, "
                "e.g. --domain domain.pddl --problem problem.pddl"
            )
    if not problems and (domain or questions or world_file):
        raise BenchError(
            "--domain, --questions and --world-file are of your own problems, and none is named. "
            "Name them with --problem"
        )
    own = own_tasks(problems, domain=domain, questions=questions, world_file=world_file)
    return tuple(dict.fromkeys(shipped)), own


def _is_path(name: str) -> bool:
    from tpvqa.tasks import is_program

    return "/" in name or is_program(name) or name.lower().endswith(".pddl") or Path(name).is_dir()


def _calibration(config: "TrialConfig") -> "Calibration | None":
    from tpvqa.belief.calibrating.named_calibration import named_calibration

    file = config.monitor.calibration
    return None if file is None else named_calibration(Path(file))


def _notices(grid: "Grid", calibration: "Calibration | None") -> list[str]:
    """What a user should know of what the VLMs' answers are taken to be worth."""
    from tpvqa.belief.calibrating.shipped import shipped_calibration
    from tpvqa.cli.notices import about_calibration
    from tpvqa.errors import BenchError
    from tpvqa.plugins import Kind, load_spec, takes

    weighing: dict[str, Any] = {
        spec: None
        for spec in grid.monitors
        if {"calibration", "*"} & takes(load_spec(Kind.MONITOR, spec))
    }
    if not weighing:
        if calibration is not None:
            raise BenchError(
                "No monitor weighs answers: leave out --calibration, or name belief in --monitors"
            )
        return []
    vlms = dict.fromkeys(cell.vlm for cell in grid.cells() if cell.monitor in weighing)
    return [
        notice
        for vlm in vlms
        for notice in about_calibration(vlm, calibration or shipped_calibration(vlm))
    ]
