"""The recorded scenes of blocksworld: every fact of a picture, as a VLM answered and as it is."""

import csv
import gzip
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tpvqa.errors import BenchError
from tpvqa_experiments.scenes.arrangements import Places, Shape, arrangements

ENVIRONMENT = "blocksworld"
PREDICATES = ("on", "incolumn", "clear")
STILL = ("leftof", "rightof")
"""Predicates that are the same in every arrangement."""
SCENES, ANSWERS = "scenes.csv.gz", "answers.csv.gz"
REMEDY = "Name a folder with scenes.csv.gz and answers.csv.gz with --data, as its README describes"
Fact = tuple[str, ...]
Said = Mapping[Fact, tuple[str, bool]]
"""Of every fact the answer, and whether it holds."""


@dataclass(frozen=True, slots=True)
class Scene:
    """One picture and what one VLM answered about it.

    Attributes:
        split: The part of the benchmark: simple, medium or hard.
        model: The VLM.
        problem: The problem whose picture it is.
        setting: The runs in which it was asked.
        look: 0 before the first action, then one for each time everything was asked again.
        blocks: The letters of its blocks.
        shape: How many blocks and columns it has.
        answers: 1 yes, 0 no, -1 neither, in the order of `facts`.
        truth: The row of the true arrangement in `arrangements(shape)`.
        as_answered: Whether every answer was right.
    """

    split: str
    model: str
    problem: str
    setting: str
    look: int
    blocks: tuple[str, ...]
    shape: Shape
    answers: NDArray[np.int8]
    truth: int
    as_answered: bool


def facts(shape: Shape) -> list[tuple[str, int, int]]:
    """The facts that differ between arrangements: predicate, block, and block or column (or 0)."""
    blocks, columns = range(shape.blocks), range(shape.columns)
    return [
        *(("on", upper, lower) for upper in blocks for lower in blocks if upper != lower),
        *(("incolumn", block, column) for block in blocks for column in columns),
        *(("clear", block, 0) for block in blocks),
    ]


def read_scenes(folder: Path) -> list[Scene]:
    """The scenes of blocksworld in a folder, in its order.

    Raises:
        BenchError: The folder or a file of it is missing, damaged, or of another kind.
    """
    listed = {
        row["scene"]: row
        for row in _rows(
            folder / SCENES,
            ("scene", "environment", "setting", "split", "model", "problem", "number"),
        )
        if row["environment"] == ENVIRONMENT
    }
    said: dict[str, dict[Fact, tuple[str, bool]]] = {scene: {} for scene in listed}
    path = folder / ANSWERS
    for line, row in enumerate(_rows(path, ("scene", "fact", "answer", "truth")), start=2):
        if row["scene"] not in said:
            continue
        if row["answer"] not in ("yes", "no", "unknown") or row["truth"] not in ("0", "1"):
            raise BenchError(
                f"{path}:{line}: the answer {row['answer']!r} (truth {row['truth']!r}) is none of "
                f"yes, no, unknown (1, 0). {REMEDY}"
            )
        words = row["fact"].replace(",", " ").split()
        if words and words[0] not in STILL:
            said[row["scene"]][tuple(words)] = (row["answer"], row["truth"] == "1")
    if not listed:
        raise BenchError(f"{folder / SCENES} has no scene of {ENVIRONMENT}. {REMEDY}")
    return [_scene(row, said[number], path) for number, row in listed.items()]


def _rows(path: Path, names: Sequence[str]) -> Iterator[dict[str, str]]:
    try:
        with gzip.open(path, "rt", encoding="utf-8", newline="") as file:
            reader = csv.DictReader(file)
            missing = [name for name in names if name not in (reader.fieldnames or ())]
            if missing:
                raise BenchError(f"{path}: there is no column {', '.join(missing)}. {REMEDY}")
            for row in reader:
                if any(row[name] is None for name in names):
                    raise BenchError(f"{path}:{reader.line_num}: the line is cut off. {REMEDY}")
                yield row
    except FileNotFoundError as error:
        raise BenchError(f"{path} is not there. {REMEDY}") from error
    except (OSError, EOFError, UnicodeDecodeError, csv.Error, zlib.error) as error:
        raise BenchError(f"{path} is damaged ({error}): copy it anew. {REMEDY}") from error


def _scene(row: Mapping[str, str], said: Said, path: Path) -> Scene:
    blocks = tuple(sorted({words[1] for words in said if words[0] in PREDICATES}))
    columns = tuple(sorted({words[2] for words in said if words[0] == "incolumn"}))
    shape = Shape(len(blocks), len(columns))
    asked = [
        (name, blocks[first])
        if name == "clear"
        else (name, blocks[first], (blocks if name == "on" else columns)[second])
        for name, first, second in facts(shape)
    ]
    lacking = [words for words in asked if words not in said]
    if lacking or not said:
        told = f"lacks {' '.join(lacking[0])}" if lacking else "has no answers"
        raise BenchError(f"{path}: scene {row['scene']} {told}: copy it anew. {REMEDY}")
    value = {"yes": 1, "no": 0, "unknown": -1}
    truth = _truth(blocks, columns, said)
    if truth < 0:
        raise BenchError(
            f"{path}: what is true in scene {row['scene']} is no arrangement of "
            f"{len(blocks)} blocks in {len(columns)} columns: copy it anew. {REMEDY}"
        )
    try:
        look = int(row["number"])
    except ValueError as error:
        raise BenchError(
            f"{path.parent / SCENES}: the number {row['number']!r} of scene {row['scene']} is "
            f"none. {REMEDY}"
        ) from error
    return Scene(
        split=row["split"],
        model=row["model"],
        problem=row["problem"],
        setting=row["setting"],
        look=look,
        blocks=blocks,
        shape=shape,
        answers=np.array([value[said[words][0]] for words in asked], np.int8),
        truth=truth,
        as_answered=all(answer == ("yes" if holds else "no") for answer, holds in said.values()),
    )


def _truth(blocks: Sequence[str], columns: Sequence[str], said: Said) -> int:
    """The row of the true arrangement; -1 where what is true is none."""
    holds = {words for words, (_, true) in said.items() if true}
    below = {words[1]: words[2] for words in holds if words[0] == "on"}
    column = {words[1]: columns.index(words[2]) for words in holds if words[0] == "incolumn"}
    if set(column) != set(blocks):
        return -1
    height = {}
    for block in blocks:
        under: list[str] = []
        while (next_block := below.get(under[-1] if under else block)) is not None:
            if len(under) == len(blocks):
                return -1
            under.append(next_block)
        height[block] = len(under)

    def places(of: Mapping[str, int]) -> Places:
        return np.array([of[block] for block in blocks], np.int8)

    return arrangements(Shape(len(blocks), len(columns))).place(places(column), places(height))
