"""What can happen besides the robot's actions, as a superset of what a world file allows."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Protocol

from tpvqa.belief.states.transitions import Transition
from tpvqa.pddl import Atom, Task
from tpvqa.pddl.pattern import Binding, Pattern


class UndoOutcome(Protocol):
    """One way in which a fact is undone; see the world file's `outcomes`."""

    @property
    def last(self) -> Pattern | None:
        """Binds variables by a fact that held earlier."""

    @property
    def when(self) -> Sequence[Pattern]:
        """What holds before."""

    @property
    def add(self) -> Sequence[Pattern]:
        """What holds afterwards."""

    @property
    def delete(self) -> Sequence[Pattern]:
        """What no longer holds afterwards, besides the undone fact."""


class Undoing(Protocol):
    """A form of fact that is undone; see the world file's `undo`."""

    @property
    def fact(self) -> Pattern:
        """The fact that ends."""

    @property
    def outcomes(self) -> Sequence[UndoOutcome]:
        """What holds instead."""


def disturbances(task: Task, rules: Iterable[Undoing]) -> frozenset[Transition]:
    """All that the undo rules of a world file can do to any state that can be reached at all.

    More than happens: `unless` is ignored, and what held last is any fact that ever held.

    Args:
        task: Gives the facts that can hold.
        rules: The rules, e.g. `WorldRules.undo`.

    Raises:
        PlannerError: A rule leads to facts that no action brings about, and the worker could not
            ground the task from there.
    """
    rules = tuple(rules)
    wider = task
    while True:
        found = frozenset(_ground(wider, rules))
        new = _out_of_reach(wider, found)
        if not new:
            return found
        wider = wider.with_init(wider.init | new)


def reaching(task: Task, further: Iterable[Transition]) -> Task:
    """A task whose reachable atoms and actions are those that further transitions open up too.

    It is the task itself where they bring about nothing that actions do not; otherwise what they
    add holds in its initial state.

    Raises:
        PlannerError: The worker could not ground it.
    """
    new = _out_of_reach(task, further)
    return task.with_init(task.init | new) if new else task


def _out_of_reach(task: Task, transitions: Iterable[Transition]) -> frozenset[Atom]:
    added = frozenset[Atom]().union(*(transition.added for transition in transitions))
    return added - task.atoms() - task.init


def _ground(task: Task, rules: Iterable[Undoing]) -> Iterator[Transition]:
    fluent: dict[str, list[Atom]] = {}
    for atom in sorted(task.atoms() | task.init - task.static):
        if atom.predicate not in task.derived:
            fluent.setdefault(atom.predicate, []).append(atom)
    holding = dict(fluent)
    for atom in sorted(task.static):
        holding.setdefault(atom.predicate, []).append(atom)
    for rule in rules:
        for undone, binding in _matches(rule.fact, {}, fluent, task):
            for outcome in rule.outcomes:
                last = () if outcome.last is None else (outcome.last,)
                for earlier, before in _all_match(last, binding, fluent, task):
                    for needed, bound in _all_match(outcome.when, before, holding, task):
                        added = frozenset(pattern.ground(bound) for pattern in outcome.add)
                        gone = frozenset(pattern.ground(bound) for pattern in outcome.delete)
                        yield Transition(
                            frozenset((undone, *needed)) - task.static,
                            added,
                            (gone | {undone}) - added,
                            frozenset(earlier),
                        )


def _matches(
    pattern: Pattern, binding: Binding, atoms: Mapping[str, Sequence[Atom]], task: Task
) -> Iterator[tuple[Atom, dict[str, str]]]:
    for atom in atoms.get(pattern.predicate, ()):
        bound = pattern.match(atom, binding, task)
        if bound is not None:
            yield atom, bound


def _all_match(
    patterns: Sequence[Pattern],
    binding: Binding,
    atoms: Mapping[str, Sequence[Atom]],
    task: Task,
) -> Iterator[tuple[tuple[Atom, ...], Binding]]:
    if not patterns:
        yield (), binding
        return
    for atom, bound in _matches(patterns[0], binding, atoms, task):
        for others, full in _all_match(patterns[1:], bound, atoms, task):
            yield (atom, *others), full
