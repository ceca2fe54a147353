"""What decides the figures of every bench, besides its cells."""

from typing import Any

from tpvqa import DECIDES_AS
from tpvqa.config import TrialConfig


def common_settings(common: TrialConfig) -> dict[str, Any]:
    """The version that decides alike, and what all trials of a bench share.

    Args:
        common: What all cells share: seed, rates of faults, limits.
    """
    return {
        "version": DECIDES_AS,
        "seed": common.seed,
        **({} if common.simulation is None else common.simulation.model_dump()),
        **{
            f"limit of {name}": value
            for name, value in common.limits.model_dump().items()
            if value is not None
        },
    }
