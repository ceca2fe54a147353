"""The episode on disk: `episode.jsonl`, one event a line, and the pictures in `frames/`."""

import errno
import fcntl
import os
from contextlib import suppress
from pathlib import Path
from time import monotonic
from typing import Self

from pydantic_core import PydanticSerializationError

from tpvqa.episodes.log import LOG, events_in, no_episode, whole_lines
from tpvqa.episodes.own_files import BENCH
from tpvqa.episodes.shape import FRAMES, is_frame
from tpvqa.errors import EpisodeError, PluginError, WriteError, pasted
from tpvqa.events import EVENT, Ended, Event
from tpvqa.events.events import CAN_BE_GONE_ON_WITH
from tpvqa.events.records import depth_file
from tpvqa.files import clear_parts, make_folder, open_plain, write_all, write_whole_at
from tpvqa.observation import Frame
from tpvqa.pictures import MOST_BYTES
from tpvqa.told.strict_json import LONGEST

_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
_TORN = b'{"number":0,'
"""How the first event of a log begins."""
_NONE_THERE = (errno.ENOENT, errno.ENOTDIR, errno.ELOOP, errno.ENXIO, errno.EINVAL)
_NO_ENDS = tuple(f'"because":"{each}"'.encode() for each in CAN_BE_GONE_ON_WITH)


class EpisodeWriter:
    """Appends events, each on disk before `append` returns.

    Where an event cannot be written, the log stays as it was: whole, to be gone on with. Where the
    first cannot, nothing stays.

    Args:
        folder: The episode's folder. It is made; it must not hold an episode already, unless
            `resume` is given. A log that was torn within its first event is begun anew.
        resume: Number of whole events that the folder's log holds; what follows them (a line
            torn by a kill) is cut off.
        time: Seconds that the episode had taken by then.
        durable: Whether to wait for the disk. Off only for experiments of many episodes.

    Attributes:
        begun_anew: Whether the folder held the torn beginning of an episode.

    Raises:
        EpisodeError: The folder holds another episode or a bench, or another process writes it.
        WriteError: The folder cannot be written.
    """

    resumable = True

    def __init__(self, folder: Path, *, resume: int = 0, time: float = 0.0, durable: bool = True):
        self._open(folder, durable=durable)
        try:
            kept = self._kept(resume) if resume else self._nothing_there()
        except BaseException:
            self.close()
            raise
        self._go_on_from(resume, kept, time)

    @classmethod
    def going_on(cls, folder: Path | str) -> tuple[Self, list[Event]]:
        """Go on with an unfinished episode: nobody else writes it from before it is read.

        The log is left as it is until something is appended; then what is torn at its end, or an
        end by Ctrl-C, is cut off.

        Args:
            folder: The episode's.

        Returns:
            The writer, and the events that there are, without an end by Ctrl-C.

        Raises:
            EpisodeError: There is no episode, it is damaged or has ended, or another process
                writes it.
            WriteError: It cannot be written.
        """
        writer = cls.__new__(cls)
        writer._open(folder, new=False)
        try:
            events = events_in(writer.folder / LOG, writer._file)
            last = events[-1]
            if isinstance(last, Ended):
                if last.because not in CAN_BE_GONE_ON_WITH:
                    raise EpisodeError(
                        f"{folder}: the episode has ended ({last.ending}); show it instead"
                    )
                events.pop()
            lines = whole_lines(writer._file)
            kept = sum(len(line) + 1 for line, _ in zip(lines, events, strict=False))
        except BaseException:
            writer.close()
            raise
        writer._go_on_from(len(events), kept, events[-1].time)
        return writer, events

    def _open(self, folder: Path | str, *, new: bool = True, durable: bool = True) -> None:
        """Open the log and let no other writer at it: the lock ends with this process."""
        self.folder, self._durable, self.begun_anew = Path(folder), durable, False
        self._file = self._frames = -1
        self._begun, self._made = not new, [self.folder / FRAMES]
        flags = os.O_RDWR | os.O_APPEND | (os.O_CREAT if new else 0)
        if new:
            self._see_no_bench()
            self._make_folder()
        try:
            self._file = open_plain(self.folder / LOG, flags)
            with suppress(FileExistsError):
                (self.folder / FRAMES).mkdir()
            self._frames = self._opened_frames()
        except OSError as error:
            if new:
                self._leave_nothing()
            self.close()
            linked = self.folder.is_dir() and error.errno == errno.ENOTDIR  # frames/ is a link
            if new or linked or error.errno not in _NONE_THERE:
                raise self._unwritten(error) from error
            raise no_episode(self.folder, error) from error
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            self.close()
            if not isinstance(error, BlockingIOError):
                raise self._unwritten(error) from error
            raise EpisodeError(
                f"{self.folder} is still being written by another process, or by a writer that was "
                "not closed; wait for it or end it"
            ) from None

    def _see_no_bench(self) -> None:
        if (self.folder / LOG).exists() or not any((self.folder / name).exists() for name in BENCH):
            return
        raise EpisodeError(f"{self.folder} holds a bench; name another folder with --out")

    def _make_folder(self) -> None:
        missing = [each for each in (self.folder, *self.folder.parents) if not each.exists()]
        self._made += missing
        try:
            make_folder(self.folder)
        except OSError as error:
            remedy = "Nothing was begun: name another folder with --out"
            raise WriteError.of(self.folder, error, remedy) from error

    def _leave_nothing(self) -> None:
        """Take away the empty log, and what folders were made for it."""
        if self._file >= 0:
            with suppress(OSError):
                fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)  # it may be another's
                if not os.fstat(self._file).st_size:
                    (self.folder / LOG).unlink()
        for each in self._made:
            with suppress(OSError):
                each.rmdir()

    def _opened_frames(self) -> int:
        try:
            return os.open(self.folder / FRAMES, _FOLDER)
        except NotADirectoryError:
            said = f"its folder {FRAMES}/ is a link, or no folder"
            raise NotADirectoryError(errno.ENOTDIR, said) from None

    def _go_on_from(self, count: int, size: int, time: float) -> None:
        self._count, self._size, self._began = count, size, monotonic() - time
        self._cut, self._begun = False, self._begun or count > 0

    def _nothing_there(self) -> int:
        """See that the log is empty, or torn before anything was in it."""
        size = os.fstat(self._file).st_size
        if not size:
            return 0
        start = os.pread(self._file, len(_TORN), 0)
        if not any(True for _ in whole_lines(self._file)) and _TORN.startswith(start[: len(_TORN)]):
            self.begun_anew = True
            return 0
        raise EpisodeError(
            f"{self.folder} holds an episode already; name another folder with --out, or, where it "
            f"has not ended, go on with it: tpvqa resume {pasted(self.folder)}"
        )

    def _kept(self, count: int) -> int:
        """The bytes of so many events. Nothing is cut off but an end by Ctrl-C and a torn line;
        what else follows was written since."""
        lines = list(whole_lines(self._file))
        more = lines[count:]
        if more and not (len(more) == 1 and any(end in more[0] for end in _NO_ENDS)):
            raise EpisodeError(
                f"{self.folder} was written to by another process since it was read; try again"
            )
        return sum(len(line) + 1 for line in lines[:count])

    def append(self, event: Event) -> Event:
        """Write an event; it is given its number and its time since the beginning.

        Raises:
            WriteError: It cannot be written.
            PluginError: It holds what cannot be kept.
        """
        event.stamp(self._count, monotonic() - self._began)
        try:
            line = EVENT.dump_json(event, exclude_none=True, by_alias=True) + b"\n"
        except PydanticSerializationError as error:
            raise PluginError(
                f"the event {event.kind!r} cannot be written: a plug-in gave what is no text or no "
                f"value of JSON ({error})"
            ) from error
        if len(line) > LONGEST:
            raise PluginError(
                f"the event {event.kind!r} cannot be written: a plug-in gave {len(line):,} bytes, "
                f"and an event has {LONGEST:,} at most"
            )
        try:
            if not self._cut:
                os.ftruncate(self._file, self._size)
                clear_parts(self._frames)
                self._cut = True
            write_all(self._file, line)
            if self._durable:
                os.fsync(self._file)
            self._size, self._count, self._begun = self._size + len(line), self._count + 1, True
        except BaseException as error:  # Ctrl-C, too: what is in the log has been counted
            with suppress(OSError):
                os.ftruncate(self._file, self._size)
            if isinstance(error, OSError):
                if not self._begun:
                    self._leave_nothing()
                raise self._unwritten(error) from error
            raise
        return event

    def save_frame(self, frame: Frame) -> str:
        """Save a camera image, and its depth image; its path within the episode's folder.

        Raises:
            ValueError: The picture's name leads out of the folder.
            WriteError: It cannot be written.
        """
        name = f"{FRAMES}/{frame.id}{frame.suffix}"
        self._save(name, frame.data)
        if frame.depth is not None:
            self._save(depth_file(name, frame.depth), frame.depth.data)
        return name

    def _save(self, name: str, data: bytes) -> None:
        if not is_frame(name):
            raise ValueError(f"the view of a picture names a file: {name!r} is none")
        if not isinstance(data, bytes):
            raise TypeError(f"a picture is bytes, not {type(data).__name__}")
        if len(data) > MOST_BYTES:
            raise ValueError(
                f"{name} has {len(data):,} bytes; a picture has {MOST_BYTES:,} at most"
            )
        try:
            write_whole_at(self._frames, name.partition("/")[2], data, durable=self._durable)
        except OSError as error:
            raise WriteError.of(self.folder / name, error, self._remedy) from error

    @property
    def _remedy(self) -> str:
        if not self._begun:
            return "Nothing was begun: make room, or name another folder with --out"
        return (
            "What was written is whole: make room, and go on with it: tpvqa resume "
            f"{pasted(self.folder)}"
        )

    def _unwritten(self, error: OSError) -> WriteError:
        return WriteError.of(self.folder / LOG, error, self._remedy)

    def close(self) -> None:
        """Close the log. Can be called twice."""
        for descriptor in (self._file, self._frames):
            if descriptor >= 0:
                os.close(descriptor)
        self._file = self._frames = -1


class MemoryWriter:
    """Keeps the events in memory: for experiments of many episodes, and for tests.

    Args:
        resumable: Whether the events hold the states of world and VLM.
        keep: Whether to keep them at all; listeners are told of them anyway.
    """

    def __init__(self, *, resumable: bool = True, keep: bool = True) -> None:
        self.resumable, self._keep = resumable, keep
        self.events: list[Event] = []
        self._began, self._count = monotonic(), 0

    def append(self, event: Event) -> Event:
        """Keep an event."""
        event.stamp(self._count, monotonic() - self._began)
        self._count += 1
        if self._keep:
            self.events.append(event)
        return event

    def save_frame(self, frame: Frame) -> str:
        """Keep nothing of the picture but its name."""
        return f"{FRAMES}/{frame.id}{frame.suffix}"

    def close(self) -> None:
        """Nothing to close."""
