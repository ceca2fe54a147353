"""What happens in a trial, as typed events; and what they make of where it stands."""

from tpvqa.config import Limits
from tpvqa.events.decision import Decision
from tpvqa.events.events import EVENT, Ended, Event, Resumed, Started
from tpvqa.events.state import Exchange, TrialState

__all__ = [
    "EVENT",
    "Decision",
    "Ended",
    "Event",
    "Exchange",
    "Limits",
    "Resumed",
    "Started",
    "TrialState",
]
