"""What the answers of the embedded network are worth: the calibration that comes with it."""

from functools import cache
from pathlib import Path

from tpvqa.belief import Calibration


@cache
def embedded() -> Calibration:
    """That of the shipped weights, see docs/calibration.md."""
    return Calibration.model_validate_json(Path(__file__).with_name("embedded.json").read_bytes())
