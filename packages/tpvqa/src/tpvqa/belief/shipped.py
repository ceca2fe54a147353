"""Calibrations that come with tpvqa."""

from importlib import resources

from tpvqa.belief.calibration import Calibration


def shipped_calibration(vlm: str) -> Calibration | None:
    """The calibration of a VLM that comes with tpvqa; None where there is none.

    Args:
        vlm: Specification of the VLM, e.g. "embedded".
    """
    file = resources.files(__package__) / "calibrations" / f"{vlm}.json"
    if not vlm.isidentifier() or not file.is_file():
        return None
    return Calibration.model_validate_json(file.read_bytes())
