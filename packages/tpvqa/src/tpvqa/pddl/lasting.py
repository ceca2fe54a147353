"""Actions that last: what they begin with, what must hold meanwhile, how they end, how long.

The worker takes a durative action apart into actions without duration (see
`tpvqa.pddl.worker.durative`); this says which of them belong together.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction
from functools import cached_property
from typing import Any, Protocol

from tpvqa.errors import PDDLError
from tpvqa.pddl.arithmetic import (
    Expression,
    Values,
    bound,
    evaluated,
    expression,
    functions_in,
    number,
    written,
)
from tpvqa.pddl.atoms import Atom, Literal, State
from tpvqa.pddl.conditions import Condition, Conjunction, literals
from tpvqa.pddl.ground import Action, Effect, MutexGroup

LONGEST = 10**12
"""No action lasts longer, whatever its unit of time."""


class Actions(Protocol):
    """A task, as far as it is needed here."""

    def action(self, name: str, arguments: Iterable[str] = ()) -> Action:
        """The ground action of a name and arguments."""


class Phase(StrEnum):
    """What an action without duration is of one that lasts."""

    START = "start"
    WHILE = "while"  # a look at what must hold meanwhile
    END = "end"
    CANCEL = "cancel"


@dataclass(frozen=True, slots=True)
class Running:
    """An action that has begun and not ended.

    Attributes:
        action: What it began with.
        left: The time until its end.
    """

    action: Action
    left: float


@dataclass(frozen=True)
class Lasting:
    """The durative actions of a domain.

    Attributes:
        variables: The parameters of each, by its name.
        durations: The least and the greatest duration of each.
        values: The values of the functions that durations refer to.
        quickest: Whether the problem asks for the quickest plan.
    """

    variables: Mapping[str, tuple[str, ...]]
    durations: Mapping[str, tuple[Expression, Expression]]
    values: Values
    quickest: bool = False

    @staticmethod
    def of(description: Mapping[str, Any] | None) -> "Lasting | None":
        """What the worker says of them; None for a domain without any."""
        if description is None:
            return None
        actions = description["actions"]
        return Lasting(
            {each["name"]: tuple(each["variables"]) for each in actions},
            {each["name"]: _bounds(*each["duration"]) for each in actions},
            {tuple(words): number(value) for words, value in description["values"]},
            description["quickest"],
        )

    @cached_property
    def _phases(self) -> dict[str, tuple[Phase, str]]:
        return {f"{phase}-{name}": (phase, name) for name in self.variables for phase in Phase}

    def name_of(self, action: str) -> str | None:
        """The durative action that an action is a part of; None where it is not."""
        found = self._phases.get(action)
        return None if found is None else found[1]

    def phase_of(self, action: str) -> Phase | None:
        """Which part of a durative action an action is; None where it is none."""
        found = self._phases.get(action)
        return None if found is None else found[0]

    def predicate(self, name: str) -> str:
        """What says that a durative action is running."""
        return f"running-{name}"

    @cached_property
    def predicates(self) -> frozenset[str]:
        """The predicates which say that an action is running."""
        return frozenset(map(self.predicate, self.variables))

    def running(self, action: Action) -> Atom:
        """The fact that the action which an action is a part of is running."""
        return Atom(self.predicate(self._phases[action.name][1]), action.arguments)

    def part(self, task: Actions, action: Action, phase: Phase) -> Action:
        """Another part of the same durative action."""
        return task.action(f"{phase}-{self._phases[action.name][1]}", action.arguments)

    def meanwhile(self, task: Actions, action: Action) -> Condition:
        """What must hold while the action is running that an action is a part of."""
        return without(self.part(task, action, Phase.WHILE).precondition, self.running(action))

    def looks(self, task: Actions, actions: Iterable[Action]) -> Iterator[Action]:
        """The look at each action that lasts whose start is among some actions."""
        for action in actions:
            if self.phase_of(action.name) is Phase.START:
                yield self.part(task, action, Phase.WHILE)

    def taken_back(self, action: Action, groups: Iterable[MutexGroup]) -> Action:
        """What cancels an action, given which facts exclude each other.

        Each effect at start is taken back that is as it left it, whatever became of the others:
        who drops a thing has its hand free again. But a fact comes back only where none has come
        in its place.

        Args:
            action: A ground action; any but a cancellation is left as it is.
            groups: The mutex groups of the task.
        """
        if self.phase_of(action.name) is not Phase.CANCEL:
            return action
        running = self.running(action)
        own = {effect.literal.atom for effect in action.effects if effect.literal.atom != running}
        rivals = {atom: set[Atom]() for atom in own}
        for group in groups:
            for atom in own & group.atoms:
                rivals[atom] |= group.atoms - own
        return replace(
            action,
            effects=tuple(
                each
                if each.literal.atom == running
                else replace(each, condition=_as_left(each, rivals[each.literal.atom]))
                for each in action.effects
            ),
        )

    def under_way(self, task: Actions, state: State) -> tuple[Action, ...]:
        """What every action began with that is running in a state."""
        return tuple(
            task.action(f"{Phase.START}-{atom.predicate.removeprefix('running-')}", atom.arguments)
            for atom in sorted(state)
            if atom.predicate in self.predicates
        )

    def duration(self, action: Action) -> tuple[float, float]:
        """The least and the greatest duration of the action that an action is a part of.

        Raises:
            PDDLError: A function has no value, or it does not last at all.
        """
        name = self._phases[action.name][1]
        binding = dict(zip(self.variables[name], action.arguments, strict=True))
        said = f"{name}({', '.join(action.arguments)})"
        least, most = (self._number(bound(part, binding), said) for part in self.durations[name])
        if not 0 < least <= most <= LONGEST:
            raise PDDLError(
                f"{said} lasts {written(least)[:20]} to {written(most)[:20]}; expected that it "
                f"lasts more than nothing, at least no more than at most, and no more than "
                f"{LONGEST:g}"
            )
        return float(least), float(most)

    def _number(self, duration: Expression, said: str) -> Fraction:
        value = evaluated(duration, self.values)
        if value is not None:
            return value
        missing = next((each for each in functions_in(duration) if each not in self.values), None)
        if missing is None:
            raise PDDLError(f"the duration of {said} divides by zero")
        raise PDDLError(
            f"the duration of {said} is ({' '.join(missing)}), to which the initial state gives "
            "no value"
        )


def _bounds(least: Any, most: Any) -> tuple[Expression, Expression]:
    return expression(least), expression(most)


def _as_left(effect: Effect, rivals: Collection[Atom]) -> Condition:
    if not effect.literal.positive:
        return effect.literal.negate()
    none = (Literal(atom, False) for atom in sorted(rivals))
    return Conjunction((effect.literal.negate(), *none))


def without(condition: Condition, atom: Atom) -> Condition:
    """A conjunction without what it says of an atom."""
    if Literal(atom) == condition:
        return Conjunction()
    if not isinstance(condition, Conjunction):
        return condition
    return Conjunction(tuple(part for part in condition.parts if part != Literal(atom)))


def says_something(condition: Condition) -> bool:
    """Whether a condition speaks of any fact."""
    return next(literals(condition), None) is not None
