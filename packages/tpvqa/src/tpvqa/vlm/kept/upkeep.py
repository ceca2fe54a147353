"""What a file of recorded answers holds, and taking from it."""

import json
import math
import sqlite3
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from tpvqa.errors import CacheError
from tpvqa.vlm.kept.file import AnswerFile
from tpvqa.vlm.kept.schema import SCHEMA

COLUMNS = (
    "vlm",
    "parameters",
    "picture",
    "question",
    "way",
    "about",
    "trial",
    "draw",
    "reply",
    "p_yes",
    "p_cannot_see",
    "leftover",
    "source",
    "text",
    "seconds",
    "at",
)
"""What is known of an answer, in the order of an export."""
_LAST = 253_402_300_799  # the end of the year 9999, in seconds since 1970
_STEP = 0.05
"""Share of the answers that is taken at once, until the rest is small enough."""


@dataclass(frozen=True, slots=True)
class Kept:
    """Answers of one VLM, or of one kind of question.

    Attributes:
        name: The VLM, or the predicate or action that is asked about.
        number: Of VLM and parameters in the file; None of a kind of question.
        parameters: What its answers depend on.
        answers: How many there are.
        asked: Questions about pictures that they answer: fewer, where there are several draws.
        pictures: How many.
        yes: Share of yes among yes and no; None where there are none.
        abstained: Share of *unknown* and *cannot see*.
        seconds: That they took when they were asked, in all.
        first: When the first was recorded, in seconds since 1970.
        last: When the last was.
    """

    name: str
    number: int | None
    parameters: str
    answers: int
    asked: int
    pictures: int
    yes: float | None
    abstained: float
    seconds: float
    first: int
    last: int


@dataclass(frozen=True, slots=True)
class Stats:
    """What a file holds.

    Attributes:
        file: The file.
        schema: The number of its format.
        bytes: Its size.
        answers: How many it holds.
        vlms: By VLM and parameters.
        kinds: By what is asked about.
    """

    file: str
    schema: int
    bytes: int
    answers: int
    vlms: tuple[Kept, ...]
    kinds: tuple[Kept, ...]


_FIGURES = (
    "count(*), count(DISTINCT a.picture || char(0) || a.question), count(DISTINCT a.picture), "
    "sum(a.reply = 'yes'), sum(a.reply = 'no'), sum(a.seconds), min(a.at), max(a.at)"
)
_OF_MODELS = (
    f"SELECT m.spec, m.id, m.parameters, {_FIGURES} FROM answers a "
    "JOIN models m ON m.id = a.model GROUP BY m.id ORDER BY m.id"
)
_OF_KINDS = (
    f"SELECT q.subject, NULL, '', {_FIGURES} FROM answers a "
    "JOIN questions q ON q.id = a.question GROUP BY q.subject ORDER BY count(*) DESC, q.subject"
)


def stats(path: Path) -> Stats:
    """Count what a file holds.

    Raises:
        CacheError: It cannot be read, or holds what is no answer.
    """
    file = AnswerFile(path, writing=False)
    try:
        file.models()  # which sees to their parameters: whoever shows them reads them again
        with file.reading() as connection:
            file.check(connection)
            told = Stats(
                file=str(path),
                schema=SCHEMA,
                bytes=_size(path),
                answers=connection.execute("SELECT count(*) FROM answers").fetchone()[0],
                vlms=tuple(map(_kept, connection.execute(_OF_MODELS))),
                kinds=tuple(map(_kept, connection.execute(_OF_KINDS))),
            )
        if not all(_a_time(each.first) and _a_time(each.last) for each in told.vlms):
            raise file.damaged("an answer was recorded at no time that there is")
        if not all(math.isfinite(each.seconds) for each in told.vlms):
            raise file.damaged("the answers took longer than can be counted")
        return told
    finally:
        file.close()


def _a_time(at: object) -> bool:
    return isinstance(at, int) and 0 <= at <= _LAST


def _kept(row: tuple[Any, ...]) -> Kept:
    name, number, parameters, answers, asked, pictures, yes, no, seconds, first, last = row
    return Kept(
        name=name,
        number=number,
        parameters=parameters,
        answers=answers,
        asked=asked,
        pictures=pictures,
        yes=yes / (yes + no) if yes + no else None,
        abstained=1 - (yes + no) / answers,
        seconds=seconds,
        first=first,
        last=last,
    )


def _size(path: Path) -> int:
    return path.stat().st_size


def exported(path: Path) -> Iterator[dict[str, Any]]:
    """Every answer as plain values, in the order of recording, see `COLUMNS`.

    Raises:
        CacheError: The file cannot be read, or holds what is no answer.
    """
    file = AnswerFile(path, writing=False)
    told = (
        "SELECT m.spec, m.parameters, hex(a.picture), q.text, q.way, q.subject, hex(a.trial), "
        "a.draw, a.reply, a.p_yes, a.p_cannot_see, a.leftover, a.source, a.text, a.seconds, a.at "
        "FROM answers a JOIN models m ON m.id = a.model JOIN questions q ON q.id = a.question "
        "ORDER BY a.id"
    )
    try:
        file.models()
        with file.reading() as connection:
            file.check(connection)  # first of all: what was given cannot be taken back
            for row in connection.execute(told):
                entry = dict(zip(COLUMNS, row, strict=True))
                entry["picture"], entry["trial"] = row[2].lower(), row[6].lower()
                yield entry
    finally:
        file.close()


@dataclass(frozen=True, slots=True)
class Pruned:
    """What was taken away.

    Attributes:
        answers: How many answers.
        left: How many are left.
        before: Bytes of the file before.
        after: Bytes of the file now.
    """

    answers: int
    left: int
    before: int
    after: int


def prune(
    path: Path,
    *,
    vlm: str | None = None,
    older_than: float | None = None,
    most: int | None = None,
    dry: bool = False,
) -> Pruned:
    """Take answers away: those that fit all that is said; then the oldest, until few are left.

    Args:
        path: The file.
        vlm: A VLM's specification, or its number in the file.
        older_than: Seconds.
        most: Bytes of the file that are left at most.
        dry: Whether only to count; what `most` would take is not known then.

    Raises:
        CacheError: The file cannot be used, has no such VLM, or `most` is less than an empty file.
    """
    if not path.exists():  # which writing would make
        raise CacheError(f"{path}: there is no such file")
    least = 0 if most is None else _least()
    if most is not None and most < least:
        raise CacheError(
            f"{path}: a file without any answer has {least:,} bytes, and {most:,} are allowed. "
            "Allow more, or take the file away"
        )
    file = AnswerFile(path, writing=not dry)
    try:
        before = _size(path)
        models = [number for number, name, _ in file.models() if vlm in (None, name, str(number))]
        if vlm is not None and not models:
            known = ", ".join(f"{number}: {name}" for number, name, _ in file.models())
            raise CacheError(f"{path}: there are no answers of {vlm!r}, but of {known or 'nobody'}")
        with file.reading() if dry else file.writing() as connection:
            taken = 0
            if vlm is not None or older_than is not None:
                taken = _take(connection, models, older_than, dry=dry)
            left = connection.execute("SELECT count(*) FROM answers").fetchone()[0]
        left -= taken if dry else 0
        if not dry:
            with file.reading() as connection:
                _shrink(connection)
                while most is not None and left and _size(path) > most:
                    taken += _take_oldest(connection, max(int(left * _STEP), 1))
                    left = connection.execute("SELECT count(*) FROM answers").fetchone()[0]
                    _shrink(connection)
        return Pruned(taken, left, before, _size(path))
    finally:
        file.close()


def _least() -> int:
    """The size of a file that holds no answer."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "empty"
        AnswerFile(path, writing=True).close()
        return _size(path)


def _take(
    connection: sqlite3.Connection, models: list[int], older_than: float | None, *, dry: bool
) -> int:
    chosen = (
        "FROM answers WHERE model IN (SELECT value FROM json_each(?)) AND (? IS NULL OR at < ?)"
    )
    end = None if older_than is None else time.time() - older_than
    given = json.dumps(models), end, end
    if dry:
        return int(connection.execute(f"SELECT count(*) {chosen}", given).fetchone()[0])
    return connection.execute(f"DELETE {chosen}", given).rowcount


def _take_oldest(connection: sqlite3.Connection, count: int) -> int:
    oldest = "SELECT id FROM answers ORDER BY at, id LIMIT ?"
    return connection.execute(f"DELETE FROM answers WHERE id IN ({oldest})", (count,)).rowcount


def _shrink(connection: sqlite3.Connection) -> None:
    """Let go of what no answer needs, and give the room back."""
    connection.execute("DELETE FROM questions WHERE id NOT IN (SELECT question FROM answers)")
    connection.execute("DELETE FROM models WHERE id NOT IN (SELECT model FROM answers)")
    connection.execute("VACUUM")
    connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
