"""States that surely no plan leads on from."""

from collections.abc import Iterable
from functools import cached_property

from tpvqa.pddl import Atom, Condition, Conjunction, Literal, State, Task, literals

KEPT = 20_000
"""States of which it is kept."""
_Needs = tuple[int, int]
"""What has to hold and what must not, as bits."""


class DeadEnds:
    """Tells from where a task's goal is out of reach even if nothing were ever undone.

    That is the delete relaxation (Bonet and Geffner 2001), a literal and its contrary each by
    itself: the goal may be out of reach where it says nothing. What is no conjunction is taken to
    hold. Nothing is told of large tasks of which a part was left out, nor of numbers and time.

    Args:
        task: Gives actions and goal.
    """

    def __init__(self, task: Task):
        self._task = task
        self._bits: dict[Atom, int] = {}
        self._known: dict[State, bool] = {}
        plain = not task.left_out and task.numeric is None and task.lasting is None
        self._fluents = task.fluents - task.derived
        self._goal = self._needs([task.goal]) if plain else None

    def holds(self, state: State) -> bool:
        """Whether a state is one."""
        if self._goal is None:
            return False
        found = self._known.get(state)
        if found is None:
            if len(self._known) >= KEPT:
                self._known.clear()
            found = self._known[state] = not self._reaches(state, self._goal)
        return found

    @cached_property
    def _changes(self) -> list[tuple[_Needs, int, int]]:
        """What each action needs for some of its effects, what it makes true and what false."""
        found: dict[_Needs, tuple[int, int]] = {}
        for action in self._task.ground_actions():
            needs = self._needs([action.precondition])
            for effect in action.effects:
                own = needs
                if literals(effect.condition):
                    own = self._needs([action.precondition, effect.condition])
                add, delete = found.get(own, (0, 0))
                bit = self._numbered([effect.literal.atom])
                positive = effect.literal.positive
                found[own] = (add | bit, delete) if positive else (add, delete | bit)
        return [(needs, *made) for needs, made in found.items()]

    def _needs(self, conditions: Iterable[Condition]) -> _Needs:
        """The literals of conjunctions of what actions change, as bits."""
        parts, told = list(conditions), list[Literal]()
        while parts:
            part = parts.pop()
            if isinstance(part, Conjunction):
                parts += part.parts
            elif isinstance(part, Literal) and part.atom.predicate in self._fluents:
                told.append(part)
        need, bar = (
            self._numbered(each.atom for each in told if each.positive == positive)
            for positive in (True, False)
        )
        return need, bar

    def _reaches(self, state: State, goal: _Needs) -> bool:
        waiting = self._changes
        true = self._numbered(atom for atom in state if atom.predicate in self._fluents)
        false, before = ~true, (-1, -1)
        while goal[0] & ~true or goal[1] & ~false:
            if before == (true, false):
                return False
            before, left = (true, false), []
            for each in waiting:
                (need, bar), add, delete = each
                if need & ~true or bar & ~false:
                    left.append(each)
                else:
                    true, false = true | add, false | delete
            waiting = left
        return True

    def _numbered(self, atoms: Iterable[Atom]) -> int:
        """Facts as bits of a number, one for each fact that was ever asked for."""
        found = 0
        for atom in atoms:
            found |= self._bits.setdefault(atom, 1 << len(self._bits))
        return found
