"""Where a command may write: never over what it reads, and over what is there only if told to."""

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tpvqa.config import TrialConfig


def see_unread(path: Path, option: str, read: Iterable[Path | str | None]) -> None:
    """See that a file to be written is none of those that the command reads.

    Args:
        path: The file to be written.
        option: What names it on the command line.
        read: Files, and folders of episodes, that are read; None and "" are passed over.

    Raises:
        TpvqaError: It is one of them, or the log, the labels or a picture of such an episode.
    """
    from tpvqa.episodes.own_files import belongs_to, same_file
    from tpvqa.errors import TpvqaError

    for each in (Path(each) for each in read if each):
        if same_file(path, each) or belongs_to(path, each):
            raise TpvqaError(
                f"{path} is read by this command, and would be lost; name another file with "
                f"{option}"
            )


def see_free(path: Path, option: str, *, force: bool) -> None:
    """See that nothing lies where a file is to be written, unless that may be written over.

    Raises:
        TpvqaError: Something does.
    """
    from tpvqa.errors import TpvqaError

    if path.exists() and not force:
        raise TpvqaError(
            f"{path} is there, and may be what others go by; name another file with {option}, or "
            "write over it with --force"
        )


@contextmanager
def all_or_none(paths: Iterable[Path]) -> Iterator[None]:
    """Take away again what is written newly where not all of it can be: it would be in the way."""
    new = [path for path in paths if not os.path.lexists(path)]
    try:
        yield
    except BaseException:
        for path in new:
            with suppress(OSError):
                path.unlink()
        raise


def named_by(vlm: str | None) -> str:
    """What stands behind the name of a VLM: a table of answers, say (`recorded:FILE:fresh`)."""
    return (vlm or "").partition(":")[2].partition(":")[0]


def files_of(config: "TrialConfig") -> Iterator[str]:
    """All files and folders that a configuration names."""
    from tpvqa.config.layers import settings

    for each in settings():
        if each.file:
            value: object = config
            for name in each.key:
                value = getattr(value, name, None)
            if isinstance(value, str):
                yield value
