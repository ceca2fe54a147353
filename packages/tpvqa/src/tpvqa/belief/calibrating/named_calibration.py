"""The calibration that a user names: what may be meant by another file is told."""

import json
from collections import Counter
from pathlib import Path

from tpvqa.belief.calibrating.calibration import Calibration, Group
from tpvqa.belief.calibrating.writing import read_json
from tpvqa.errors import CalibrationError, PlacedError

_REMEDY = "Name what `tpvqa calibrate --out FILE` wrote, or make another"


def named_calibration(path: Path) -> Calibration:
    """Read a calibration that a user names.

    Raises:
        CalibrationError: It cannot be read, is none or broken, or tells of a group twice.
    """
    try:
        found = Calibration.load(path)
    except CalibrationError as error:
        if _of_an_experience(path):
            raise CalibrationError(
                f"{path}: it is an experience, which --experience takes, and no calibration. "
                f"{_REMEDY}"
            ) from error
        raise
    told = Counter(_name(group) for group in (*found.ways, *found.groups))
    twice = next((name for name, times in told.items() if times > 1), None)
    if twice is not None:
        raise CalibrationError(f"{path}: it tells of {twice} twice. {_REMEDY}")
    return found


def _name(group: Group) -> str:
    return " of ".join(filter(None, (group.predicate, group.way))) or "all answers"


def _of_an_experience(path: Path) -> bool:
    """Whether a file looks like what a monitor learned in earlier trials."""
    try:
        told = json.loads(read_json(path, what="calibration"))
    except (PlacedError, ValueError, RecursionError):
        return False
    return isinstance(told, dict) and "spontaneous" in told and "whole" not in told
