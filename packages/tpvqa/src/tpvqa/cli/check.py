"""`tpvqa check`: what does not fit in one's own domain, and what to do about it."""

import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from tpvqa.cli.options import task_config
from tpvqa.cli.plan import Domain, OwnProblem, Problem, Task
from tpvqa.cli.saying import tell
from tpvqa.spelling import plain

if TYPE_CHECKING:
    from tpvqa.checking import Finding
    from tpvqa.config import TaskConfig

_EXIT = (
    "Exit codes: 0 no error was found (with --strict: no warning either), 1 there is one, 2 a file "
    "or a task is missing, or the task is too large to be grounded in time."
)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command(epilog=_EXIT)(check)


def check(
    task: Task = None,
    problem_file: Problem = None,
    *,
    domain: Domain = None,
    problem: OwnProblem = None,
    questions_file: Annotated[
        Path | None,
        typer.Option(
            "--questions", help="A questions file. Default: the questions.yaml beside the domain."
        ),
    ] = None,
    world_file: Annotated[
        Path | None,
        typer.Option(help="A world file. Default: the world.yaml beside the domain."),
    ] = None,
    priors: Annotated[
        Path | None, typer.Option(help="A file of priors, as `tpvqa run --priors` reads it.")
    ] = None,
    start: Annotated[
        Literal["known", "unknown"],
        typer.Option(help="What is known at first where the priors are used, as in `tpvqa run`."),
    ] = "known",
    timeout: Annotated[
        float,
        typer.Option(help="Seconds for grounding, and for planning.", min=0.001),
    ] = 60.0,
    strict: Annotated[
        bool, typer.Option("--strict", help="Exit with 1 where there is a warning, too.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Find what does not fit in a domain, its questions, world file and priors, with remedies."""
    from tpvqa.checking import Severity
    from tpvqa.checking import check as found_in
    from tpvqa.errors import GroundingTimedOut
    from tpvqa.planning.making import make_planner

    wanted, _ = task_config(task, problem_file, domain, problem, questions_file, world_file)
    files = _files(wanted)
    planner = make_planner("fast-downward")
    try:
        findings = found_in(
            files[0],
            files[1],
            questions=files[2],
            world_file=files[3],
            priors=priors,
            start=start,
            planner=planner,
            timeout=timeout,
        )
    except GroundingTimedOut as error:
        raise error.by("--timeout") from None
    finally:
        planner.close()
    if as_json:
        print(json.dumps({"findings": [asdict(each) for each in findings]}, indent=1))
    else:
        _print(findings)
    bad = {Severity.ERROR, *([Severity.WARNING] if strict else [])}
    raise typer.Exit(1 if any(each.severity in bad for each in findings) else 0)


def _files(wanted: "TaskConfig") -> tuple[Path, Path, Path | None, Path | None]:
    """Domain, problem, questions and world file of a task."""
    from tpvqa.tasks import find_task

    def path(name: str | None) -> Path | None:
        return None if name is None else _short(Path(name))

    if wanted.name is not None:
        shipped = find_task(wanted.name)
        questions = path(wanted.questions) or shipped.questions
        return shipped.domain, shipped.problem, questions, path(wanted.world_file) or shipped.world
    return (
        _short(Path(wanted.domain or "")),
        _short(Path(wanted.problem or "")),
        path(wanted.questions),
        path(wanted.world_file),
    )


def _short(path: Path) -> Path:
    """A path as seen from here, where it lies below."""
    here = Path.cwd()
    return path.relative_to(here) if path.is_relative_to(here) else path


def _print(findings: "Sequence[Finding]") -> None:
    from tpvqa.checking import Severity

    for each in findings:
        place = f"{each.place}: " if each.place else ""
        says = each.says if each.says.endswith((".", "?")) else f"{each.says}."
        tell(f"{place}{each.severity}: {says}{f' {each.remedy}' if each.remedy else ''}")
        if each.paste:
            tell(f"    in {each.into}:")
            for line in each.paste:
                print(f"      {plain(line)}")
    count = dict.fromkeys(Severity, 0)
    for each in findings:
        count[each.severity] += 1
    said = [f"{n} {kind}{'s' if n != 1 else ''}" for kind, n in count.items() if n]
    tell(", ".join(said) if said else "Nothing was found that does not fit.", error=False)
    sys.stdout.flush()
