"""Folders within that of a bench."""

from pathlib import Path

from tpvqa.errors import WriteError
from tpvqa.files import make_folder


def folder_within(folder: Path, name: str) -> Path:
    """Make a folder in that of a bench, where it is not there.

    Somebody else may have put a link in its place, which would lead out of the bench.

    Args:
        folder: Of the bench.
        name: Of the folder in it.

    Raises:
        WriteError: It cannot be made, or a link or a file lies in its place.
    """
    path = folder / name
    try:
        make_folder(path, follow=False)
    except OSError as error:
        remedy = "Remove what lies there, or name another folder with --out"
        raise WriteError.of(path, error, remedy) from error
    return path
