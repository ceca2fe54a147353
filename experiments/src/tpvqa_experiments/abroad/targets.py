"""What the belief monitor must reach abroad, and whether it does."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from statistics import fmean, median, stdev

from tpvqa.bench.cell import Cell
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.statistics import wilson
from tpvqa_experiments.abroad.parts import BELIEF, REPEATING, SEEING, Part
from tpvqa_experiments.abroad.tables import PATIENCE, Rows, asked, paired_actions
from tpvqa_experiments.belief.check import Check
from tpvqa_experiments.belief.resampling import Estimate, difference, ratio

Own = Mapping[Cell, Sequence[EpisodeRow]]
COMPLETION = {
    Part.OTHERS: 0.97,
    Part.OWN: 0.95,
    Part.SENSED: 0.95,
    Part.ELSEWHERE: 0.90,
    Part.NOTHING: 0.95,
}
"""Over all tasks of a part together."""
FAILURES = {"failure=0.6": 0.97, "failure=0.8": 0.80}
TIMES_SEEING = {Part.OWN: 1.8, Part.SENSED: 1.25}
"""Most actions, of those of who sees all."""
MORE_THAN_SEEING = 4.0
"""Most actions above who sees all where a thing is elsewhere."""
QUESTIONS = 8.0, 25.0
"""Most questions an action in others' domains: in the median one and in the worst."""
NAMED, MISNAMED = 0.95, 0.01
SHIPPED = {"clean_dishes": 0.996, "serve_breakfast": 0.998, "eat_apple": 0.999}
"""Completion of the shipped tasks as it was (version 0.3)."""
LEAD = "lead:"
SHARE = 0.5
"""Most questions, of those of the best lead."""


def targets(parts: Mapping[Part, Rows]) -> list[Check]:
    """Every figure of the table that was run.

    A target from below is reached when the upper end of the 95% interval reaches it, one from
    above when the lower end does. Trials of all tasks of a part count together.
    """
    return [check for part, rows in parts.items() if rows for check in _of(part, rows)]


def _of(part: Part, rows: Rows) -> Iterator[Check]:
    for vlm in dict.fromkeys(cell.vlm for cell in rows):
        of_vlm = {cell: own for cell, own in rows.items() if cell.vlm == vlm and own}
        for condition in dict.fromkeys(cell.condition for cell in of_vlm):
            told = {cell: own for cell, own in of_vlm.items() if cell.condition == condition}
            own = {cell: each for cell, each in told.items() if cell.monitor == BELIEF}
            if own:
                name = f"{part}: {vlm}, {condition}"
                yield from _CHECKS[part](name, part, own, told)


def _completion(name: str, part: Part, own: Own, _: Rows) -> Iterator[Check]:
    yield _rate(name, "completion", own, COMPLETION[part])


def _others(name: str, part: Part, own: Own, rows: Rows) -> Iterator[Check]:
    yield from _completion(name, part, own, rows)
    every = [asked(each) for each in own.values()]
    for what, value, most in (
        ("questions an action, median of the domains", median(every), QUESTIONS[0]),
        ("questions an action, worst domain", max(every), QUESTIONS[1]),
    ):
        yield Check(name, what, f"≤ {most:g}", Estimate(value, value, value), value <= most)


def _beside_seeing(name: str, part: Part, own: Own, rows: Rows) -> Iterator[Check]:
    yield from _completion(name, part, own, rows)
    found = [
        ratio(*pairs, "actions")
        for cell, each in own.items()
        if (pairs := _both_done(each, rows.get(replace(cell, monitor=SEEING), ())))
    ]
    most = TIMES_SEEING[part]
    yield _most(name, "actions over those of who sees all", most, _mean(found))
    yield from _by_repetition(name, part, own, rows)


def _by_repetition(name: str, part: Part, own: Own, rows: Rows) -> Iterator[Check]:
    """What whoever sees all that can be seen needs: the fewest that complete often enough."""
    what = "the same, least possible by repetition"
    told = [_least(cell, part, rows) for cell in own]
    found = [least for least in told if least is not None]
    times = ", ".join(
        f"{cell.task} {each[0]}" for cell, each in zip(own, told, strict=True) if each
    )
    least = _mean([each for _, each in found]) if len(found) == len(told) else None
    yield Check(
        name, what, "–", least, None, f"every hidden step so often: {times}" if times else ""
    )


def _least(cell: Cell, part: Part, rows: Rows) -> tuple[int, Estimate] | None:
    """How often hidden steps are done in the least, and its actions over those of who sees all."""
    seeing = rows.get(replace(cell, monitor=SEEING), ())
    enough = {
        times: ratio(*pairs, "actions")
        for times, limit in enumerate(REPEATING, start=1)
        if (each := rows.get(replace(cell, monitor=limit), ()))
        and _done(each) >= COMPLETION[part]
        and (pairs := _both_done(each, seeing))
    }
    least = min(enough, key=lambda times: enough[times].value, default=None)
    return None if least is None else (least, enough[least])


def _elsewhere(name: str, part: Part, own: Own, rows: Rows) -> Iterator[Check]:
    yield from _completion(name, part, own, rows)
    more = [
        float(here - there)
        for cell, each in own.items()
        for here, there in paired_actions(each, rows.get(replace(cell, monitor=SEEING), ()))
    ]
    what = "actions less those of who sees all"
    yield _most(name, what, MORE_THAN_SEEING, _mean_of(more))


def _dead(name: str, _: Part, own: Own, __: Rows) -> Iterator[Check]:
    for cell, each in own.items():
        tried = [row for row in each if row.dead]
        what = f"named within {PATIENCE} tries, {cell.task}"
        if tried:
            named = sum(row.named is not None and row.named <= PATIENCE for row in tried)
            yield _at_least(name, what, named, len(tried), NAMED)
        yield _misnamed(name, f", {cell.task}", {cell: each})


def _failure(name: str, _: Part, own: Own, __: Rows) -> Iterator[Check]:
    wanted = next((rate for told, rate in FAILURES.items() if told in name), None)
    if wanted is not None:
        yield _rate(name, "completion", own, wanted)


def _shipped(name: str, _: Part, own: Own, rows: Rows) -> Iterator[Check]:
    for cell, each in own.items():
        if cell.task in SHIPPED:
            what, one = f"completion, {cell.task}", {cell: each}
            yield _rate(name, what, one, SHIPPED[cell.task])
        leads = {
            rival.monitor: found
            for rival, found in rows.items()
            if rival.task == cell.task and rival.monitor.startswith(LEAD)
        }
        if leads:
            best = max(leads, key=lambda lead: (_done(leads[lead]), -_questions(leads[lead])))
            ahead = difference(each, leads[best])
            what = f"completion less {best}'s, {cell.task}"
            yield Check(name, what, "≥ 0", ahead, ahead.high >= 0)
            share = ratio(each, leads[best], "questions")
            yield _most(name, f"questions over {best}'s, {cell.task}", SHARE, share)
    yield _misnamed(name, "", own)


_CHECKS: Mapping[Part, Callable[[str, Part, Own, Rows], Iterator[Check]]] = {
    Part.OTHERS: _others,
    Part.OWN: _beside_seeing,
    Part.SENSED: _beside_seeing,
    Part.ELSEWHERE: _elsewhere,
    Part.NOTHING: _completion,
    Part.DEAD: _dead,
    Part.FAILURE: _failure,
    Part.SHIPPED: _shipped,
}


def _rate(name: str, what: str, own: Own, target: float) -> Check:
    values = [row.completed for each in own.values() for row in each]
    return _at_least(name, what, sum(values), len(values), target)


def _at_least(name: str, what: str, count: int, of: int, target: float) -> Check:
    found = wilson(count, of)
    measured = Estimate(found.rate, found.low, found.high)
    return Check(name, what, f"≥ {target:g}", measured, found.high >= target)


def _misnamed(name: str, where: str, own: Own) -> Check:
    values = [bool(row.misnamed) for each in own.values() for row in each]
    found = wilson(sum(values), len(values))
    measured = Estimate(found.rate, found.low, found.high)
    return _most(name, f"working skill called dead{where}", MISNAMED, measured)


def _most(name: str, what: str, most: float, found: Estimate | None) -> Check:
    reached = None if found is None else found.low <= most
    return Check(name, what, f"≤ {most:g}", found, reached)


def _both_done(
    own: Sequence[EpisodeRow], limit: Sequence[EpisodeRow]
) -> tuple[list[EpisodeRow], list[EpisodeRow]] | None:
    """The episodes that both completed."""
    done = {row.episode for row in own if row.completed}
    done &= {row.episode for row in limit if row.completed}
    if not done:
        return None
    return [row for row in own if row.episode in done], [r for r in limit if r.episode in done]


def _mean(found: Sequence[Estimate]) -> Estimate | None:
    """The mean over tasks, which ran independently of each other."""
    if not found:
        return None
    value = fmean(each.value for each in found)
    spread = sum(((each.high - each.low) / 2) ** 2 for each in found) ** 0.5 / len(found)
    return Estimate(value, value - spread, value + spread)


def _mean_of(values: Sequence[float]) -> Estimate | None:
    if len(values) < 2:
        return None
    value, half = fmean(values), 1.96 * stdev(values) / len(values) ** 0.5
    return Estimate(value, value - half, value + half)


def _done(rows: Sequence[EpisodeRow]) -> float:
    return sum(row.completed for row in rows) / len(rows)


def _questions(rows: Sequence[EpisodeRow]) -> float:
    return sum(row.questions for row in rows) / len(rows)
