"""The closed loop as a generator of requests: it touches no world, no disk and no clock."""

from tpvqa.trial.loop import trial
from tpvqa.trial.pending import Act, Conclusion, Pending, Result, Steps, Unwatched, Wait

__all__ = ["Act", "Conclusion", "Pending", "Result", "Steps", "Unwatched", "Wait", "trial"]
