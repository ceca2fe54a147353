"""What a bench says of itself in JSON, beside its rows or with them: read strictly."""

import json
from pathlib import Path
from typing import Any

from tpvqa.errors import BenchError
from tpvqa.files import read_plain
from tpvqa.told import check_json

_LARGEST = 16 * 2**20
"""Bytes. Settings have some hundred, the tasks of a large bench a hundred each."""


def told_object(data: bytes) -> dict[str, Any]:
    """An object of JSON.

    Raises:
        ValueError: It is none; says why.
    """
    check_json(data)
    found = json.loads(data)
    if not isinstance(found, dict):
        raise ValueError("it holds no names with values")
    return found


def told_texts(data: bytes) -> dict[str, str]:
    """The same, of texts only.

    Raises:
        ValueError: It is none; says why.
    """
    found = told_object(data)
    if not all(isinstance(value, str) for value in found.values()):
        raise ValueError("it holds no names with texts")
    return found


def read_object(
    path: Path, *, remedy: str = "Remove the folder, or name another"
) -> dict[str, Any] | None:
    """What a file in the folder of a bench says; None where there is none.

    Args:
        path: The file. A link in its place is not followed.
        remedy: What the user can do where it is damaged; a sentence without its full stop.

    Raises:
        BenchError: It is damaged, or no plain file.
    """
    try:
        return told_object(read_plain(path, most=_LARGEST, follow=False))
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        why = (isinstance(error, OSError) and error.strerror) or error
        raise BenchError(f"{path}: damaged ({why}). {remedy}") from None
