"""Files where others may have put something before: no link is followed, nothing is half-written.

A folder that the user names is followed where it is a link; what lies in it is not.
"""

import errno
import os
import re
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from tpvqa.errors import WriteError

_PLAIN = "it is a link, a pipe or a device, where a plain file is expected"
_PART = re.compile(r"\.[0-9a-f]{16}\.part")
_FOLDER = "it is a folder, where a plain file is expected"


def open_plain(path: Path | str, flags: int, *, follow: bool = False) -> int:
    """Open a plain file, without waiting for anything.

    Args:
        path: The file.
        flags: Of `os.open`.
        follow: Whether it may be a link: where the user names it.

    Returns:
        The descriptor, for the caller to close.

    Raises:
        OSError: It cannot be opened, or is no plain file.
    """
    try:  # without waiting: to open a pipe would wait for somebody at its other end
        flags |= os.O_NONBLOCK | os.O_CLOEXEC | os.O_NOCTTY | (0 if follow else os.O_NOFOLLOW)
        found = os.open(path, flags, 0o666)
    except OSError as error:
        if error.errno in (errno.ELOOP, errno.ENXIO):
            raise OSError(error.errno, _PLAIN) from None
        raise
    kind = os.fstat(found).st_mode
    if not stat.S_ISREG(kind):
        os.close(found)
        raise OSError(errno.EINVAL, _FOLDER if stat.S_ISDIR(kind) else _PLAIN)
    return found


def resolved(path: Path | str) -> Path:
    """Where a path leads, links followed as far as they lead anywhere."""
    return Path(os.path.realpath(path))  # `Path.resolve` breaks on links in a circle


@contextmanager
def opened_plain(path: Path | str) -> Iterator[int]:
    """A plain file, open for reading: its descriptor.

    Raises:
        OSError: As for `open_plain`.
    """
    descriptor = open_plain(path, os.O_RDONLY)
    try:
        yield descriptor
    finally:
        os.close(descriptor)


def read_plain(path: Path | str, *, most: int = 64 * 2**20, follow: bool = True) -> bytes:
    """What a plain file holds.

    Args:
        path: The file.
        most: So many bytes are read at most.
        follow: Whether it may be a link: where the user names it.

    Raises:
        OSError: It cannot be read, is no plain file, or has more bytes than `most`.
    """
    with os.fdopen(open_plain(path, os.O_RDONLY, follow=follow), "rb") as file:
        data = file.read(most + 1)
    if len(data) > most:
        raise OSError(errno.EFBIG, f"it has more than {most:,} bytes")
    return data


def make_folder(path: Path, *, follow: bool = True) -> None:
    """Make a folder with those above it, where it is not there.

    Args:
        path: The folder.
        follow: Whether it may be a link: where the user names it, and not one above it.

    Raises:
        OSError: It cannot be made, or a file lies in the place of one of them.
    """
    if not follow and path.is_symlink():
        raise NotADirectoryError(errno.ENOTDIR, f"{path} is a link, where a folder is expected")
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError):
        there = next(each for each in (path, *path.parents) if os.path.lexists(each))
        said = f"{there} is no folder"
        raise NotADirectoryError(errno.ENOTDIR, said) from None


def write_whole(path: Path | str, data: bytes, *, remedy: str, durable: bool = False) -> None:
    """Write a file that is either the old one or the whole new one.

    It is written beside its place under a name that nobody can know before, and moved there. A
    link that lies in its place is replaced, not followed.

    Args:
        path: The file. Its folder has to be there.
        data: What to write.
        remedy: What the user can do where it cannot be written; a sentence without its full stop.
        durable: Whether to wait until it is on disk.

    Raises:
        WriteError: It cannot be written; nothing is left behind.
    """
    path = Path(path)
    try:
        folder = os.open(path.parent, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            write_whole_at(folder, path.name, data, durable=durable)
        finally:
            os.close(folder)
    except OSError as error:
        raise WriteError.of(path, error, remedy) from error


def see_writable(path: Path, *, remedy: str) -> None:
    """See that `write_whole` can write a file, folders above it included; nothing is left behind.

    Permissions alone do not tell: of a read-only disk, or of /proc, they say that it can.

    Args:
        path: The file.
        remedy: What the user can do where it cannot be written; a sentence without its full stop.

    Raises:
        WriteError: It cannot.
    """
    above = next((each for each in path.parents if os.path.lexists(each)), path)
    try:
        if not above.is_dir():
            raise NotADirectoryError(errno.ENOTDIR, f"{above} is no folder")
        with suppress(FileNotFoundError):
            _see_replaceable(path.lstat().st_mode)
        beside = above / f".{secrets.token_hex(8)}.part"
        os.close(os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666))
        beside.unlink()
    except OSError as error:
        raise WriteError.of(path, error, remedy) from error


def _see_replaceable(mode: int) -> None:
    if not stat.S_ISREG(mode) and not stat.S_ISLNK(mode):
        raise OSError(errno.EINVAL, "there is a folder, a pipe or a device in its place")


def write_whole_at(folder: int, name: str, data: bytes, *, durable: bool = False) -> None:
    """As `write_whole`, in a folder that is open already.

    Raises:
        OSError: It cannot be written; nothing is left behind.
    """
    with suppress(FileNotFoundError):
        _see_replaceable(os.stat(name, dir_fd=folder, follow_symlinks=False).st_mode)
    beside = f".{secrets.token_hex(8)}.part"
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
    descriptor = os.open(beside, flags, 0o666, dir_fd=folder)
    try:
        try:
            write_all(descriptor, data)
            if durable:
                os.fsync(descriptor)
        finally:
            os.close(descriptor)
        os.replace(beside, name, src_dir_fd=folder, dst_dir_fd=folder)
    except BaseException:
        with suppress(OSError):
            os.unlink(beside, dir_fd=folder)
        raise


def clear_parts(folder: int) -> None:
    """Take away what a `write_whole_at` that was killed has left in a folder that is open.

    Nobody else may be writing there.
    """
    for name in os.listdir(folder):
        if _PART.fullmatch(name):
            with suppress(OSError):
                os.unlink(name, dir_fd=folder)


def write_all(descriptor: int, data: bytes) -> None:
    """Write all of something, however many calls that takes.

    Raises:
        OSError: It cannot be written; a part of it may have been.
    """
    rest = memoryview(data)
    while rest:
        rest = rest[os.write(descriptor, rest) :]
