"""One file of recorded answers, safe under several processes that read and write it at once."""

import json
import math
import sqlite3
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from threading import Lock
from typing import Any

from tpvqa.errors import CacheError, PluginError
from tpvqa.questions.question import Question
from tpvqa.vlm.answer import Answer, Reply
from tpvqa.vlm.kept.schema import LONGEST, opened, wrong

ANYBODY = b""
"""The trial of answers that belong to none."""
_LONGEST_TEXT = LONGEST // 4  # characters, of at most four bytes each
_COLUMNS = "a.reply, a.p_yes, a.source, a.text, a.p_cannot_see, a.leftover, a.seconds"
_OF_ONE = (
    f"SELECT {_COLUMNS} FROM answers a JOIN questions q ON q.id = a.question "
    "WHERE a.model = ? AND a.picture = ? AND q.text = ?"
)
_OF_ALL = f"SELECT q.text, {_COLUMNS} FROM answers a JOIN questions q ON q.id = a.question"
_DRAWN = f"{_OF_ONE} AND a.trial = ? AND a.draw = ?"
_NTH = f"{_OF_ONE} ORDER BY a.reply = 'unknown', a.id LIMIT 1 OFFSET ?"


@dataclass(frozen=True, slots=True)
class Asking:
    """What is asked about one look.

    Attributes:
        model: The number of VLM and parameters in the file.
        picture: See `fingerprint.picture_of`.
        trial: The trial that asks; `ANYBODY` for none.
        draw: How many earlier looks of the trial showed the very same and were asked about.
    """

    model: int
    picture: bytes
    trial: bytes = ANYBODY
    draw: int = 0


class AnswerFile:
    """A file of recorded answers. Close it at the end.

    Args:
        path: The file. Its folder has to be there.
        writing: Whether it is to be written; it is made then where it is not there.

    Raises:
        CacheError: It is not there, is no such file, is damaged, or of another version.
        WriteError: It cannot be written.
    """

    def __init__(self, path: Path | str, *, writing: bool):
        self.path = Path(path)
        self._lock = Lock()
        self._connection = opened(self.path, writing=writing)

    def models(self, spec: str | None = None) -> list[tuple[int, str, Mapping[str, str]]]:
        """Numbers, specifications and parameters of the VLMs, or of those of one specification."""
        with self.reading() as connection:
            rows = connection.execute("SELECT id, spec, parameters FROM models ORDER BY id")
            found = [row for row in rows if spec is None or row[1] == spec]
        return [(number, name, self._parameters(text)) for number, name, text in found]

    def _parameters(self, text: str) -> Mapping[str, str]:
        try:
            found = json.loads(text)
        except (ValueError, RecursionError):
            found = None
        if not isinstance(found, dict) or not all(isinstance(v, str) for v in found.values()):
            raise self.damaged("the parameters of a VLM are no names with texts")
        return found

    def model(self, spec: str, parameters: Mapping[str, str]) -> int:
        """The number of a VLM, which it is given where it has none."""
        told = spec, json.dumps(dict(parameters), sort_keys=True)
        with self.writing() as connection:
            connection.execute(
                "INSERT OR IGNORE INTO models (spec, parameters) VALUES (?, ?)", told
            )
            wanted = "SELECT id FROM models WHERE spec = ? AND parameters = ?"
            return int(connection.execute(wanted, told).fetchone()[0])

    def find(
        self, asking: Asking, questions: Sequence[Question], *, unknown: bool
    ) -> dict[str, Answer]:
        """The answers that are there, by the questions' texts.

        That of this trial goes before that of anybody, and that before the answers of all trials
        in the order of recording, of which the one of the draw's number is given.

        Args:
            asking: What is asked.
            questions: Each text once.
            unknown: Whether *unknown* is an answer that may be given.
        """
        with self.reading() as connection:
            found = {each.text: self._find(connection, asking, each, unknown) for each in questions}
        return {text: answer for text, answer in found.items() if answer is not None}

    def _find(
        self, connection: sqlite3.Connection, asking: Asking, question: Question, unknown: bool
    ) -> Answer | None:
        key = asking.model, asking.picture, question.text
        for trial in dict.fromkeys((asking.trial, ANYBODY)):
            row = connection.execute(_DRAWN, (*key, trial, asking.draw)).fetchone()
            if row is not None and (unknown or row[0] != Reply.UNKNOWN):
                return self._answer(question, row)
        row = connection.execute(_NTH, (*key, asking.draw)).fetchone()
        if row is not None and (unknown or row[0] != Reply.UNKNOWN):
            return self._answer(question, row)
        return None

    def check(self, connection: sqlite3.Connection) -> None:
        """See that every answer is one, as they are when they are given.

        Raises:
            CacheError: One is none.
        """
        for text, *row in connection.execute(_OF_ALL):
            self._see_right(text, row)

    def keep(self, asking: Asking, answers: Sequence[Answer]) -> dict[str, Answer]:
        """Add answers where there are none, all or none of them.

        Of two processes that ask the same at once, the first to write is right, and the other
        takes its answer, so that what both were told stands in the file. An *unknown* is kept for
        its own trial only, and asked again by others: a server that was away comes back.

        Returns:
            What stands in the file now, by the questions' texts.
        """
        told: dict[str, Answer] = {}
        with self.writing() as connection:
            for answer in answers:
                known = self._find(connection, asking, answer.question, False)
                if known is None:
                    passing = answer.reply is Reply.UNKNOWN
                    if not passing:
                        self._forget(connection, asking, answer.question.text)
                    self._put(connection, asking, asking.trial if passing else ANYBODY, answer)
                told[answer.question.text] = known or answer
        return told

    def write(self, asking: Asking, answers: Sequence[Answer], *, append: bool = False) -> None:
        """Write answers of this trial, all or none of them.

        Args:
            asking: What was asked.
            answers: The answers.
            append: Whether they come after those that are there, instead of in their place.
        """
        with self.writing() as connection:
            for answer in answers:
                at = self._after(connection, asking, answer) if append else asking
                self._put(connection, at, at.trial, answer)

    @staticmethod
    def _after(connection: sqlite3.Connection, asking: Asking, answer: Answer) -> Asking:
        last = connection.execute(
            "SELECT max(a.draw) FROM answers a JOIN questions q ON q.id = a.question "
            "WHERE a.model = ? AND a.picture = ? AND q.text = ? AND a.trial = ?",
            (asking.model, asking.picture, answer.question.text, asking.trial),
        ).fetchone()[0]
        return replace(asking, draw=0 if last is None else last + 1)

    def _forget(self, connection: sqlite3.Connection, asking: Asking, text: str) -> None:
        """Take back that this trial was not answered."""
        connection.execute(
            "DELETE FROM answers WHERE model = ? AND picture = ? AND trial = ? AND draw = ? "
            "AND question = (SELECT id FROM questions WHERE text = ?)",
            (asking.model, asking.picture, asking.trial, asking.draw, text),
        )

    def _put(
        self, connection: sqlite3.Connection, asking: Asking, trial: bytes, answer: Answer
    ) -> None:
        question = answer.question
        connection.execute(
            "INSERT OR IGNORE INTO questions (text, way, subject) VALUES (?, ?, ?)",
            (question.text, str(question.way), question.subject),
        )
        connection.execute(
            "INSERT INTO answers (model, picture, question, trial, draw, reply, p_yes, source, "
            "text, p_cannot_see, leftover, seconds, at) VALUES "
            "(?, ?, (SELECT id FROM questions WHERE text = ?), ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) "
            "ON CONFLICT (model, picture, question, trial, draw) DO UPDATE SET "
            "reply = excluded.reply, p_yes = excluded.p_yes, source = excluded.source, "
            "text = excluded.text, p_cannot_see = excluded.p_cannot_see, "
            "leftover = excluded.leftover, seconds = excluded.seconds, at = excluded.at",
            (
                asking.model,
                asking.picture,
                question.text,
                trial,
                asking.draw,
                str(answer.reply),
                self._number(answer, "p_yes"),
                _text(answer.source),
                _text(answer.text),
                self._number(answer, "p_cannot_see"),
                self._number(answer, "leftover"),
                max(float(answer.seconds), 0.0),
                int(time.time()),
            ),
        )

    @staticmethod
    def _number(answer: Answer, name: str) -> float | None:
        value = getattr(answer, name)
        if value is None:
            return None
        if not 0 <= value <= 1:
            raise PluginError(f"{name} of an answer is {value!r:.80}; it lies between 0 and 1")
        return float(value)

    def _answer(self, question: Question, row: Sequence[Any]) -> Answer:
        self._see_right(question.text, row)
        reply, p_yes, source, text, p_cannot_see, leftover, seconds = row
        return Answer(question, Reply(reply), p_yes, source, text, p_cannot_see, leftover, seconds)

    def _see_right(self, asked: str, row: Sequence[Any]) -> None:
        """See that a row is an answer; whoever made the file may have put anything there."""
        reply, p_yes, source, text, p_cannot_see, leftover, seconds = row
        shares = (p_yes, p_cannot_see, leftover)
        right = (
            reply in list(Reply)
            and isinstance(source, str)
            and isinstance(text, str)
            and all(each is None or _share(each) for each in shares)
            and isinstance(seconds, float)
            and math.isfinite(seconds)
            and seconds >= 0
        )
        if not right:
            raise self.damaged(f"the answer to {asked[:80]!r} is none")

    def damaged(self, why: str) -> CacheError:
        """The error of a file that holds what was never written into it."""
        return CacheError(f"{self.path}: the file is damaged ({why}). Remove it, or name another")

    @contextmanager
    def reading(self) -> Iterator[sqlite3.Connection]:
        """The connection, for one thread at a time, with its errors in our words."""
        with self._lock:
            try:
                yield self._connection
            except (sqlite3.Error, UnicodeDecodeError) as error:
                raise wrong(self.path, error) from error

    @contextmanager
    def writing(self) -> Iterator[sqlite3.Connection]:
        """The same within a transaction of its own: all that is written in it, or nothing."""
        with self.reading() as connection:
            connection.execute("BEGIN IMMEDIATE")
            try:
                yield connection
                connection.execute("COMMIT")
            except BaseException:
                if connection.in_transaction:
                    connection.execute("ROLLBACK")
                raise

    def close(self) -> None:
        """Close the file. Can be called twice."""
        with self._lock:
            self._connection.close()


def _share(value: object) -> bool:
    return isinstance(value, float) and 0 <= value <= 1


def _text(text: str) -> str:
    return text[:_LONGEST_TEXT].encode(errors="backslashreplace").decode()
