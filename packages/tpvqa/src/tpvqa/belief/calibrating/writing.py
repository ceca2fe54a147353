"""What is learned is written whole or not at all, and read as strictly."""

import json
from pathlib import Path

from pydantic import BaseModel

from tpvqa.errors import PlacedError, WriteError
from tpvqa.files import make_folder, write_whole
from tpvqa.text_files import read_text
from tpvqa.told import check_names


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


def read_json(path: Path, *, what: str) -> str:
    """The text of a JSON file that `write_json` wrote, and that somebody may have changed since.

    Args:
        path: The file.
        what: What it is, for messages.

    Raises:
        PlacedError: It cannot be read, is no text in UTF-8, or gives a name twice.
    """
    text = read_text(path, PlacedError, what=what)
    try:
        check_names(text)
    except (json.JSONDecodeError, RecursionError):
        pass  # the model that it is read into says so
    except ValueError as error:  # of two values one would count, and nobody knows which is meant
        raise PlacedError(f"{error} in one object", file=path) from None
    return text
