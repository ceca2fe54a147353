"""The results of a bench in the terminal."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from tpvqa.cli.saying import cell

if TYPE_CHECKING:
    from rich.table import Table

    from tpvqa.bench.report import Group, Results
    from tpvqa.cli.consoles import ResultConsole


def print_results(results: "Results") -> None:
    """Print completion, accuracy and decisions, a table for each VLM, world and condition."""
    from tpvqa.cli.consoles import ResultConsole

    console = ResultConsole()
    if not console.is_terminal:
        console = ResultConsole(width=164)
    for group in results.groups:
        table = _table(group.title)
        beside = f"vs {results.reference}"
        figures = ("completed", "95% interval", beside, "p", "wrongly done", "questions", "looks")
        _columns(table, ("task", "monitor"), (*figures, "actions", "repeats", "replans", "errors"))
        last = ""
        for each in results.summaries_of(group):
            if last not in ("", each.task):
                table.add_section()
            paired = each.against
            table.add_row(
                cell(each.task if each.task != last else ""),
                cell(each.monitor),
                f"{each.completion_rate:.3f}",
                f"{each.ci_low:.2f}–{each.ci_high:.2f}",
                "" if paired is None else f"{paired.difference:+.3f}",
                "" if paired is None else f"{paired.p:.2g}",
                str(each.wrongly_done),
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
        _print_accuracy(console, results, group)
    crossings = results.crossings()
    if crossings:
        table = _table("better than TP from an accuracy of")
        _columns(table, ("task", "monitor"), ("accuracy",))
        for task, monitor, at in crossings:
            table.add_row(cell(task), cell(monitor), "nowhere" if at is None else f"{at:.2f}")
        console.print(table)
        console.print()


def _print_accuracy(console: "ResultConsole", results: "Results", group: "Group") -> None:
    answers = _table("accuracy of answers")
    names = ("answers", "accuracy", "paper", "decision", "balanced", "AUROC", "ECE", "unanswered")
    _columns(answers, ("task", "asked", "on"), names)
    for line in results.lines(group):
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
            cell(line.task),
            cell(line.way),
            cell(line.source),
            str(found.visible),
            *map(_figure, figures),
        )
    decisions = _table("decisions")
    _columns(decisions, ("task", "monitor", "when"), ("decisions", "accuracy", "wrong goes"))
    decisions.add_column("wrong stops", justify="right")
    for task, monitor, each in results.decision_lines(group):
        rates = (each.accuracy, each.false_go, each.false_stop)
        decisions.add_row(
            cell(task), cell(monitor), each.when, str(each.count), *map(_figure, rates)
        )
    for table in (answers, decisions):
        if table.row_count:
            console.print(table)
            console.print()


def _table(title: str) -> "Table":
    from rich.table import Table

    return Table(
        title=cell(title), title_justify="left", title_style="bold", box=None, pad_edge=False
    )


def _columns(table: "Table", words: Sequence[str], figures: Sequence[str]) -> None:
    for name in words:
        table.add_column(cell(name), no_wrap=True)
    for name in figures:
        table.add_column(cell(name), justify="right", no_wrap=True)


def _figure(value: float | None) -> str:
    return "" if value is None else f"{value:.3f}"
