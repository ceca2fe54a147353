"""A task without variables, as engines that know no PDDL are given it: from any state."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from tpvqa.pddl import Action, Atom, Condition, Conjunction, Literal, State, Task
from tpvqa.pddl.arithmetic import COMPARISONS, values_in
from tpvqa.pddl.derivation import GroundAxiom
from tpvqa.pddl.ground import Effect
from tpvqa.pddl.numeric import numbers_of
from tpvqa.pddl.schema import FALSE, TRUE, join
from tpvqa.planning.numbers import Numbering
from tpvqa.planning.ranges import Ranges


@dataclass(frozen=True, slots=True)
class Propositional:
    """What can be done from a state, and to what end. What cannot vary is decided.

    Attributes:
        task: The task, grounded from where the state's facts can be reached.
        init: The atoms that hold at first, of those that vary.
        actions: The actions that can be reached where nothing is ever undone; conditions speak of
            what varies alone.
        goal: The goal, in the same way.
        rules: What derived atoms follow from.
        in_reach: Whether the goal can be reached where nothing is ever undone.
        whole: Whether nothing of the task was left out.
        values: The facts that say values of functions.
    """

    task: Task
    init: State
    actions: tuple[Action, ...]
    goal: Condition
    rules: tuple[GroundAxiom, ...]
    in_reach: bool
    whole: bool
    values: State = frozenset()

    def numbered(self) -> dict[str, Any]:
        """The same in lists and numbers, as it is sent to another process.

        Atoms are numbers; a condition is `[atom, holds]`, or `["and", …]` or `["or", …]` of such.
        An action is what it needs, its effects as `[condition, atom, holds]`, and its cost. Of a
        task with numbers it also says the "values" of functions at first and the "changes" of each
        action; see `Numbering`.
        """
        numbers: dict[Atom, int] = {}
        functions = Numbering()

        def number(atom: Atom) -> int:
            return numbers.setdefault(atom, len(numbers))

        def said(condition: Condition) -> list[Any]:
            if isinstance(condition, Literal):
                if condition.atom.predicate in COMPARISONS:
                    return functions.comparison(condition.atom)
                return [number(condition.atom), condition.positive]
            word = "and" if isinstance(condition, Conjunction) else "or"
            return [word, *map(said, condition.parts)]

        task = {
            "init": sorted(map(number, sorted(self.init))),
            "goal": said(self.goal),
            "actions": [
                [
                    said(action.precondition),
                    [
                        [said(e.condition), number(e.literal.atom), e.literal.positive]
                        for e in action.effects
                    ],
                    action.cost,
                ]
                for action in self.actions
            ],
            "rules": [[number(rule.head), said(rule.condition)] for rule in self.rules],
        }
        if self.task.numeric is not None:
            changes = functions.changes(self.actions, said)
            task |= {"changes": changes, "values": functions.values(self.values)}
        return {**task, "atoms": len(numbers)}


def propositional(
    task: Task, state: State, *, may: Callable[[Action], bool] = lambda _: True
) -> Propositional:
    """Ground a task from a state.

    Args:
        task: The task; what it was grounded to is kept where that serves the state.
        state: The atoms that hold; derived ones do not count.
        may: Whether an action may be taken at all.

    Raises:
        PDDLError: The state speaks of unknown predicates or objects.
        PlannerError: It could not be grounded.
    """
    values = numbers_of(state)
    state = frozenset(atom for atom in state if atom.predicate not in task.derived) - values
    fluent = frozenset(atom for atom in state if atom.predicate in task.fluents)
    if state - fluent != task.static or not fluent <= task.reachable_atoms:
        task = task.with_init(state | values)
    rules = task.derivation(state).rules if task.axioms else ()
    taken = tuple(filter(may, task.ground_actions()))
    reach, actions = _within_reach(taken, rules, state, Ranges(values_in(values)))
    possible = reach.possible
    added = {e.literal.atom for a in actions for e in a.effects if e.literal.positive}
    deleted = {e.literal.atom for a in actions for e in a.effects if not e.literal.positive}
    heads = {rule.head for rule in rules} & possible

    def known(atom: Atom) -> bool | None:
        if atom in heads or atom.predicate in COMPARISONS:
            return None
        if atom in state:
            return None if atom in deleted else True
        return None if atom in added and atom in possible else False

    decided = tuple(
        replace(
            action,
            precondition=_decided(action.precondition, known),
            effects=tuple(
                Effect(condition, effect.literal)
                for effect in action.effects
                if known(effect.literal.atom) is None
                if (condition := _decided(effect.condition, known)) != FALSE
            ),
            changes=tuple(
                replace(change, condition=condition)
                for change in action.changes
                if (condition := _decided(change.condition, known)) != FALSE
            ),
        )
        for action in actions
    )
    return Propositional(
        task=task,
        init=frozenset(atom for atom in fluent if known(atom) is None),
        actions=tuple(
            each
            for each in decided
            if each.precondition != FALSE and (each.effects or each.changes)
        ),
        goal=_decided(task.goal, known),
        rules=tuple(
            GroundAxiom(rule.head, condition)
            for rule in rules
            if rule.head in heads
            if (condition := _decided(rule.condition, known)) != FALSE
        ),
        in_reach=reach.allows(task.goal),
        whole=not task.left_out,
        values=values,
    )


@dataclass(frozen=True, slots=True)
class _Reach:
    """What can come to hold where nothing is ever undone.

    Attributes:
        possible: The atoms that can.
        stays: The atoms that hold and never cease to.
        ranges: What numbers can be.
    """

    possible: set[Atom]
    stays: set[Atom]
    ranges: Ranges

    def allows(self, condition: Condition) -> bool:
        """Whether a condition can come to hold, where each literal is taken by itself."""
        if isinstance(condition, Literal):
            if condition.atom.predicate in COMPARISONS:
                return not condition.positive or self.ranges.allows(condition.atom)
            held = condition.atom in (self.possible if condition.positive else self.stays)
            return held == condition.positive
        parts = map(self.allows, condition.parts)
        return all(parts) if isinstance(condition, Conjunction) else any(parts)


def _within_reach(
    actions: tuple[Action, ...], rules: tuple[GroundAxiom, ...], state: State, ranges: Ranges
) -> tuple[_Reach, tuple[Action, ...]]:
    """What can be reached where nothing is ever undone, and by which actions."""
    deleted = {e.literal.atom for a in actions for e in a.effects if not e.literal.positive}
    reach = _Reach(set(state), set(state) - deleted, ranges)
    possible, waiting = reach.possible, list(actions)
    reached: list[Action] = []
    before, wider = (-1, -1), False
    while wider or before != (len(possible), len(reached)):
        before = len(possible), len(reached)
        possible.update(rule.head for rule in rules if reach.allows(rule.condition))
        left: list[Action] = []
        for action in waiting:
            (reached if reach.allows(action.precondition) else left).append(action)
        waiting = left
        possible.update(
            effect.literal.atom
            for action in reached
            for effect in action.effects
            if effect.literal.positive and reach.allows(effect.condition)
        )
        wider = ranges.widen(
            change
            for action in reached
            for change in action.changes
            if reach.allows(change.condition)
        )
    return reach, tuple(reached)


def _decided(condition: Condition, known: Callable[[Atom], bool | None]) -> Condition:
    if isinstance(condition, Literal):
        holds = known(condition.atom)
        if holds is None:
            return condition
        return TRUE if holds == condition.positive else FALSE
    return join(
        (_decided(part, known) for part in condition.parts),
        conjunctive=isinstance(condition, Conjunction),
    )
