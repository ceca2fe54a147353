"""`tpvqa risk`: run trials that tell where "done" may be reported under a stated risk."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tpvqa.cli.bench_running import bench_bar
from tpvqa.cli.options import about_files, trial_config, trial_layers, trial_options
from tpvqa.cli.outputs import files_of, see_free, see_unread
from tpvqa.cli.plan import Problem, Task
from tpvqa.cli.saying import tell
from tpvqa.config.layers import Key, Layer
from tpvqa.files import resolved

if TYPE_CHECKING:
    from tpvqa.assembly import Trial
    from tpvqa.belief.calibrating.risk import RiskCalibration
    from tpvqa.bench.own_task import OwnTask

_EXIT = "Exit codes: 0 written, 2 bad input, 6 could not be written, 130 interrupted."
_ELSEWHERE: tuple[Key, ...] = (
    *(("monitor", name) for name in ("majority", "no_alternatives", "experience")),
    *(("monitor", name) for name in ("risk", "risk_file")),
    ("episode",),
)
"""Settings of a trial that mean nothing here."""
_AWAY = Layer({("seed",): 20_000}, {("seed",): "default"})
"""Far from the seeds that trials are usually run under."""
_RISKS = (0.01, 0.02, 0.05, 0.1, 0.2)
"""Risks of which it is told what they come to."""


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command(epilog=_EXIT)(risk)


@trial_options(*_ELSEWHERE, defaults=_AWAY)
def risk(
    task: Task = None,
    problem_file: Problem = None,
    *,
    layers: Sequence[Layer],
    trials: Annotated[
        int,
        typer.Option(help="How many; a risk of .02 takes at least 49, one of .05 19.", min=1),
    ] = 199,
    workers: Annotated[
        int | None, typer.Option(help="Local processes. Default: one a core.", min=1)
    ] = None,
    out: Annotated[
        Path,
        typer.Option(
            help="The file to write. The trials lie in a folder beside it; where they were "
            "stopped, the same command goes on."
        ),
    ] = Path("risk.json"),
    force: Annotated[
        bool, typer.Option("--force", help="Write over a file that is there and is no risk file.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the figures as JSON.")] = False,
) -> None:
    """Run simulated trials with the belief monitor, for `tpvqa run --risk ALPHA --risk-file FILE`.

    Give the options of the trials for which a risk is to be stated. They must be like these, and
    --calibration must be learnt from other trials than these.
    """
    import os

    from tpvqa.assembly import Trial
    from tpvqa.assembly.told import conditions
    from tpvqa.bench.cell import Cell
    from tpvqa.bench.engine import Bench, run_bench
    from tpvqa.bench.stated_risk import learnt

    layers = trial_layers(layers, task, problem_file)
    config = trial_config(layers)
    _check(config.monitor.named, out)
    see_unread(out, "--out", files_of(config))
    see_free(out, "--out", force=force or _is_risk(out))
    for notice in about_files(layers):
        tell(f"note: {notice}", error=True)
    with Trial(config) as trial:
        made_with, told = conditions(trial), trial.calibration
        own = _own(trial)
        name = trial.task.name if own else str(config.task.name)
        cell = Cell(name, config.monitor.named, trial.vlm_spec, trial.world_spec)
    files = ("name", "domain", "problem", "questions", "world_file")
    bench = Bench(
        wanted={cell: trials},
        common=config.but(task=dict.fromkeys(files), monitor={"calibration": None}),
        own={} if own is None else {name: own},
        calibrations=lambda missing: {} if told is None else dict.fromkeys(missing, told),
        more_settings={} if told is None else {"calibration": told.fingerprint},
    )
    folder = out.with_name(f"{out.stem}-trials")
    with bench_bar(folder, "trials") as bar:
        ledger = run_bench(bench, folder, workers=workers or os.cpu_count() or 1, progress=bar)
    known = learnt(ledger.of(cell, trials), made_with)
    known.save(out)
    rows = _rows(known)
    if as_json:
        ended = {"trials": trials, "done": len(known.right), "wrong_done": len(known.wrong)}
        typer.echo(json.dumps({"file": str(out), **ended, "risks": rows}, indent=1))
    else:
        _print(known, rows)
        tell(f"wrote {out}; its trials lie in {folder}")


def _check(monitor: str, out: Path) -> None:
    """What would end the work at its end is told before it."""
    from tpvqa.errors import CalibrationError, TpvqaError
    from tpvqa.files import see_writable
    from tpvqa.monitors.stated_risk import BELIEF, split_risk

    if monitor.partition(":")[0] != BELIEF or split_risk(monitor)[1] is not None:
        raise TpvqaError(
            f"{monitor}: these are trials of the belief monitor that states no risk yet; take "
            "--monitor belief, with the settings it will have besides"
        )
    if out.is_dir():
        raise CalibrationError(f"{out} is a folder; name a file with --out")
    see_writable(out, remedy="Name another file with --out")


def _is_risk(file: Path) -> bool:
    """Whether a file is what this command writes."""
    from tpvqa.belief.calibrating.risk import RiskCalibration
    from tpvqa.errors import CalibrationError

    try:
        RiskCalibration.load(file)
    except CalibrationError:
        return False
    return True


def _own(trial: "Trial") -> "OwnTask | None":
    """The trial's files, unless they are those of a shipped task."""
    from tpvqa.bench.own_task import OwnTask
    from tpvqa.tasks import TaskFiles

    named = trial.config.task
    if named.name is not None and named.questions is None and named.world_file is None:
        return None
    files = TaskFiles(
        name=trial.task.name,
        domain=resolved(trial.domain),
        problem=resolved(trial.problem),
        questions=None if trial.questions is None else resolved(trial.questions),
        world=None if trial.world_file is None else resolved(trial.world_file),
    )
    return OwnTask.read(files)


def _rows(known: "RiskCalibration") -> list[dict[str, float]]:
    """What every risk that so many trials can tell comes to."""
    from tpvqa.belief.calibrating.risk import least_trials

    found = []
    for each in _RISKS:
        if known.trials >= least_trials(each):
            bound = known.bound(each)
            found.append(
                {
                    "risk": each,
                    "above": bound.above,
                    "done": known.completed(bound),
                    "wrong_done": known.mistaken(bound),
                }
            )
    return found


def _print(known: "RiskCalibration", rows: Sequence[dict[str, float]]) -> None:
    from rich.table import Table

    from tpvqa.cli.consoles import ResultConsole

    tell(
        f"{known.trials} trials: {len(known.right)} ended in done, {len(known.wrong)} in done with "
        "the goal false"
    )
    table = Table(box=None)
    for name in ("risk at most", "done above", "done rightly", "done wrongly"):
        table.add_column(name, justify="right", no_wrap=True)
    for row in rows:
        table.add_row(
            f"{row['risk']:g}",
            f"{row['above']:.6f}" if row["above"] else "any",
            f"{row['done']:.3f}",
            f"{row['wrong_done']:.3f}",
        )
    ResultConsole().print(table)
    if not rows:
        tell(f"{known.trials} trials are too few for a risk of {_RISKS[-1]:g}: 4 are needed")
