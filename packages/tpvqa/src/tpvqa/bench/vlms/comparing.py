"""VLMs side by side on the same answers: as a whole, in parts, and in which words each is best."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from types import MappingProxyType
from typing import Any

from tpvqa.bench.vlms.asking import Row
from tpvqa.bench.vlms.lasting import Lasting, lasting_errors
from tpvqa.bench.vlms.scoring import Difference, Score, difference, score

PARTS: Mapping[str, Callable[[Row], str]] = MappingProxyType(
    {
        "predicate": lambda row: row.predicate,
        "way of asking": lambda row: str(row.way),
        "wording": lambda row: row.wording,
    }
)
"""By what answers are told apart, where there is more than one of it."""
FREE: Mapping[str, float] = MappingProxyType({})
AMONG = "among the best"
NOT_KNOWN = "not known"
"""Whether a wording is among the best, where no interval can be given."""


@dataclass(frozen=True, slots=True)
class Part:
    """Some of the answers of a VLM.

    Attributes:
        by: One of `PARTS`.
        name: Which.
        score: Their figures.
    """

    by: str
    name: str
    score: Score


@dataclass(frozen=True, slots=True)
class OfVLM:
    """What came of one VLM.

    Attributes:
        vlm: Its specification.
        score: Over all its answers.
        lasting: How far its errors last.
        price: Of one question, as it was told; None where nobody did.
        parts: The same in parts.
    """

    vlm: str
    score: Score
    lasting: Lasting
    price: float | None
    parts: tuple[Part, ...]


@dataclass(frozen=True, slots=True)
class Worded:
    """One VLM asked about one predicate in one wording.

    Attributes:
        vlm: Its specification.
        predicate: What is asked about; None for all.
        wording: Which words.
        example: A question in them.
        score: The figures.
        difference: From the first wording, on the same facts in the same pictures; None for it.
        lasting: How far errors last in these words; None but for all predicates.
        verdict: "best" where it is surely better than all others, "among the best" where it is
            the highest or not told apart from that, `NOT_KNOWN` where there are too few groups of
            looks to tell, else empty; by balanced accuracy (or accuracy, where only yes or only no
            is ever right).
    """

    vlm: str
    predicate: str | None
    wording: str
    example: str
    score: Score
    difference: Difference | None
    lasting: Lasting | None
    verdict: str


@dataclass(frozen=True, slots=True)
class Comparison:
    """All that is compared.

    Attributes:
        of: What was asked about.
        looks: How many looks.
        clusters: Independent groups of them.
        cluster: What makes a group, in words.
        vlms: In the order of asking.
        differences: Of every other VLM from the first.
        wordings: Where there are several.
    """

    of: str
    looks: int
    clusters: int
    cluster: str
    vlms: tuple[OfVLM, ...]
    differences: tuple[Difference, ...]
    wordings: tuple[Worded, ...]

    def plain(self) -> dict[str, Any]:
        """As plain JSON values."""
        return asdict(self)


def compare(
    rows: Sequence[Row],
    of: str,
    *,
    cluster: str = "looks",
    prices: Mapping[str, float] = FREE,
    seed: int = 0,
) -> Comparison:
    """Compare the answers of several VLMs.

    Args:
        rows: All answers.
        of: What was asked about.
        cluster: What makes looks a group, in words.
        prices: Of a question, by VLM.
        seed: Decides what is drawn for the intervals.
    """
    by_vlm: dict[str, list[Row]] = {}
    for row in rows:
        by_vlm.setdefault(row.vlm, []).append(row)
    first, *others = by_vlm
    differences = (
        difference(by_vlm[name], by_vlm[first], (name, first), seed=seed) for name in others
    )
    return Comparison(
        of=of,
        looks=len({row.look for row in rows}),
        clusters=len({row.cluster for row in rows}),
        cluster=cluster,
        vlms=tuple(_of_vlm(vlm, own, prices.get(vlm), seed) for vlm, own in by_vlm.items()),
        differences=tuple(each for each in differences if each is not None),
        wordings=tuple(each for own in by_vlm.values() for each in _worded(own, seed)),
    )


def _of_vlm(vlm: str, rows: list[Row], price: float | None, seed: int) -> OfVLM:
    parts = []
    for by, name_of in PARTS.items():
        groups = _groups(rows, name_of)
        if len(groups) > 1:
            parts += [Part(by, name, score(own, seed=seed)) for name, own in groups.items()]
    return OfVLM(vlm, score(rows, seed=seed), lasting_errors(rows, seed=seed), price, tuple(parts))


def _groups(rows: Sequence[Row], name_of: Callable[[Row], str]) -> dict[str, list[Row]]:
    groups: dict[str, list[Row]] = {}
    for row in rows:
        groups.setdefault(name_of(row), []).append(row)
    return groups


def _worded(rows: list[Row], seed: int) -> list[Worded]:
    """A line for every wording of every predicate, and of all; none where there is one wording."""
    if len(_groups(rows, PARTS["wording"])) < 2:
        return []
    predicates = _groups(rows, PARTS["predicate"])
    found = _lines(None, rows, seed)
    for predicate, own in predicates.items():
        if len({row.question for row in own if row.fact == own[0].fact}) > 1:  # it is reworded
            found += _lines(predicate, own, seed)
    return found


def _lines(predicate: str | None, rows: list[Row], seed: int) -> list[Worded]:
    groups = _groups(rows, PARTS["wording"])
    scores = {name: score(own, seed=seed) for name, own in groups.items()}
    first = next(iter(groups))
    best = max(groups, key=lambda name: _merit(scores[name]))
    behind = {
        name: difference(groups[best], own, (best, name), seed=seed)
        for name, own in groups.items()
        if name != best
    }
    verdicts = {name: _verdict(found) for name, found in behind.items()}
    verdicts[best] = _verdict_of_best(set(verdicts.values()))
    return [
        Worded(
            vlm=own[0].vlm,
            predicate=predicate,
            wording=name,
            example=own[0].question,
            score=scores[name],
            difference=None
            if name == first
            else difference(own, groups[first], (name, first), seed=seed),
            lasting=None if predicate else lasting_errors(own, seed=seed),
            verdict=verdicts[name],
        )
        for name, own in groups.items()
    ]


def _verdict(behind: Difference | None) -> str:
    """Of a wording, by how much the best is better."""
    if behind is None or behind.merit.low is None:
        return NOT_KNOWN
    return "" if behind.merit.low > 0 else AMONG


def _verdict_of_best(others: set[str]) -> str:
    """Of the best wording, by what is said of the others."""
    if others == {NOT_KNOWN}:
        return NOT_KNOWN
    return "best" if others == {""} else AMONG


def _merit(found: Score) -> float:
    balanced, plain = found.balanced_accuracy.value, found.accuracy.value
    return (plain or 0.0) if balanced is None else balanced
