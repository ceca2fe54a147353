"""PDDL text → `Task`: objects, ground actions as written, initial state, goal, mutex groups.

Names are imported when they are first used: the worker, which is started often, needs none of them.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tpvqa.pddl.atoms import Atom, Literal, State
    from tpvqa.pddl.conditions import (
        Condition,
        Conjunction,
        Disjunction,
        holds,
        literals,
        supporting,
    )
    from tpvqa.pddl.ground import Action, Effect, MutexGroup
    from tpvqa.pddl.loading import load_task, task_from_text
    from tpvqa.pddl.task import Task
    from tpvqa.pddl.validation import Validation, validate

__all__ = [
    "Action",
    "Atom",
    "Condition",
    "Conjunction",
    "Disjunction",
    "Effect",
    "Literal",
    "MutexGroup",
    "State",
    "Task",
    "Validation",
    "holds",
    "literals",
    "load_task",
    "supporting",
    "task_from_text",
    "validate",
]

_IN = {
    "atoms": ("Atom", "Literal", "State"),
    "conditions": (
        "Condition",
        "Conjunction",
        "Disjunction",
        "holds",
        "literals",
        "supporting",
    ),
    "ground": ("Action", "Effect", "MutexGroup"),
    "loading": ("load_task", "task_from_text"),
    "task": ("Task",),
    "validation": ("Validation", "validate"),
}
_PUBLIC = {name: module for module, names in _IN.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _PUBLIC:
        raise AttributeError(f"module 'tpvqa.pddl' has no attribute {name!r}")
    found = globals()[name] = getattr(import_module(f"tpvqa.pddl.{_PUBLIC[name]}"), name)
    return found
