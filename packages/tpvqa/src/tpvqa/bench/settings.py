"""What decides the figures of every bench, besides its cells."""

import json
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path
from typing import Any

from tpvqa import DECIDES_AS
from tpvqa.bench.condition import RATES
from tpvqa.config import SimulationConfig, TrialConfig
from tpvqa.config.layers import settings
from tpvqa.errors import PDDLError
from tpvqa.text_files import read_text

OF_CELLS = (("world", "spec"), ("vlm", "spec"), ("monitor", "spec"))
"""What every cell says for itself."""
TOLD_OTHERWISE = ("task", "seed", "episode", "simulation", "limits")
DECIDES_NOTHING = (
    *(("vlm", name) for name in ("base_url", "cache", "record", "replay")),
    *(("monitor", name) for name in ("calibration", "experience")),
)
"""Where a server stands, whether its answers are recorded; and files, of which what they say
counts."""


def common_settings(common: TrialConfig) -> dict[str, Any]:
    """The version that decides alike, and what all trials of a bench share.

    Args:
        common: What all cells share: seed, rates of faults, limits.
    """
    return {
        "version": DECIDES_AS,
        "seed": common.seed,
        **({} if common.simulation is None else _faults(common.simulation)),
        **{
            f"limit of {name}": value
            for name, value in common.limits.model_dump().items()
            if value is not None
        },
        **dict(_others(common)),
    }


def _faults(simulation: SimulationConfig) -> dict[str, Any]:
    """The rates, and what else is not as it always was; of a file what it says."""
    told, usual = simulation.model_dump(), SimulationConfig().model_dump()
    for name in usual.keys() - RATES:
        if told[name] == usual[name]:
            del told[name]
    if simulation.true_start is not None:
        told["true_start"] = fingerprint(Path(simulation.true_start))
    return told


def _others(common: TrialConfig) -> Iterator[tuple[str, Any]]:
    """Every other setting that is not as it is by default, by its option."""
    for each in settings():
        if each.key[0] in TOLD_OTHERWISE or each.key in (*OF_CELLS, *DECIDES_NOTHING):
            continue
        value: Any = common
        for name in each.key:
            value = getattr(value, name)
        if value == each.default:
            continue
        if each.file and Path(value).is_file():
            value = fingerprint(Path(value))
        yield each.option.lstrip("-"), json.loads(json.dumps(value, default=str))


def fingerprint(file: Path) -> str:
    """Tells a file from one that says something else.

    Raises:
        PDDLError: It cannot be read.
    """
    return sha256(read_text(file, PDDLError, what="file").encode()).hexdigest()[:12]
