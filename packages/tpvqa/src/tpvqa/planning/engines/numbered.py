"""A numbered task in the words of unified-planning: fluents f0, f1, …, without variables."""

from typing import Any

from unified_planning import shortcuts as up

from tpvqa.planning.engines.numbers import Numbers

_COMPILERS = (
    ("DISJUNCTIVE_CONDITIONS", up.CompilationKind.DISJUNCTIVE_CONDITIONS_REMOVING),
    ("CONDITIONAL_EFFECTS", up.CompilationKind.CONDITIONAL_EFFECTS_REMOVING),
    ("NEGATIVE_CONDITIONS", up.CompilationKind.NEGATIVE_CONDITIONS_REMOVING),
)
"""What is compiled away for engines that do not know it, in this order."""
_ALWAYS = ["and"]


class Numbered:
    """A problem with the fluents, the initial state and the goal of a numbered task.

    Args:
        task: What `Ground.numbered` gives, or `planning.temporal.Schedule.request`.

    Attributes:
        problem: It has no actions yet.
    """

    def __init__(self, task: dict[str, Any]):
        self.problem = up.Problem("task")
        self._actions = task["actions"]
        self._numbers = Numbers(task, self.problem) if "values" in task else None
        self._fluents = [up.Fluent(f"f{n}", up.BoolType()) for n in range(task["atoms"])]
        for fluent in self._fluents:
            self.problem.add_fluent(fluent, default_initial_value=False)
        for atom in task["init"]:
            self.problem.set_initial_value(self._fluents[atom], True)
        for part in self._parts_of(task["goal"]):
            self.problem.add_goal(part)

    def needs(self, number: int) -> list[Any]:
        """What an action needs, as parts of a conjunction."""
        return self._parts_of(self._actions[number][0])

    def effects(self, number: int) -> list[tuple[Any, bool, Any]]:
        """What an action does: fluents, their values, and under which conditions. What is both
        added and deleted holds."""
        effects = self._actions[number][1]
        added = {repr(condition) + str(atom) for condition, atom, holds in effects if holds}
        return [
            (
                self._fluents[atom],
                holds,
                self._when(condition),
            )
            for condition, atom, holds in effects
            if holds or repr(condition) + str(atom) not in added
        ]

    def add_instantaneous(self, number: int) -> None:
        """Add an action that takes no time, by the name of its number: a0, a1, …"""
        action = up.InstantaneousAction(f"a{number}")
        for part in self.needs(number):
            action.add_precondition(part)
        for effect in self.effects(number):
            action.add_effect(*effect)
        if self._numbers is not None:
            self._numbers.change(number, action, self._when)
        self.problem.add_action(action)

    def _parts_of(self, condition: list[Any]) -> list[Any]:
        return list(map(self._said, condition[1:] if condition[0] == "and" else [condition]))

    def _when(self, condition: list[Any]) -> Any:
        return up.TRUE() if condition == _ALWAYS else self._said(condition)

    def _said(self, condition: list[Any]) -> Any:
        head, *parts = condition
        if head == "compare":
            assert self._numbers is not None
            return self._numbers.compared(condition)
        if head == "and":
            return up.And(*map(self._said, parts))
        if head == "or":
            return up.Or(*map(self._said, parts))
        fluent = self._fluents[head]
        return up.FluentExp(fluent) if parts[0] else up.Not(fluent)


def compiled_for(engine: Any, problem: Any) -> tuple[Any, list[Any]]:
    """A problem in what an engine knows, as far as that can be compiled.

    Returns:
        It, and how actions are mapped back, one step after the other, the last first to be done.
    """
    known, back = engine.supported_kind().features, []
    for feature, kind in _COMPILERS:
        if feature in problem.kind.features and feature not in known:
            with up.Compiler(problem_kind=problem.kind, compilation_kind=kind) as compiler:
                compiled = compiler.compile(problem, kind)
            problem = compiled.problem
            back.append(compiled.map_back_action_instance)
    return problem, back
