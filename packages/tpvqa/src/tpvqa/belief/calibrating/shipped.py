"""Calibrations that come with a package, by the VLM that they are of.

A package offers one by an entry point in the group `tpvqa.calibrations`: a function without
arguments that gives the `Calibration`, under the name of the VLM's specification.
"""

from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.errors import PluginError
from tpvqa.plugins import Kind, load, names


def shipped_calibration(vlm: str) -> Calibration | None:
    """The calibration of a VLM that an installed package brings; None where there is none.

    Args:
        vlm: Specification of the VLM, e.g. "embedded".

    Raises:
        PluginError: It is no calibration.
    """
    if vlm not in names(Kind.CALIBRATION):
        return None
    found = load(Kind.CALIBRATION, vlm)()
    if not isinstance(found, Calibration):
        raise PluginError(
            f"The calibration {vlm!r} has to be a Calibration, not {type(found).__name__}."
        )
    return found
