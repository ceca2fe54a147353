"""Whole scenes of blocksworld as real VLMs saw them.

Recorded by the ViPlan benchmark (Merler et al. 2025, MIT licence, `LICENSE` beside this file), runs
without chain of thought; made compact by `experiments/tools/viplan_scenes.py`.
"""

import gzip
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import resources

from tpvqa.errors import AnswerError, UnknownNameError

Arrangement = tuple[str, ...]
"""The blocks of every column, a letter each, from below."""
Fact = tuple[str, ...]
"""A predicate and its arguments."""


def facts_of(columns: Arrangement) -> Iterator[Fact]:
    """The facts of a scene, in the order in which its wrong answers are noted."""
    blocks = "".join(columns)
    yield from (("on", above, below) for above in blocks for below in blocks)
    yield from (("clear", block) for block in blocks)
    for block in blocks:
        yield from (("incolumn", block, f"c{number + 1}") for number in range(len(columns)))


def true_facts(columns: Arrangement) -> frozenset[Fact]:
    """The facts that hold in an arrangement."""
    return frozenset(
        fact
        for number, blocks in enumerate(columns)
        for height, block in enumerate(blocks)
        for fact in (
            ("incolumn", block, f"c{number + 1}"),
            ("on", block, blocks[height - 1]) if height else ("clear", blocks[-1]),
        )
    ) | {("clear", blocks[-1]) for blocks in columns if blocks}


@dataclass(frozen=True)
class Scene:
    """One picture, and what a model answered about it.

    Attributes:
        problem: The problem in which it came up.
        columns: How the blocks stood.
        initial: Whether it is the problem's first; others were looked at again as something was
            not as expected.
        wrong: The facts about which the answer was wrong, a bit each, as `facts_of` gives them.
    """

    problem: str
    columns: Arrangement
    initial: bool
    wrong: str

    @property
    def heights(self) -> tuple[int, ...]:
        """The number of blocks in every column."""
        return tuple(map(len, self.columns))

    @cached_property
    def answers(self) -> dict[Fact, bool]:
        """Which facts were affirmed."""
        facts, true = list(facts_of(self.columns)), true_facts(self.columns)
        bits = f"{int(self.wrong, 16):0{len(facts)}b}"
        return {fact: (fact in true) != (bit == "1") for fact, bit in zip(facts, bits, strict=True)}


@cache
def scenes(model: str) -> tuple[Scene, ...]:
    """The scenes that a model was asked about.

    Raises:
        UnknownNameError: There is no such model.
        AnswerError: The recorded scenes cannot be read.
    """
    known = models()
    if model not in known:
        raise UnknownNameError("model with recorded scenes", model, known)
    return tuple(
        Scene(problem, tuple(columns.split(",")), initial, wrong)
        for name, problem, columns, initial, wrong in _rows()
        if name == model
    )


@cache
def models() -> tuple[str, ...]:
    """The models of which scenes were recorded."""
    return tuple(sorted({row[0] for row in _rows()}))


@cache
def _rows() -> Sequence[tuple[str, str, str, bool, str]]:
    try:
        packed = (resources.files(__package__) / "scenes.json.gz").read_bytes()
        return [tuple(row) for row in json.loads(gzip.decompress(packed))["rows"]]
    except (OSError, ValueError, KeyError) as error:
        raise AnswerError(
            f"The recorded scenes cannot be read ({error}). Install the checkout again."
        ) from error
