"""What is learned is written whole or not at all."""

import os
from pathlib import Path

from pydantic import BaseModel

from tpvqa.errors import CalibrationError


def write_json(path: Path, model: BaseModel, *, remedy: str) -> None:
    """Write a model as a JSON file that is either the old one or the whole new one.

    Args:
        path: The file; its folder is made.
        model: What to write.
        remedy: What the user can do where it cannot be written.

    Raises:
        CalibrationError: It cannot be written.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary.write_text(model.model_dump_json(indent=1) + "\n")
        temporary.replace(path)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise CalibrationError(f"{path}: cannot be written ({error.strerror}). {remedy}") from error
