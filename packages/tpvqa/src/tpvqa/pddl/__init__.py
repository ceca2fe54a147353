"""PDDL text → `Task`: objects, ground actions as written, initial state, goal, mutex groups."""

from tpvqa.pddl.atoms import Atom, Literal, State
from tpvqa.pddl.conditions import Condition, Conjunction, Disjunction, holds, literals, supporting
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
