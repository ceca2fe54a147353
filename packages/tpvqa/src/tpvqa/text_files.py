"""Text files that users name: read whole, within a bound, and told where that cannot be."""

import os
from pathlib import Path

from tpvqa.errors import PlacedError, a
from tpvqa.files import open_plain

LARGEST = 16 << 20
"""Bytes. A file that people write is smaller; a device has no end."""


def read_bytes(
    path: Path, error: type[PlacedError], *, what: str = "file", largest: int = LARGEST
) -> bytes:
    """What a file holds.

    Args:
        path: The file.
        error: What is raised where it cannot be read.
        what: What it is, for messages.
        largest: So many bytes are taken at most.

    Raises:
        PlacedError: It cannot be read, or is larger.
    """
    if path.is_dir():
        raise error(f"cannot be read: this is a folder; expected {a(what)}", file=path)
    try:
        with os.fdopen(open_plain(path, os.O_RDONLY, follow=True), "rb") as file:
            data = file.read(largest + 1)
    except FileNotFoundError as failed:
        raise error(f"cannot be read: there is no such {what}", file=path) from failed
    except (OSError, ValueError) as failed:
        reason = getattr(failed, "strerror", None) or failed
        raise error(f"cannot be read ({reason}); expected {a(what)}", file=path) from failed
    if len(data) > largest:
        raise error(
            f"cannot be read: it is larger than {largest >> 20} MB, as no {what} is; is it the "
            "right one?",
            file=path,
        )
    return data


def read_text(
    path: Path, error: type[PlacedError], *, what: str = "file", largest: int = LARGEST
) -> str:
    """The text of a file in UTF-8; arguments as of `read_bytes`.

    Raises:
        PlacedError: It cannot be read, is larger, or is no such text; with the line.
    """
    return decoded(read_bytes(path, error, what=what, largest=largest), error, path)


def decoded(data: bytes, error: type[PlacedError], path: Path) -> str:
    """The text of what a file held, in UTF-8.

    Raises:
        PlacedError: It is no such text; with the line.
    """
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as strange:
        raise error(
            f"the byte 0x{data[strange.start]:02x} is not UTF-8 text; save the file as UTF-8",
            file=path,
            line=data.count(b"\n", 0, strange.start) + 1,
        ) from strange


def kept_text(path: Path | str | None) -> str | None:
    """What a file says, to be compared with what it says later; None where there is none."""
    return None if path is None else Path(path).read_bytes().decode(errors="replace")
