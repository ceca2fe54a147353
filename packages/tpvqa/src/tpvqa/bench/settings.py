"""What decides the figures of every bench, besides its cells."""

from typing import Any

from tpvqa import __version__
from tpvqa.trial import TrialConfig


def common_settings(common: TrialConfig) -> dict[str, Any]:
    """The version, and what all trials of a bench share.

    Args:
        common: What all cells share: seed, rates of faults, limits.
    """
    return {
        "version": __version__,
        "seed": common.seed,
        "failure": common.failure,
        "disturbance": common.disturbance,
        "spontaneous": common.spontaneous,
        **{f"limit of {k}": v for k, v in common.limits.model_dump().items()},
    }
