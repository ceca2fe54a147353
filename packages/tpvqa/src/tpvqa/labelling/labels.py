"""The labels of an episode, `labels.jsonl` beside its log: appended to, never changed."""

import fcntl
import os
from codecs import BOM_UTF8
from collections.abc import Iterable, Mapping
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal

from pydantic import ConfigDict, Field, ValidationError

from tpvqa.episodes.log import whole_lines
from tpvqa.episodes.own_files import LABELS
from tpvqa.errors import CalibrationError, WriteError
from tpvqa.files import open_plain, opened_plain, write_all
from tpvqa.labelling.recorded import Asking, RecordedEpisode
from tpvqa.told import ToldModel, check_json, first_fault
from tpvqa.told.strict_json import LONGEST

SCHEMA: Literal[2] = 2
Said = Literal["yes", "no", "cannot see"]


class Label(ToldModel):
    """One line of the file: what a person says is the right answer.

    Attributes:
        schema_number: Of the file's format; for 1 no time passed between two actions.
        log: Tells the log that it is of from others (`RecordedEpisode.log`).
        stretch: When it was asked (`Asking.stretch`).
        text: The question.
        label: The right answer; "cannot see" where the pictures do not tell.
        at: When it was given, in UTC.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)

    schema_number: Literal[1, 2] = Field(
        default=SCHEMA, validation_alias="schema", serialization_alias="schema"
    )
    log: str
    stretch: int = Field(ge=0)
    text: str
    label: Said
    at: str = ""


def read_labels(episode: RecordedEpisode) -> dict[tuple[int, str], Said]:
    """The labels beside an episode's log: of several for the same question the last one.

    A line that was torn by a kill is left out, and so are blank ones.

    Raises:
        CalibrationError: The file is damaged, of another version, or of another episode, or a
            label is of a time after its end.
    """
    path = episode.folder / LABELS
    try:
        with opened_plain(path) as descriptor:
            lines = list(whole_lines(descriptor))
            lines.append(_last(descriptor, _size(lines)))
    except FileNotFoundError:
        return {}
    except OSError as error:
        raise CalibrationError(f"{path}: cannot be read ({error.strerror})") from error
    found: dict[tuple[int, str], Said] = {}
    for number, line in enumerate(lines, 1):
        if number == 1:
            line = line.removeprefix(BOM_UTF8)  # as editors put it there
        if not line.strip():
            continue
        label = _label(path, number, line)
        if label.log != episode.log:
            raise CalibrationError(
                f"{path}:{number}: labels of another episode. Put them beside the log that they "
                f"are of, or remove them and label {episode.folder} anew"
            )
        if label.schema_number == 1 and episode.timed:
            raise CalibrationError(
                f"{path}:{number}: a label of a version that did not count the time that passes "
                f"while actions last. Remove {path}, and label {episode.folder} anew"
            )
        if label.stretch > len(episode.actions):
            raise CalibrationError(
                f"{path}:{number}: a label of stretch {label.stretch}, and the episode's last is "
                f"{len(episode.actions)}. Put the labels beside the log that they are of, or "
                "remove the line"
            )
        found[label.stretch, label.text] = label.label
    return found


def _size(lines: Iterable[bytes]) -> int:
    """How many bytes whole lines take up."""
    return sum(len(line) + 1 for line in lines)


def _last(descriptor: int, whole: int) -> bytes:
    """What stands behind the whole lines, where it is JSON: an editor put no end to it."""
    last = os.pread(descriptor, LONGEST, whole)
    try:
        check_json(last if whole else last.removeprefix(BOM_UTF8))
    except ValueError:
        return b""
    return last


def _label(path: Path, number: int, line: bytes) -> Label:
    try:
        check_json(line)
        return Label.model_validate_json(line, strict=True)
    except ValidationError as error:
        first = first_fault(error)
        where = ".".join(map(str, first["loc"]))[:200]
        said = f"{where}: {first['msg'][:300]}"
    except ValueError as error:
        said = str(error)
    raise CalibrationError(
        f"{path}:{number}: no label of this version ({said}). Remove the line, or the file"
    ) from None


class Labels:
    """Appends labels to an episode's file, each on disk before `append` returns.

    Args:
        episode: Whose.

    Attributes:
        known: The labels so far, by stretch and question.
        meanwhile: Those of them that another session gave between the reading of the file and the
            first label here.

    Raises:
        CalibrationError: The file is damaged, or another process labels this episode.
        WriteError: The file cannot be written.
    """

    def __init__(self, episode: RecordedEpisode):
        self.known: dict[tuple[int, str], Said] = read_labels(episode)
        self.meanwhile: dict[tuple[int, str], Said] = {}
        self._episode, self._path = episode, episode.folder / LABELS
        self._file = -1

    def append(self, asking: Asking, said: Said) -> bool:
        """Keep a label, unless somebody else has just labelled the question, unseen here.

        Returns:
            Whether it is kept.

        Raises:
            WriteError: It cannot be written; those before it are kept.
            CalibrationError: Another process labels this episode, or has damaged the file.
        """
        if self._file < 0:
            self._open()
            if asking.key in self.meanwhile:
                return False
        label = Label(
            log=self._episode.log,
            stretch=asking.stretch,
            text=asking.text,
            label=said,
            at=datetime.now(UTC).isoformat(timespec="seconds"),
        )
        line = label.model_dump_json(by_alias=True).encode() + b"\n"
        size, before = os.fstat(self._file).st_size, dict(self.known)
        try:
            write_all(self._file, line)
            self.known[asking.key] = said  # by now Ctrl-C takes nothing back
            os.fsync(self._file)
        except OSError as error:
            self.known = before
            with suppress(OSError):
                os.ftruncate(self._file, size)
            raise self._unwritten(error) from error
        return True

    def _open(self) -> None:
        """Open the file when there is something to write: to look at questions leaves no trace."""
        try:
            self._file = open_plain(self._path, os.O_RDWR | os.O_APPEND | os.O_CREAT)
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            self._read_again()
            whole = _size(whole_lines(self._file))
            if _last(self._file, whole):
                write_all(self._file, b"\n")
            else:
                os.ftruncate(self._file, whole)  # what a kill tore
        except BlockingIOError:
            self.close()
            raise CalibrationError(
                f"{self._path} is being written by another process; wait for it or end it"
            ) from None
        except CalibrationError:
            self.close()
            raise
        except OSError as error:
            self.close()
            raise self._unwritten(error) from error

    def _read_again(self) -> None:
        """What others wrote before the lock was taken is not overruled by who has not seen it."""
        before, self.known = self.known, read_labels(self._episode)
        self.meanwhile = dict(self.known.items() - before.items())

    def _unwritten(self, error: OSError) -> WriteError:
        return WriteError.of(self._path, error, "The labels before are kept: make room, and go on")

    def close(self) -> None:
        """Close the file. Can be called twice."""
        if self._file >= 0:
            os.close(self._file)
        self._file = -1


Known = Mapping[tuple[int, str], Said]
"""Labels by stretch and question."""
