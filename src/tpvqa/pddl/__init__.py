"""PDDL text → `Task`: objects, ground actions as written, initial state, goal, mutex groups."""

from tpvqa.pddl.atoms import Atom, Literal, State
from tpvqa.pddl.conditions import Condition, Conjunction, Disjunction, holds, literals, supporting
from tpvqa.pddl.task import Action, Effect, MutexGroup, Task, load_task

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
    "holds",
    "literals",
    "load_task",
    "supporting",
]
