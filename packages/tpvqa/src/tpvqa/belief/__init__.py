"""From answers to what is probably true."""

from tpvqa.belief.calibration import Apart, Calibration, Curve, Group, Rates
from tpvqa.belief.labelled_answer import LabelledAnswer

__all__ = ["Apart", "Calibration", "Curve", "Group", "LabelledAnswer", "Rates"]
