"""`tpvqa bench`: many episodes, tables and figures."""

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tpvqa_experiments.cli.bench_belief import belief

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from tpvqa.bench.report import Results

bench_app = typer.Typer(
    help="Many episodes: completion rates, accuracy, figures.", no_args_is_help=True
)
_EXIT = "Exit codes: 0 all episodes ran, 1 some failed with an error, 2 bad input, 130 interrupted."


def register(app: typer.Typer) -> None:
    """Add the commands."""
    bench_app.command(epilog=_EXIT)(paper)
    bench_app.command(epilog=_EXIT)(belief)
    app.add_typer(bench_app, name="bench")


@bench_app.callback()
def _bench() -> None:
    """Many episodes: completion rates, accuracy, figures."""


def paper(
    *,
    tasks: Annotated[
        str, typer.Option(help="Shipped tasks, with commas.")
    ] = "clean_dishes,serve_breakfast,eat_apple",
    monitors: Annotated[
        str, typer.Option(help="Monitors, with commas; tpvqa:K votes over K looks.")
    ] = "tpvqa,effectvqa,tp,palmevqa,successvqa",
    vlm: Annotated[
        str,
        typer.Option(
            help="VLMs, with commas: embedded, openai:MODEL, oracle:ACCURACY[:RHO], paper-table, "
            "recorded:MODEL."
        ),
    ] = "embedded",
    world: Annotated[
        str | None,
        typer.Option(help="Default: images for VLMs that look, symbolic for noise models."),
    ] = None,
    episodes: Annotated[int, typer.Option(help="Of every task and monitor.", min=1)] = 100,
    curve: Annotated[
        int | None,
        typer.Option(
            help="Episodes of every point of the accuracy curves; 0 for none. Default: as "
            "--episodes.",
            min=0,
        ),
    ] = None,
    seed: Annotated[int, typer.Option(help="Decides every random number.")] = 0,
    workers: Annotated[
        int | None, typer.Option(help="Local processes. Default: one a core.", min=1)
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(help="Address of a Dask scheduler, e.g. tcp://host:8786.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder; a bench that was stopped goes on.")] = Path(
        "bench"
    ),
    failure: Annotated[float, typer.Option(help="P(an action fails).", min=0, max=1)] = 0.25,
    disturbance: Annotated[
        float, typer.Option(help="P(a failure undoes something achieved).", min=0, max=1)
    ] = 0.25,
    max_repeats: Annotated[int, typer.Option(help="Repeats of an action in a row.", min=0)] = 10,
    max_replans: Annotated[int, typer.Option(help="Replans in a trial.", min=0)] = 10,
    max_actions: Annotated[int, typer.Option(help="Actions in a trial.", min=1)] = 60,
    as_json: Annotated[bool, typer.Option("--json", help="Print the table as JSON.")] = False,
) -> None:
    """Run the paper's experiment: TPVQA against its baselines, with statistics and figures."""
    import os

    from tpvqa.cli.progress import CountBar
    from tpvqa.config import Limits, SimulationConfig, TrialConfig
    from tpvqa_experiments.paper import PaperBench, as_rows, run_paper_bench

    bench = PaperBench(
        tasks=_list(tasks),
        monitors=_list(monitors),
        vlms=_list(vlm),
        world=world,
        episodes=episodes,
        curve=episodes if curve is None else curve,
        common=TrialConfig(
            seed=seed,
            simulation=SimulationConfig(failure=failure, disturbance=disturbance),
            limits=Limits(repeats=max_repeats, replans=max_replans, actions=max_actions),
        ),
    )
    with CountBar() as progress:
        try:
            results = run_paper_bench(
                bench,
                out,
                workers=workers or os.cpu_count() or 1,
                scheduler=scheduler,
                progress=progress,
            )
        except KeyboardInterrupt:
            print(
                f"interrupted; what is finished lies in {out}. The same command goes on there.",
                file=sys.stderr,
            )
            raise typer.Exit(130) from None
    if as_json:
        print(json.dumps(as_rows(results), indent=1))
    else:
        _print(results)
        print(f"tables, figures and report: {out}/report.html")
    if any(each.errors for each in results.summaries):
        raise typer.Exit(1)


def _list(text: str) -> tuple[str, ...]:
    return tuple(dict.fromkeys(part.strip() for part in text.split(",") if part.strip()))


def _print(results: "Results") -> None:
    from rich.console import Console

    console = Console()
    if not console.is_terminal:
        console = Console(width=150)
    for vlm in results.vlms:
        table = _table(vlm)
        figures = ("completed", "95% interval", "vs tpvqa", "p", "questions", "looks", "actions")
        _columns(table, ("task", "monitor"), (*figures, "repeats", "replans", "errors"))
        last = ""
        for each in results.summaries:
            if each.vlm != vlm:
                continue
            if last not in ("", each.task):
                table.add_section()
            paired = each.against
            table.add_row(
                each.task if each.task != last else "",
                each.monitor,
                f"{each.completion_rate:.3f}",
                f"{each.ci_low:.2f}–{each.ci_high:.2f}",
                "" if paired is None else f"{paired.difference:+.3f}",
                "" if paired is None else f"{paired.p:.2g}",
                f"{each.questions:.1f}",
                f"{each.looks:.1f}",
                f"{each.actions:.1f}",
                f"{each.repeats:.1f}",
                f"{each.replans:.1f}",
                str(each.errors),
            )
            last = each.task
        console.print(table)
        console.print()
        _print_accuracy(console, results, vlm)
    crossings = results.crossings()
    if crossings:
        table = _table("better than TP from an accuracy of")
        _columns(table, ("task", "monitor"), ("accuracy",))
        for task, monitor, at in crossings:
            table.add_row(task, monitor, "nowhere" if at is None else f"{at:.2f}")
        console.print(table)
        console.print()


def _print_accuracy(console: "Console", results: "Results", vlm: str) -> None:
    answers = _table("accuracy of answers")
    names = ("answers", "accuracy", "paper", "decision", "balanced", "AUROC", "ECE", "unanswered")
    _columns(answers, ("task", "asked", "on"), names)
    for line in results.lines(vlm):
        found = line.metrics
        figures = (
            found.accuracy,
            line.paper,
            line.decision_accuracy,
            found.balanced_accuracy,
            found.auroc,
            found.calibration_error,
            found.abstained,
        )
        answers.add_row(
            line.task, line.way, line.source, str(found.visible), *map(_figure, figures)
        )
    decisions = _table("decisions")
    _columns(decisions, ("task", "monitor", "when"), ("decisions", "accuracy", "wrong goes"))
    decisions.add_column("wrong stops", justify="right")
    for task, monitor, each in results.decision_lines(vlm):
        rates = (each.accuracy, each.false_go, each.false_stop)
        decisions.add_row(task, monitor, each.when, str(each.count), *map(_figure, rates))
    for table in (answers, decisions):
        if table.row_count:
            console.print(table)
            console.print()


def _table(title: str) -> "Table":
    from rich.table import Table

    return Table(title=title, title_justify="left", title_style="bold", box=None, pad_edge=False)


def _columns(table: "Table", words: Sequence[str], figures: Sequence[str]) -> None:
    for name in words:
        table.add_column(name, no_wrap=True)
    for name in figures:
        table.add_column(name, justify="right", no_wrap=True)


def _figure(value: float | None) -> str:
    return "" if value is None else f"{value:.3f}"
