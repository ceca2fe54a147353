"""What the belief monitor must reach, and whether it does."""

from collections.abc import Iterator, Sequence

from tpvqa.bench.cell import Cell
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.statistics import wilson
from tpvqa_experiments.belief.check import Check
from tpvqa_experiments.belief.comparison import Lies, together, votes_beside_curve
from tpvqa_experiments.belief.lasting_targets import lasting_targets
from tpvqa_experiments.belief.learning import (
    LOST,
    RIGHT_TRUST,
    WITHIN,
    after_learning,
    blocks,
    episodes_until_learned,
)
from tpvqa_experiments.belief.parts import (
    BELIEF,
    BELIEVED,
    RECORDED_RIVALS,
    RIVALS,
    SYMBOLIC,
    TRUE_RATES,
    WRONG_MODEL_VLM,
    WRONG_VLM,
    Extent,
    Part,
    knowing,
    noise,
)
from tpvqa_experiments.belief.resampling import Estimate, difference, ratio
from tpvqa_experiments.belief.results import BeliefResults

RATES: dict[tuple[float, float], tuple[float, float, float]] = {
    (0.8, 0.0): (0.96, 0.96, 0.96),
    (0.95, 0.0): (0.98, 0.98, 0.98),
    (0.6, 0.0): (0.80, 0.68, 0.75),
    (0.8, 0.5): (0.93, 0.90, 0.93),
}
"""Completion to reach on clean_dishes, serve_breakfast, eat_apple, by accuracy and ρ."""
PAPER_TABLE_RATES = (0.97, 0.65, 0.94)
QUESTIONS = {"clean_dishes": 0.7, "serve_breakfast": 0.9, "eat_apple": 0.7}
"""Most questions at accuracy .95, of TPVQA's."""
AHEAD = 0.15
"""How far to be above tpvqa:5 on serve_breakfast, at accuracy .8."""
SPEED = {
    "annotation of a plan, median": 15.0,
    "check of a plan, median": 0.2,
    "belief step, 500 facts": 20.0,
    "nearest consistent state, 12,000 facts": 150.0,
}
"""Most milliseconds."""


def targets(results: BeliefResults, extent: Extent) -> list[Check]:
    """Every figure of the table.

    A completion rate, or a difference of two, is reached when the upper end of its 95% interval
    reaches it. Numbers of questions and actions are compared by their means.
    """
    return [
        *_grid_rates(results),
        *_paper_table(results),
        *_curves(results, extent),
        *_embedded(results),
        *_recorded(results, extent),
        *_wrong_model(results),
        *_wrong_vlm(results),
        *lasting_targets(results, extent),
        *_speed(results),
    ]


TASKS = tuple(QUESTIONS)


def _grid_rates(results: BeliefResults) -> Iterator[Check]:
    for (accuracy, rho), rates in RATES.items():
        condition = f"p = {accuracy:g}, ρ = {rho:g}"
        for task, target in zip(TASKS, rates, strict=True):
            cell = Cell(task, BELIEF, noise(accuracy, rho), SYMBOLIC)
            own = results.of(cell)
            yield _rate(condition, task, own, target)
            if (accuracy, rho) == (0.8, 0.0):
                five = results.of(_rival(cell, "tpvqa:5"))
                for name in ("questions", "actions"):
                    yield _share(condition, task, own, five, name, "tpvqa:5", None)
                if task == "serve_breakfast":
                    yield _ahead(condition, task, own, five, "tpvqa:5", AHEAD)
            if (accuracy, rho) == (0.95, 0.0):
                one = results.of(_rival(cell, "tpvqa"))
                yield _share(condition, task, own, one, "questions", "tpvqa", QUESTIONS[task])


def _paper_table(results: BeliefResults) -> Iterator[Check]:
    for task, target in zip(TASKS, PAPER_TABLE_RATES, strict=True):
        own = results.of(Cell(task, BELIEF, "paper-table", SYMBOLIC))
        yield _rate("the paper's table, ρ = 0", task, own, target)


def _curves(results: BeliefResults, extent: Extent) -> Iterator[Check]:
    found, some = [], 0
    for vlm in extent.vlms(extent.accuracies):
        for task in extent.household:
            beside = votes_beside_curve(results, extent, task, vlm, SYMBOLIC)
            if beside:
                verdicts = list(beside.values())
                found.append((f"{task} {vlm}", together(verdicts)))
                some += any(each.lies is Lies.ABOVE for each in verdicts)
    condition, total = "every cell of the grid", len(found)
    if not found:
        yield Check(condition, "curve over the votes", "on or above in all", None, None)
        return
    good = sum(lies in (Lies.ON, Lies.ABOVE) for _, lies in found)
    clear = sum(lies is Lies.ABOVE for _, lies in found)
    poor = ", ".join(f"{name}: {lies}" for name, lies in found if lies in (Lies.BELOW, Lies.LEFT))
    yield Check(
        condition,
        f"curve on or above every vote, of {total} cells",
        f"{total}",
        Estimate(good, good, good),
        good == total,
        poor,
    )
    yield Check(
        condition,
        f"curve clearly above every vote, of {total} cells",
        f"≥ {(total + 1) // 2}",
        Estimate(clear, clear, clear),
        2 * clear >= total,
        f"at least one vote: {some}",
    )


def _embedded(results: BeliefResults) -> Iterator[Check]:
    condition = "the embedded network on the shipped pictures"
    for task in TASKS:
        cell = Cell(task, BELIEF, "embedded", "images")
        own = results.of(cell)
        for rival in RIVALS:
            yield _ahead(condition, task, own, results.of(_rival(cell, rival)), rival, 0.0)
        one = results.of(_rival(cell, "tpvqa"))
        yield _share(condition, task, own, one, "questions", "tpvqa", 1.0)


def _recorded(results: BeliefResults, extent: Extent) -> Iterator[Check]:
    for cell in dict.fromkeys(cell for cell, _ in extent.cells(Part.RECORDED)):
        if cell.monitor != BELIEF:
            continue
        condition = f"{cell.vlm} on the other half"
        own = results.of(cell)
        votes = {
            rival: results.of(_rival(cell, rival)) for rival in RECORDED_RIVALS if rival != "tp"
        }
        best = max(votes, key=lambda rival: _completion(votes[rival]))
        for rival, rows in ((best, votes[best]), ("tp", results.of(_rival(cell, "tp")))):
            yield _ahead(condition, cell.task, own, rows, rival, 0.0)


def _wrong_model(results: BeliefResults) -> Iterator[Check]:
    for rate in TRUE_RATES:
        for task in TASKS:
            cell = Cell(task, BELIEF, WRONG_MODEL_VLM, SYMBOLIC, rate)
            right = results.of(_rival(cell, knowing(rate)))
            condition = f"true {rate.replace('=', ' ')}, believed to be the default"
            yield _ahead(condition, task, results.of(cell), right, "the right model", -LOST)


def _wrong_vlm(results: BeliefResults) -> Iterator[Check]:
    condition = f"{BELIEVED} believed, {WRONG_VLM} in truth"
    for task in TASKS:
        what = f"completion from episode {WITHIN + 1} on less that of the right VLM, {task}"
        found = after_learning(results, task)
        if found is None:
            yield Check(condition, what, f"≥ {-LOST:+.2f}", None, None)
            continue
        told = blocks(results, task)
        episodes = episodes_until_learned(told)
        speed = "not learned" if episodes is None else f"learned after {episodes} episodes"
        note = f"{speed}; trust {told[-1].trust:.2f}, right is {RIGHT_TRUST:.2f}"
        yield Check(condition, what, f"≥ {-LOST:+.2f}", found, found.high >= -LOST, note)


def _speed(results: BeliefResults) -> Iterator[Check]:
    for what, target in SPEED.items():
        value = results.speed.get(what)
        measured = None if value is None else Estimate(value, value, value)
        reached = None if value is None else value <= target
        yield Check("speed", f"{what}, ms", f"≤ {target:g}", measured, reached)


def _rate(condition: str, task: str, rows: Sequence[EpisodeRow], target: float) -> Check:
    what, wanted = f"completion, {task}", f"≥ {target:.2f}"
    if not rows:
        return Check(condition, what, wanted, None, None)
    found = wilson(sum(row.completed for row in rows), len(rows))
    measured = Estimate(found.rate, found.low, found.high)
    return Check(condition, what, wanted, measured, found.high >= target)


def _ahead(
    condition: str,
    task: str,
    own: Sequence[EpisodeRow],
    rows: Sequence[EpisodeRow],
    rival: str,
    target: float,
) -> Check:
    what, wanted = f"completion less {rival}'s, {task}", f"≥ {target:+.2f}" if target else "≥ 0"
    if not own or not rows:
        return Check(condition, what, wanted, None, None)
    found = difference(own, rows)
    return Check(condition, what, wanted, found, found.high >= target)


def _share(
    condition: str,
    task: str,
    own: Sequence[EpisodeRow],
    rows: Sequence[EpisodeRow],
    name: str,
    rival: str,
    most: float | None,
) -> Check:
    what, wanted = f"{name} over {rival}'s, {task}", "< 1" if most is None else f"≤ {most:g}"
    if not own or not rows:
        return Check(condition, what, wanted, None, None)
    found = ratio(own, rows, name)
    reached = found.value < 1 if most is None else found.value <= most
    return Check(condition, what, wanted, found, reached)


def _rival(cell: Cell, monitor: str) -> Cell:
    return Cell(cell.task, monitor, cell.vlm, cell.world, cell.condition)


def _completion(rows: Sequence[EpisodeRow]) -> float:
    return sum(row.completed for row in rows) / len(rows) if rows else -1.0
