"""What is learned is written whole or not at all."""

import errno
import os
from pathlib import Path

from pydantic import BaseModel

from tpvqa.errors import WriteError
from tpvqa.files import make_folder, write_whole


def writable(path: Path, *, remedy: str) -> None:
    """See that a file can be written, as far as that can be known before it is.

    Raises:
        WriteError: It cannot.
    """
    above = next(each for each in (path, *path.parents) if each.exists())
    if above != path and not above.is_dir():
        raise WriteError.of(
            path, NotADirectoryError(errno.ENOTDIR, f"{above} is no folder"), remedy
        )
    if not os.access(above, os.W_OK):
        raise WriteError.of(path, PermissionError(errno.EACCES, os.strerror(errno.EACCES)), remedy)


def write_json(path: Path, model: BaseModel, *, remedy: str) -> None:
    """Write a model as a JSON file that is either the old one or the whole new one.

    Args:
        path: The file; its folder is made.
        model: What to write.
        remedy: What the user can do where it cannot be written.

    Raises:
        WriteError: It cannot be written.
    """
    try:
        make_folder(path.parent)
    except OSError as error:
        raise WriteError.of(path, error, remedy) from error
    write_whole(path, f"{model.model_dump_json(indent=1)}\n".encode(), remedy=remedy)
