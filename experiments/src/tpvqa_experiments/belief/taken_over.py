"""Trials of rivals, taken over from a folder that another version has written.

What a rival decides does not depend on how the belief monitor decides or is calibrated. So where
only that has changed, rivals need not be run again.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tpvqa.bench.ledger import REMEDY, ROWS, SETTINGS, Ledger
from tpvqa.bench.published import differences
from tpvqa.bench.told_object import read_object
from tpvqa.errors import BenchError
from tpvqa.files import write_whole
from tpvqa_experiments.belief.parts import believes

OF_BELIEF = (
    "version",
    "trials of a calibration",
    "how calibrations are learnt",
    "the embedded network is calibrated in",
)
"""Settings that decide what the belief monitor does, and nobody else."""
NOTE = "taken_over.json"
"""Which version ran the rivals, in a folder that did not run all of them itself."""


def take_over(source: Path, folder: Path, settings: Mapping[str, Any]) -> int:
    """Count the finished trials of rivals in another folder as finished in this one.

    Args:
        source: The folder of another belief bench, of an earlier version, too.
        folder: Where this bench lies; it is made.
        settings: Those of this bench.

    Returns:
        How many trials were taken over; none that lie here already.

    Raises:
        BenchError: No bench lies there, or one with another seed, other rates of faults or limits.
    """
    there = read_object(source / SETTINGS, remedy="Name another folder")
    if there is None or not (source / ROWS).is_file():
        raise BenchError(f"{source} holds no bench. Name a folder of `tpvqa bench belief`")
    changed = differences(_of_all(there), _of_all(settings))
    if changed:
        raise BenchError(
            f"{source} holds a bench with other settings ({changed}), so that its rivals cannot be "
            "taken over. Run them again, without --rivals-from"
        )
    theirs = Ledger(source, there)
    theirs.close()
    ours = Ledger(folder, settings)
    try:
        new = [
            row
            for key, row in theirs.rows.items()
            if not believes(row.monitor) and not row.error and key not in ours.rows
        ]
        ours.add(new)
    finally:
        ours.close()
    version = there.get("version")
    if new and version != settings["version"]:
        told = {**taken_over(folder), "rivals of version": version}
        write_whole(folder / NOTE, f"{json.dumps(told)}\n".encode(), remedy=REMEDY)
    return len(new)


def taken_over(folder: Path) -> dict[str, Any]:
    """What tables have to say of rivals that another version ran; empty where none did.

    Raises:
        BenchError: The note is damaged.
    """
    return read_object(folder / NOTE, remedy="Remove it, or name another folder") or {}


def _of_all(settings: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in settings.items() if name not in OF_BELIEF}
