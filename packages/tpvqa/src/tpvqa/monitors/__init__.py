"""Action + answers → `Verdict`, behind the `Monitor` protocol."""

from tpvqa.events.decision import Decision
from tpvqa.monitors.protocol import Check, Monitor, Step
from tpvqa.monitors.requests import Ask, AskPerson, Look, PlanFrom, Request
from tpvqa.monitors.verdict import Verdict

__all__ = [
    "Ask",
    "AskPerson",
    "Check",
    "Decision",
    "Look",
    "Monitor",
    "PlanFrom",
    "Request",
    "Step",
    "Verdict",
]
