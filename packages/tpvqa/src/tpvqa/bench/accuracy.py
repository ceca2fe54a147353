"""How right the answers and the decisions were: the paper's accuracy table, and more."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from tpvqa.bench.row import EpisodeRow, split_answers
from tpvqa.questions import Way
from tpvqa.vlm.metrics import Metrics, Scored, measure


@dataclass(frozen=True, slots=True)
class Decisions:
    """How right the decisions of one kind were.

    Attributes:
        when: "before" an action or "after" it.
        count: How many.
        accuracy: Went on where the action was possible (or had succeeded), and only there.
        false_go: Went on though it was not, among all where it was not; None for none.
        false_stop: Did not go on though it was, among all where it was; None for none.
    """

    when: str
    count: int
    accuracy: float
    false_go: float | None
    false_stop: float | None


def answers_of(rows: Iterable[EpisodeRow], way: Way) -> Metrics | None:
    """Figures over the answers that were given in one way of asking; None without any."""
    counts: Counter[str] = Counter()
    for row in rows:
        given = {key: n for key, n in row.answers.items() if n and key.startswith(f"{way}|")}
        counts.update(given)
    scored = list(_scored(counts))
    return measure(scored) if scored else None


def _scored(counts: Mapping[str, int]) -> Iterator[Scored]:
    for key, count in counts.items():
        _, _, truth, reply, p_yes = split_answers(key)
        yield Scored(reply, truth, p_yes, count=count)


def decisions_of(rows: Iterable[EpisodeRow], when: str) -> Decisions | None:
    """Figures over the decisions before or after actions; None without any."""
    counts: Counter[str] = Counter()
    for row in rows:
        counts.update({k: n for k, n in row.decisions.items() if k.startswith(f"{when}|")})
    total = sum(counts.values())
    if not total:
        return None
    false_go, stopped = counts[f"{when}|0|1"], counts[f"{when}|0|0"]
    went, false_stop = counts[f"{when}|1|1"], counts[f"{when}|1|0"]
    return Decisions(
        when,
        total,
        (went + stopped) / total,
        false_go / (false_go + stopped) if false_go + stopped else None,
        false_stop / (false_stop + went) if false_stop + went else None,
    )
