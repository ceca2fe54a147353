"""The tables of what was measured where errors last: `lasting.md`, and the same for programs."""

from collections.abc import Iterable, Iterator, Sequence
from statistics import fmean
from typing import Any

from tpvqa.bench.row import EpisodeRow
from tpvqa_experiments.belief.check import Check
from tpvqa_experiments.belief.lasting import AFTER, JUDGED, LIMITS, REDOING
from tpvqa_experiments.belief.lasting_targets import late_rows, verdict
from tpvqa_experiments.belief.markdown import REACHED, rate, table
from tpvqa_experiments.belief.parts import BELIEF, BLIND, FIELD, Extent
from tpvqa_experiments.belief.resampling import Estimate
from tpvqa_experiments.belief.results import BeliefResults
from tpvqa_experiments.belief.under_noise import (
    UnderNoise,
    completion,
    in_truth,
    over_robots,
    questions,
    under_noises,
    wrong,
)


def lasting_rows(results: BeliefResults, extent: Extent) -> list[dict[str, Any]]:
    """One row of plain values for every noise, task and monitor."""
    found = []
    for each in under_noises(results, extent):
        names = each.best.names if each.best else ()
        for monitor, rows in (*_all(each), *((("knowing", each.limit),) if each.limit else ())):
            done, lied, asked = completion(rows), wrong(rows), questions(rows)
            found.append(
                {
                    "noise": each.noise.name,
                    "redo": each.redo,
                    "task": each.task,
                    "vlm": each.noise.vlm,
                    "monitor": monitor,
                    "trials": len(rows),
                    "completion_rate": done.value,
                    "ci_low": done.low,
                    "ci_high": done.high,
                    "wrong_done": lied.value,
                    "wrong_low": lied.low,
                    "wrong_high": lied.high,
                    "goal_holds": in_truth(rows).value,
                    "questions": asked.value,
                    "actions": _actions(rows),
                    "best_rival": monitor in names,
                }
            )
    return found


def lasting_markdown(results: BeliefResults, extent: Extent, checks: Sequence[Check]) -> str:
    """All tables; empty where nothing of it was run.

    Args:
        results: What was run.
        extent: Which tasks and models.
        checks: The figures beside their targets.
    """
    found = list(under_noises(results, extent))
    if not found:
        return ""
    sections = [
        ("Targets", lasting_targets_markdown(checks, extent.tasks)),
        ("Ours beside the best rival", _beside(found)),
        ("Ours beside who knows how its answers err", _limits(found)),
        ("After experience", _experience(results, extent)),
        ("Everybody: completed @ questions", _field(found)),
        ("Everybody: wrong *done*", _lies(found)),
    ]
    told = ", ".join(f"{name} {value}" for name, value in results.settings.items())
    return "\n".join(
        [
            "# Errors that last, measured\n",
            f"Settings: {told}; but limits as `{LIMITS}` has them.\n",
            *(f"## {title}\n\n{text}" for title, text in sections if text),
        ]
    )


def lasting_targets_markdown(checks: Sequence[Check], tasks: Sequence[str]) -> str:
    """The figures beside their targets: those of all tasks, in their order, on one line."""
    lines: dict[tuple[str, str, str], list[Check]] = {}
    for check in checks:
        if check.measured is not None:
            lines.setdefault((check.condition, _figure(check, tasks), check.target), []).append(
                check
            )
    told, last = [], ""
    for (condition, figure, target), own in lines.items():
        told.append(
            (
                condition if condition != last else "",
                figure,
                target,
                "; ".join(_task(check, tasks, len(own)) + _told(check) for check in own),
                _verdict(own),
            )
        )
        last = condition
    names = ("condition", f"figure ({', '.join(tasks)})", "target", "measured", "reached")
    return table(names, told) if told else ""


def _figure(check: Check, tasks: Sequence[str]) -> str:
    what, _, task = check.what.rpartition(", ")
    return what if task in tasks else check.what


def _task(check: Check, tasks: Sequence[str], told: int) -> str:
    """Which task a figure is of, where its line does not have all."""
    task = check.what.rpartition(", ")[2]
    return f"{task} " if task in tasks and told < len(tasks) else ""


def _told(check: Check) -> str:
    """A figure; in bold where its target is not reached, or a rival is better."""
    assert check.measured is not None
    value = _estimate(check.measured)
    lost = check.reached is False or check.note.startswith("worse")
    text = f"**{value}**" if lost else value
    return f"{text} ({check.note})" if check.note else text


def _verdict(own: Sequence[Check]) -> str:
    judged = [check.reached for check in own if check.reached is not None]
    if not judged:
        return ""
    if all(judged) or len(own) == 1:
        return REACHED[all(judged)]
    return f"**no**: {sum(judged)} of {len(judged)}"


def _beside(found: Sequence[UnderNoise]) -> str:
    lines = []
    for each in found:
        best, ahead = each.best, each.ahead
        lost = ahead is not None and ahead.high < 0
        lines.append(
            (
                each.noise.name,
                each.redo,
                each.task,
                *_figures(each.own),
                "" if best is None else str(best),
                *_figures(() if best is None else best.rows),
                "" if ahead is None else f"{'**' * lost}{_signed(ahead)}{'**' * lost}",
                "" if ahead is None else verdict(ahead).removesuffix(" than"),
            )
        )
    names = ("completed (95%)", "wrong *done*", "goal holds", "questions", "actions")
    heads = ("answers", "redoing", "task", *names, "best rival", *names, "less it (95%)", "is")
    return table(heads, lines) if lines else ""


def _limits(found: Sequence[UnderNoise]) -> str:
    """Ours, and the same told how its answers err, on the trials that both ran."""
    lines = []
    for each in found:
        both = {row.episode for row in each.own} & {row.episode for row in each.limit}
        if both:
            own, limit = (
                _figures([row for row in rows if row.episode in both])
                for rows in (each.own, each.limit)
            )
            lines.append((each.noise.name, each.redo, each.task, *own, *limit))
    names = ("completed (95%)", "wrong *done*", "goal holds", "questions", "actions")
    heads = ("answers", "redoing", "task", *names, *(f"{name}, knowing" for name in names))
    text = (
        "The same monitor, calibrated on the very answers that it gets (of recorded VLMs the same "
        "half of the problems, of the others the flaw itself), and told that nothing works loose "
        "of itself; on the trials that both ran.\n\n"
    )
    return text + table(heads, lines) if lines else ""


def _figures(rows: Sequence[EpisodeRow]) -> tuple[str, str, str, str, str]:
    if not rows:
        return ("", "", "", "", "")
    return (
        f"{_estimate(completion(rows))} of {len(rows)}",
        rate(wrong(rows).value),
        rate(in_truth(rows).value),
        f"{questions(rows).value:.0f}",
        f"{_actions(rows):.1f}",
    )


def _experience(results: BeliefResults, extent: Extent) -> str:
    lines = []
    for redo in REDOING:
        for task in extent.tasks:
            robots = late_rows(results, extent, task, redo)
            if robots:
                rows = [row for own in robots for row in own]
                done = _estimate(over_robots(robots))
                lines.append((redo, task, str(len(robots)), done, *_figures(rows)[1:]))
    names = ("wrong *done*", "goal holds", "questions", "actions")
    heads = ("redoing", "task", "robots", "completed (95%)", *names)
    text = (
        f"The same 10% of the questions are always misread; trials {AFTER + 1} to "
        f"{AFTER + JUDGED} of every robot, of which each counts once.\n\n"
    )
    return text + table(heads, lines) if lines else ""


def _field(found: Sequence[UnderNoise]) -> str:
    """Every monitor under every noise."""
    return _matrix(
        found,
        lambda monitor, rows: (
            rate(completion(rows).value)
            + ("" if monitor in BLIND else f" @ {questions(rows).value:.0f}")
            + f" ({len(rows)})"
        ),
    )


def _lies(found: Sequence[UnderNoise]) -> str:
    return _matrix(found, lambda _, rows: rate(wrong(rows).value))


def _matrix(found: Sequence[UnderNoise], told: Any) -> str:
    monitors = [*BLIND, *FIELD, BELIEF]
    lines = []
    for each in found:
        own = dict(_all(each))
        cells = (told(name, own[name]) if name in own else "" for name in monitors)
        lines.append((each.noise.name, each.redo, each.task, *cells))
    return table(("answers", "redoing", "task", *monitors), lines)


def _all(each: UnderNoise) -> Iterator[tuple[str, Sequence[EpisodeRow]]]:
    yield from each.rivals.items()
    if each.own:
        yield BELIEF, each.own


def _actions(rows: Iterable[EpisodeRow]) -> float:
    return fmean(row.actions for row in rows)


def _estimate(found: Estimate) -> str:
    if found.low == found.high:
        return f"{found.value:.4g}"
    if found.value > 1:
        return f"{found.value:.0f} ({found.low:.0f}–{found.high:.0f})"
    return f"{found.value:.2f} ({found.low:.2f}–{found.high:.2f})"


def _signed(found: Estimate) -> str:
    return f"{found.value:+.3f} ({found.low:+.3f} to {found.high:+.3f})"
