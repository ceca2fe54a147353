"""From answers to what is probably true."""

from tpvqa.belief.calibration import AnswerRates, Apart, Calibration, Curve, Group
from tpvqa.belief.labelled_answer import LabelledAnswer

__all__ = ["AnswerRates", "Apart", "Calibration", "Curve", "Group", "LabelledAnswer"]
