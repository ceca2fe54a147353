"""Recorded answers of VLMs, in counts; those that are shipped.

Recorded by the ViPlan benchmark (Merler et al. 2025, MIT licence, `LICENSE` beside this file), runs
without chain of thought; made compact by `tools/compact_answers.py`.
"""

import gzip
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from importlib import resources

from tpvqa.errors import AnswerError, UnknownNameError

ENOUGH = 30
"""Answers of one predicate from which it is drawn by itself; for a half, so many in both halves
together and at least half as many in each, so that both halves answer by the same rule."""


@dataclass(frozen=True, slots=True)
class Recording:
    """How often an answer was given; without P(yes) where none was recorded."""

    yes: bool
    p_yes: float | None
    count: int


Key = tuple[str, str, bool]
"""Kind of question ("precondition" or "effect"), predicate ("" for all), truth."""


@dataclass(frozen=True)
class Recordings:
    """What one model answered in one environment.

    Attributes:
        model: Its name.
        environment: Of those that are shipped "blocksworld" or "igibson", never both: the same
            model is right in .965 of the one and in .362 of the other.
        by_kind: Its answers; of a predicate by itself only where there are `ENOUGH`.
    """

    model: str
    environment: str
    by_kind: Mapping[Key, tuple[Recording, ...]]

    def of(self, kind: str, predicate: str, *, truth: bool) -> tuple[Recording, ...]:
        """The answers to a kind of question: of the predicate where there are enough, else of
        all."""
        own = self.by_kind.get((kind, predicate, truth))
        return self.by_kind.get((kind, "", truth), ()) if own is None else own


@cache
def models() -> dict[str, tuple[str, ...]]:
    """The environments of each recorded model."""
    found: dict[str, set[str]] = {}
    for model, environment, *_ in _rows():
        found.setdefault(model, set()).add(environment)
    return {model: tuple(sorted(environments)) for model, environments in sorted(found.items())}


@cache
def recordings(model: str, environment: str, half: int | None = None) -> Recordings:
    """The answers of a model.

    Args:
        model: One of `models()`.
        environment: One of the model's environments.
        half: Only problems of one half, 0 or 1; None for all.

    Raises:
        UnknownNameError: There is no such model or environment.
    """
    known = models()
    if model not in known:
        raise UnknownNameError("recorded model", model, known)
    if environment not in known[model]:
        raise UnknownNameError(f"environment recorded of {model}", environment, known[model])
    rows = (row for row in _rows() if row[:2] == (model, environment))
    return counted(model, environment, rows, half)


def counted(model: str, environment: str, rows: Iterable["Row"], half: int | None) -> Recordings:
    """Recorded answers of one model in one environment, by what was asked and what was true."""
    counts: dict[Key, dict[tuple[bool, float | None], int]] = {}
    sizes: dict[Key, list[int]] = {}
    for _, _, kind, predicate, truth, part, answer, p_yes, n in rows:
        for group in (predicate, ""):
            key = (kind, group, bool(truth))
            sizes.setdefault(key, [0, 0])[part] += n
            if half in (None, part):
                told = counts.setdefault(key, {})
                told[answer == "yes", p_yes] = told.get((answer == "yes", p_yes), 0) + n
    return Recordings(
        model,
        environment,
        {
            key: tuple(Recording(yes, p, told[yes, p]) for yes, p in sorted(told, key=_by_sureness))
            for key, told in counts.items()
            if key[1] == "" or _enough(sizes[key], half)
        },
    )


def half_of(problem: str) -> int:
    """The half of the problems to which one belongs, 0 or 1, the same on every machine."""
    return sha256(problem.encode()).digest()[0] % 2


def _by_sureness(each: tuple[bool, float | None]) -> tuple[bool, float]:
    yes, p_yes = each
    return yes, -1.0 if p_yes is None else p_yes


def _enough(sizes: Sequence[int], half: int | None) -> bool:
    return sum(sizes) >= ENOUGH and (half is None or min(sizes) >= ENOUGH / 2)


Row = tuple[str, str, str, str, int, int, str, float | None, int]
"""Model, environment, kind of question, predicate, truth, half, answer, P(yes), and how often."""


@cache
def _rows() -> tuple[Row, ...]:
    try:
        packed = (resources.files(__package__) / "answers.json.gz").read_bytes()
        return tuple(tuple(row) for row in json.loads(gzip.decompress(packed))["rows"])
    except (OSError, ValueError, KeyError) as error:
        raise AnswerError(
            f"The recorded answers cannot be read ({error}). Install tpvqa again."
        ) from error
