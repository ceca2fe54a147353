"""What a calibration has learnt, as a table, as JSON and as a picture."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from tpvqa.cli.saying import cell, tell

if TYPE_CHECKING:
    from tpvqa.belief import Calibration
    from tpvqa.belief.calibrating.counted import CountedFaults
    from tpvqa.belief.calibrating.held_out import HeldOut
    from tpvqa.bench.reliability import Line


def draw(path: Path, judged: "Sequence[HeldOut]", vlm: str) -> None:
    """Draw reliability before and after.

    Raises:
        WriteError: It cannot be written.
    """
    from tpvqa.bench.figures import close, saved
    from tpvqa.bench.reliability import reliability_figure
    from tpvqa.errors import WriteError
    from tpvqa.files import write_whole

    remedy = "Name another file with --curves"
    figure = reliability_figure(judged, vlm)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, saved(figure, "svg" if path.suffix == ".svg" else "png"), remedy=remedy)
    except OSError as error:
        raise WriteError.of(path, error, remedy) from error
    finally:
        close(figure)


def plain(
    calibration: "Calibration", table: "Sequence[Line]", out: Path, image: Path
) -> dict[str, object]:
    """What `--json` prints."""
    return {
        "vlm": calibration.vlm,
        "rows": calibration.rows,
        "by_hand": calibration.by_hand,
        "inferred": calibration.inferred,
        "file": str(out),
        "curves": str(image),
        "repeat_same_view": calibration.repeat_same_view,
        "repeat_other_view": calibration.repeat_other_view,
        "lasting_share": round(calibration.lasting_share, 3),
        "notices": calibration.notices,
        "sensors": [each.model_dump() for each in calibration.sensors],
        "skills": [each.model_dump() for each in calibration.skills],
        "faults": None if calibration.faults is None else calibration.faults.model_dump(),
        "lines": [asdict(line) for line in table],
    }


def print_calibration(calibration: "Calibration", table: "Sequence[Line]") -> None:
    """Print how reliable answers are, before and after."""
    from rich.table import Table

    from tpvqa.cli.consoles import ResultConsole

    printed = Table(title=cell(calibration.vlm), title_justify="left", title_style="bold", box=None)
    for name in ("asked as", "about"):
        printed.add_column(name, no_wrap=True)
    for name in ("answers", "abstained", "accuracy", "yes if true", "yes if false"):
        printed.add_column(name, justify="right", no_wrap=True)
    printed.add_column("ECE before → after", justify="right", no_wrap=True)
    for line in table:
        figures = (line.abstained, line.accuracy, line.yes_if_true, line.yes_if_false)
        printed.add_row(
            cell(line.way or "all"),
            cell(line.predicate or ""),
            str(line.answers),
            *map(_figure, figures),
            f"{_figure(line.error_before)} → {_figure(line.error_after)}",
            end_section=line is table[-2],
        )
    console = ResultConsole()
    (console if console.is_terminal else ResultConsole(width=120)).print(printed)
    typer.echo()
    if table[-1].answers < calibration.rows:
        tell(
            f"{table[-1].answers} of {calibration.rows} answers, the first to the same words since "
            "a fact changed, tell how often it is right; the others how further looks go."
        )
    typer.echo(
        f"A further look repeats the last answer (ρ): {calibration.repeat_same_view:.2f} from "
        f"the same view, {calibration.repeat_other_view:.2f} from another; of the rest "
        f"{calibration.lasting_share:.2f} are one draw for all looks at a scene (lasting share)."
    )
    for each in calibration.sensors:
        tell(
            f"sensed: {each.predicate} is said to hold in {each.says_if_true:.3f} where it does "
            f"and in {each.says_if_false:.3f} where it does not ({_readings(each.rows)})."
        )
    for skill in calibration.skills:
        tell(
            f"skills: {skill.action or 'all'} reports {skill.notices:.3f} of its failures, and "
            f"{skill.false_alarms:.3f} of its successes as failures ({skill.rows} actions)."
        )
    if calibration.faults is not None:
        _tell_faults(calibration.faults)
    for notice in calibration.notices:
        tell(f"note: {notice}")


def _tell_faults(faults: "CountedFaults") -> None:
    """What was counted of actions, a line for all skills."""
    told = [f"{name} {each.failed} of {each.tries}" for name, each in faults.skills.items()]
    if told:
        tell(f"failed, where it was possible: {', '.join(told)}.")
    kinds = ("failures", faults.disturbance), ("successes", faults.spontaneous)
    undone = [
        f"{cases[0]} of {sum(cases)} {what}"
        for what, cases in (*kinds, ("actions with nothing left to do", faults.redone))
        if sum(cases)
    ]
    if undone:
        tell(f"something came undone in {', '.join(undone)}.")


def _readings(count: int) -> str:
    return f"{count} reading{'s' * (count != 1)}"


def _figure(value: float | None) -> str:
    return "–" if value is None else f"{value:.3f}"
