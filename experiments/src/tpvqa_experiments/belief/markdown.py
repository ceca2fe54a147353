"""The tables of the belief bench in Markdown."""

from collections.abc import Iterable, Iterator, Sequence

from tpvqa.belief.costs import Costs
from tpvqa.belief.filtering.ablations import PARTS
from tpvqa.bench.cell import Cell
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.summary import summarise
from tpvqa_experiments.belief.check import Check
from tpvqa_experiments.belief.comparison import Lies, together, votes_beside_curve
from tpvqa_experiments.belief.learning import BLOCK, blocks
from tpvqa_experiments.belief.parts import (
    BELIEF,
    RIVALS,
    SYMBOLIC,
    Extent,
    Part,
    knowing,
    noise,
    priced,
    without,
)
from tpvqa_experiments.belief.resampling import Estimate, difference
from tpvqa_experiments.belief.results import BeliefResults

REACHED = {True: "yes", False: "**no**", None: "not measured"}


def targets_markdown(checks: Sequence[Check]) -> str:
    """The table of targets."""
    lines = []
    last = ""
    for check in checks:
        measured = "–" if check.measured is None else _estimate(check.measured)
        untold = check.reached is None and check.measured is not None
        said = "" if untold else REACHED[check.reached]
        reached = f"{said} ({check.note})".strip() if check.note else said
        condition = check.condition if check.condition != last else ""
        lines.append((condition, check.what, check.target, measured, reached))
        last = check.condition
    return table(("condition", "figure", "target", "measured", "reached"), lines)


def results_markdown(results: BeliefResults, extent: Extent) -> str:
    """The tables of every part that was run."""
    told = ", ".join(f"{name} {value}" for name, value in results.settings.items())
    sections = [
        ("Accuracy, repeats and task", _grid(results, extent)),
        ("Completion by the cost of a question", _prices(results, extent)),
        ("The paper's table", _full(results, extent, Part.PAPER)),
        ("The embedded network on the shipped pictures", _full(results, extent, Part.EMBEDDED)),
        ("Recorded VLMs", _full(results, extent, Part.RECORDED)),
        ("Wrong action model", _wrong_model(results, extent)),
        ("VLM believed to be better than it is", _wrong_vlm(results, extent)),
        ("Without a part", _ablations(results, extent)),
    ]
    return "\n".join(
        [
            "# The belief monitor, measured\n",
            "Errors are drawn afresh at every look, by recorded VLMs, too (`bench belief`).\n",
            f"Settings: {told}.\n",
            *(f"## {title}\n\n{text}" for title, text in sections if text),
        ]
    )


def _grid(results: BeliefResults, extent: Extent) -> str:
    """A line for every cell: completion @ questions."""
    lines = []
    for vlm in extent.vlms(extent.accuracies):
        for task in extent.household:
            own = results.of(Cell(task, BELIEF, vlm, SYMBOLIC))
            if not own:
                continue
            beside = votes_beside_curve(results, extent, task, vlm, SYMBOLIC)
            rivals = (_short(results.of(Cell(task, each, vlm, SYMBOLIC))) for each in RIVALS)
            clear = sum(each.lies is Lies.ABOVE for each in beside.values())
            verdict = together(list(beside.values())) if beside else ""
            found = summarise(Cell(task, BELIEF, vlm, SYMBOLIC), own, ())
            lines.append(
                (
                    vlm,
                    task,
                    f"{rate(found.completion_rate)} ({rate(found.ci_low)}–{rate(found.ci_high)})"
                    f" @ {found.questions:.0f}",
                    *rivals,
                    f"{verdict} ({clear} of {len(beside)} clearly)" if beside else "",
                )
            )
    if not lines:
        return ""
    names = ("VLM", "task", "belief (95%) @ questions", *RIVALS, "curve over the votes")
    return table(names, lines)


def _prices(results: BeliefResults, extent: Extent) -> str:
    prices = sorted(extent.prices, reverse=True)
    cheaper = [price for price in prices if price < DEFAULT_PRICE]
    dearer = [price for price in prices if price > DEFAULT_PRICE]
    monitors = [*map(priced, dearer), BELIEF, *map(priced, cheaper)]
    lines = []
    for vlm in extent.vlms(extent.accuracies):
        for task in extent.household:
            cells = [results.of(Cell(task, each, vlm, SYMBOLIC)) for each in monitors]
            if any(cells[: len(dearer)]):
                lines.append((vlm, task, *map(_short, cells)))
    names = [f"{price:g}" for price in (*dearer, DEFAULT_PRICE, *cheaper)]
    return table(("VLM", "task", *names), lines) if lines else ""


DEFAULT_PRICE = Costs().question
"""The cost of a question where nothing else is said."""


def _full(results: BeliefResults, extent: Extent, part: Part) -> str:
    """A line for every cell of a part, beside the belief monitor in the same episodes."""
    cells = dict.fromkeys(cell for cell, _ in extent.cells(part))
    order = sorted(cells, key=lambda cell: (cell.vlm, extent.tasks.index(cell.task)))
    lines = list(_lines(results, order))
    names = ("VLM", "task", "monitor", "completed", "95% interval", "belief less it")
    return table((*names, *FIGURES, "how they ended"), lines) if lines else ""


FIGURES = ("questions", "looks", "actions", "repeats", "replans", "wasted")


def _lines(results: BeliefResults, cells: Iterable[Cell]) -> Iterator[Sequence[str]]:
    for cell in cells:
        rows = results.of(cell)
        if not rows:
            continue
        found = summarise(cell, rows, ())
        belief = results.of(Cell(cell.task, BELIEF, cell.vlm, cell.world, cell.condition))
        paired = "" if cell.monitor == BELIEF or not belief else _signed(difference(belief, rows))
        yield (
            cell.vlm,
            cell.task,
            cell.monitor,
            rate(found.completion_rate),
            f"{rate(found.ci_low)}–{rate(found.ci_high)}",
            paired,
            *(f"{getattr(found, name):.1f}" for name in FIGURES),
            ", ".join(f"{name} {count}" for name, count in found.endings.items()),
        )


def _wrong_model(results: BeliefResults, extent: Extent) -> str:
    lines = []
    for cell in dict.fromkeys(cell for cell, _ in extent.cells(Part.WRONG_MODEL)):
        if cell.monitor != BELIEF:
            continue
        knows = Cell(cell.task, knowing(cell.condition), cell.vlm, cell.world, cell.condition)
        wrong, right = results.of(cell), results.of(knows)
        if wrong and right:
            lost = _signed(difference(wrong, right))
            lines.append((cell.condition, cell.task, _short(wrong), _short(right), lost))
    names = ("in truth", "task", "wrong model", "right model", "difference (95%)")
    return table(names, lines) if lines else ""


def _wrong_vlm(results: BeliefResults, extent: Extent) -> str:
    lines = [
        (
            task,
            f"{block.first + 1}–{block.first + BLOCK}",
            rate(block.learning),
            rate(block.knowing),
            _signed(block.difference),
            f"{block.trust:.2f}",
        )
        for task in extent.household
        for block in blocks(results, task)
    ]
    names = ("task", "episodes", "has to learn", "was told", "difference (95%)", "trust")
    return table(names, lines) if lines else ""


def _ablations(results: BeliefResults, extent: Extent) -> str:
    lines = []
    for vlm in (noise(*each) for each in extent.ablated):
        for task in extent.household:
            whole = results.of(Cell(task, BELIEF, vlm, SYMBOLIC))
            parts = [results.of(Cell(task, without(n), vlm, SYMBOLIC)) for n in PARTS]
            if not whole or not any(parts):
                continue
            told = (
                f"{_short(part)}, {_signed(difference(part, whole))}" if part else ""
                for part in parts
            )
            lines.append((vlm, task, _short(whole), *told))
    names = ("VLM", "task", "whole", *(f"without {name}" for name in PARTS))
    return table(names, lines) if lines else ""


def _short(rows: Sequence[EpisodeRow]) -> str:
    """Completion @ questions."""
    if not rows:
        return ""
    completed = sum(row.completed for row in rows) / len(rows)
    return f"{rate(completed)} @ {sum(row.questions for row in rows) / len(rows):.0f}"


def rate(value: float) -> str:
    """A rate with three digits behind its point."""
    return f"{value:.3f}".removeprefix("0") if value < 1 else "1.00"


def _signed(found: Estimate) -> str:
    return f"{found.value:+.3f} ({found.low:+.3f} to {found.high:+.3f})"


def _estimate(found: Estimate) -> str:
    if found.low == found.high:
        return f"{found.value:.4g}"
    return f"{found.value:.3f} ({found.low:.3f} to {found.high:.3f})"


def table(names: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """A table in Markdown."""
    told = [names, ["---"] * len(names), *lines]
    return "".join(f"| {' | '.join(line)} |\n" for line in told)
