"""What the belief monitor must reach where errors last, and whether it does.

A target from below is reached when the upper end of the 95% interval reaches it, one from above
when the lower end does. Under recorded models every cell counts; a line says in how many it is
reached, and names the others.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

from tpvqa_experiments.belief.bounded import bounded
from tpvqa_experiments.belief.check import Check
from tpvqa_experiments.belief.lasting import (
    AFTER,
    EXPERIENCED,
    NOISES,
    RECORDED_QUESTIONS,
    RECORDED_WRONG,
    REDOING,
    RISKS,
    draws,
    experienced,
    lasting_noises,
    recorded_noises,
)
from tpvqa_experiments.belief.parts import BELIEF, Extent
from tpvqa_experiments.belief.resampling import Estimate
from tpvqa_experiments.belief.results import BeliefResults
from tpvqa_experiments.belief.under_noise import (
    Rows,
    UnderNoise,
    ahead_of,
    completion,
    over_robots,
    questions,
    under_noises,
    wrong,
)

TODAY = {"clean_dishes": 35.7, "serve_breakfast": 71.1, "eat_apple": 71.1, "build_tower": 44.2}
"""Questions of a trial before errors that last were known of, redoing free and risky alike, where
every one of 100 trials was completed (`experiments/rows/rivals`)."""
LOST, TIMES = 0.005, 1.1
"""Most completion that may be lost of that, and most questions, of those."""
CLEARLY, PERFECT = 0.05, 0.97
"""How far above the best rival, or how complete, half of the recorded cells must be."""


def lasting_targets(results: BeliefResults, extent: Extent) -> Iterator[Check]:
    """Every figure of the table."""
    for redo in REDOING:
        own = [(noise, list(extent.tasks)) for noise in NOISES]
        for each in _of(under_noises(results, extent, own), redo):
            yield from _one(each)
        yield from _experienced(results, extent, redo)
        recorded = recorded_noises(extent.models, extent.tasks)
        found = list(_of(under_noises(results, extent, recorded), redo)) if recorded else []
        if found:
            yield from _recorded(redo, found)
        yield from _risks(results, extent, redo)


def under(name: str, redo: str) -> str:
    """The name of a condition."""
    return f"{name}; redoing {redo}"


def _of(found: Iterable[UnderNoise], redo: str) -> Iterator[UnderNoise]:
    return (each for each in found if each.redo == redo)


def _one(found: UnderNoise) -> Iterator[Check]:
    noise, task, own = found.noise, found.task, found.own
    where = under(noise.name, found.redo)
    if noise.completion is not None:
        yield at_least(where, f"completion, {task}", noise.completion, own, completion)
    if noise.today:
        yield at_least(where, f"completion, {task}", 1 - LOST, own, completion)
        yield at_most(where, f"questions, {task}", round(TIMES * TODAY[task], 1), own, questions)
    if noise.questions is not None:
        yield at_most(where, f"questions, {task}", noise.questions, own, questions)
        yield from _limit(where, f"questions, {task}", found.limit, questions)
    if noise.wrong is not None:
        yield at_most(where, f"wrong done, {task}", noise.wrong, own, wrong)
        yield from _limit(where, f"wrong done, {task}", found.limit, wrong)
    if noise.behind_blind is not None:
        blind = found.best_blind
        what, target = f"completion less the best blind's, {task}", -noise.behind_blind
        ahead = None if blind is None else ahead_of(own, blind.rows)
        reached = None if ahead is None else ahead.high >= target
        yield Check(where, what, f"≥ {target:+g}", ahead, reached, str(blind or ""))
        yield from _limit(where, f"completion, {task}", found.limit, completion)
    yield _beside(where, found)


def _limit(
    where: str, what: str, limit: Rows, measure: Callable[[Rows], Estimate]
) -> Iterator[Check]:
    """A figure of who knows how its answers err, where that was run."""
    if limit:
        yield Check(where, f"of who knows how answers err: {what}", "–", measure(limit), None)


def _beside(where: str, found: UnderNoise) -> Check:
    """Beside the best rival, where that is not a target."""
    ahead = found.ahead
    note = "" if ahead is None else f"{verdict(ahead)} {found.best}"
    return Check(where, f"completion less the best rival's, {found.task}", "–", ahead, None, note)


def verdict(ahead: Estimate) -> str:
    """What a difference to a rival says, in words."""
    if ahead.high < 0:
        return "worse than"
    return "better than" if ahead.low > 0 else "not worse than"


def _experienced(results: BeliefResults, extent: Extent, redo: str) -> Iterator[Check]:
    where = under(f"10% always misread, the same for {AFTER} trials before", redo)
    for task in extent.tasks:
        robots = late_rows(results, extent, task, redo)
        if robots:
            done = over_robots(robots)
            reached = done.high >= EXPERIENCED
            yield Check(where, f"completion, {task}", f"≥ {EXPERIENCED:g}", done, reached)


def late_rows(results: BeliefResults, extent: Extent, task: str, redo: str) -> list[Rows]:
    """The trials of every robot that has `AFTER` trials behind it."""
    cells = (experienced(task, redo, draw) for draw in draws(extent.lasting))
    robots = ([row for row in results.of(cell) if row.episode >= AFTER] for cell in cells)
    return [rows for rows in robots if rows]


def _recorded(redo: str, found: Sequence[UnderNoise]) -> Iterator[Check]:
    where = under("recorded VLMs on the other half", redo)
    both = [(each, each.ahead) for each in found if each.own]
    beside = [(each, ahead) for each, ahead in both if ahead is not None]
    lost = [(_name(each), f"{ahead.value:+.3f}") for each, ahead in beside if ahead.high < 0]
    yield _count(where, "not worse than the best rival", len(beside), lost)
    short = [
        (_name(each), f"{ahead.value:+.3f}")
        for each, ahead in beside
        if ahead.high < CLEARLY and completion(each.own).high < PERFECT
    ]
    what = f"{CLEARLY:g} above the best rival or ≥ {PERFECT:g}"
    yield _count(where, what, len(beside), short, enough=(len(beside) + 1) // 2)
    truly = [(_name(each), ahead) for each, _ in beside if (ahead := each.ahead_in_truth)]
    behind = [(name, f"{ahead.value:+.3f}") for name, ahead in truly if ahead.high < 0]
    what = "the goal holds in the end, whatever is said, no less often than with the best rival"
    yield replace(_count(where, what, len(truly), behind), target="–", reached=None)
    own = [(_name(each), each.own) for each in found if each.own]
    yield _all_at_most(where, "wrong done", RECORDED_WRONG, own, wrong)
    knowing = [(_name(each), each.limit) for each in found if each.limit]
    if knowing:
        what = "of who knows how answers err: wrong done"
        limit = _all_at_most(where, what, RECORDED_WRONG, knowing, wrong)
        yield replace(limit, target="–", reached=None)
    yield _all_at_most(where, "questions", RECORDED_QUESTIONS, own, questions)


def _risks(results: BeliefResults, extent: Extent, redo: str) -> Iterator[Check]:
    ran = [
        (f"{noise.name} {task}", rows)
        for noise, tasks in lasting_noises(extent.models, extent.tasks)
        for task in tasks
        if (rows := results.of(noise.cell(task, BELIEF, redo)))
    ]
    for risk in RISKS:
        told = [(name, bounded(rows, risk)) for name, rows in ran]
        own = [(name, rows) for name, rows in told if rows]
        if own:
            where = under(f"risk of {risk:g}", redo)
            yield _all_at_most(where, "wrong done", risk, own, wrong)
            left = completion([row for _, rows in own for row in rows])
            out = len(told) - len(own)
            note = f"without {out} cells that are too small to learn it from" if out else ""
            yield Check(where, "completion that is left, of all trials", "–", left, None, note)


def _all_at_most(
    where: str,
    what: str,
    most: float,
    own: Sequence[tuple[str, Rows]],
    measure: Callable[[Rows], Estimate],
) -> Check:
    measured = [(name, measure(rows)) for name, rows in own]
    over = [(name, f"{each.value:.3g}") for name, each in measured if each.low > most]
    return _count(where, f"{what} ≤ {most:g}", len(own), over)


def _count(
    where: str, what: str, total: int, poor: Sequence[tuple[str, str]], enough: int | None = None
) -> Check:
    """In how many cells something is reached."""
    target = f"≥ {enough}" if enough is not None else str(total)
    if not total:
        return Check(where, f"{what}, in cells", target, None, None)
    good = total - len(poor)
    note = "not in: " + ", ".join(f"{name} {value}" for name, value in poor) if poor else ""
    return Check(
        where,
        f"{what}, of {total} cells",
        target,
        Estimate(good, good, good),
        good >= (total if enough is None else enough),
        note,
    )


def at_least(
    where: str, what: str, least: float, rows: Rows, measure: Callable[[Rows], Estimate]
) -> Check:
    """A figure that must not be less."""
    found = measure(rows) if rows else None
    reached = None if found is None else found.high >= least
    return Check(where, what, f"≥ {least:g}", found, reached)


def at_most(
    where: str, what: str, most: float, rows: Rows, measure: Callable[[Rows], Estimate]
) -> Check:
    """A figure that must not be more."""
    found = measure(rows) if rows else None
    reached = None if found is None else found.low <= most
    return Check(where, what, f"≤ {most:g}", found, reached)


def _name(found: UnderNoise) -> str:
    return f"{found.noise.name} {found.task}"
