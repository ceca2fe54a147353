"""From answers to what is probably true."""

from tpvqa.belief.calibrating.calibration import AnswerRates, Apart, Calibration, Curve, Group
from tpvqa.belief.calibrating.labelled_answer import LabelledAnswer

__all__ = ["AnswerRates", "Apart", "Calibration", "Curve", "Group", "LabelledAnswer"]
