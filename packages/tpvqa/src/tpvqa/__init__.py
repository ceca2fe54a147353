"""Visually grounded task planning.

A classical planner proposes actions; questions about their preconditions and effects go to a
vision-language model; a monitor decides to go on, to repeat or to replan; every step is written
into an episode. Method: Zhang et al. 2023, "Grounding Classical Task Planners via Vision-Language
Models".

Names are imported when they are first used, so that `import tpvqa` stays quick.
"""

from importlib import import_module
from typing import Any

__version__ = "0.4.0"
DECIDES_AS = "0.4.0"
"""The first version that decides trials as this one does: its published figures still stand."""

_PUBLIC = {
    "Action": "tpvqa.pddl",
    "ActionQuestion": "tpvqa.questions",
    "Answer": "tpvqa.vlm",
    "Atom": "tpvqa.pddl",
    "FactQuestion": "tpvqa.questions",
    "Interrupted": "tpvqa.drivers",
    "Literal": "tpvqa.pddl",
    "Observation": "tpvqa.observation",
    "Plan": "tpvqa.planning",
    "Question": "tpvqa.questions",
    "Reply": "tpvqa.vlm",
    "State": "tpvqa.pddl",
    "Task": "tpvqa.pddl",
    "TpvqaError": "tpvqa.errors",
    "Trial": "tpvqa.assembly",
    "TrialConfig": "tpvqa.config",
    "TrialState": "tpvqa.events",
    "load_task": "tpvqa.pddl",
}

__all__ = [
    "DECIDES_AS",
    "__version__",
    *sorted(_PUBLIC),
]


def __getattr__(name: str) -> Any:
    if name in _PUBLIC:
        return getattr(import_module(_PUBLIC[name]), name)
    raise AttributeError(f"module 'tpvqa' has no attribute {name!r}")


def __dir__() -> list[str]:
    return list(__all__)
