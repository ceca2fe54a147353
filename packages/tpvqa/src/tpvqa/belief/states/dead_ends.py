"""States that surely no plan leads on from."""

from collections.abc import Iterable
from functools import cached_property, lru_cache

from tpvqa.belief.states.relaxation import Needs, Relaxation, Way, literals_of
from tpvqa.pddl import Atom, Condition, Conjunction, Disjunction, State, Task, literals

KEPT = 4_000
"""States of which it is kept."""


class DeadEnds:
    """Tells from where a task's goal is out of reach even if nothing were ever undone.

    That is the delete relaxation (Bonet and Geffner 2001), a literal and its contrary each by
    itself: the goal may be out of reach where it says nothing. What is derived is reached where
    what it follows from is; that a derived fact does not hold is taken to be so, and so is what is
    no conjunction. Nothing is told of large tasks of which a part was left out, of numbers and
    time, nor of states with facts that no action brings about, or without some that none ends:
    what they allow was not grounded.

    Args:
        task: Gives actions and goal.
    """

    def __init__(self, task: Task):
        self._task = task
        self._bits: dict[Atom | Disjunction, int] = {}
        self._unruled: list[Atom | Disjunction] = []
        self._known: dict[tuple[State, State], bool] = {}
        self._trues: dict[State, int | None] = {}
        plain = not task.left_out and task.numeric is None and task.lasting is None
        self._fluents = task.fluents - task.derived
        self._goal = self._needs([task.goal]) if plain else None

    def holds(
        self, state: State, before: State = frozenset(), *, alive: State | None = None
    ) -> bool:
        """Whether a state is one.

        Args:
            state: The state.
            before: From where something led there; of that it is not asked whether it is one. Where
                all that went can come back at once, and all that came can go, nothing is worse.
            alive: A state that surely is none, to be quick by: what can be brought about again of
                what differs from it need not be gone through.
        """
        if self._goal is None:
            return False
        found = self._known.get((state, before))
        if found is None:
            if len(self._known) >= KEPT:
                self._known.clear()
            found = self._known[state, before] = self._found(self._goal, state, before, alive)
        return found

    def _found(self, goal: Needs, state: State, before: State, alive: State | None) -> bool:
        was = self._true(before) if before else None
        true = self._true(state, before)
        if true is None:
            return False  # of what nothing brings about, or ends, the actions are not known
        if before:
            missing = self._numbered(before - state), self._numbered(state - before)
            if self._mended(missing, self._with_what_follows(true)):
                return False
            if was is not None and not self.holds(before):
                alive = before
        there = None if alive is None else self._true(alive)
        if there is not None and self._relaxation.proves(true, (there & ~true, true & ~there)):
            return False
        return not self._relaxation.reaches(true, goal)

    def _true(self, state: State, before: State = frozenset()) -> int | None:
        """The fluents of a state, as bits; None where not all actions are known that may matter.

        Args:
            state: The state.
            before: One that is known, and much like it.
        """
        if state in self._trues:
            return self._trues[state]
        if len(self._trues) >= KEPT:
            self._trues.clear()
        was, found = self._trues.get(before), None
        if was is None:
            if self._always <= state <= self._possible:
                found = self._numbered(each for each in state if each.predicate in self._fluents)
        else:
            came, went = state - before, before - state
            if came <= self._possible and went.isdisjoint(self._always):
                found = was & ~self._numbered(went) | self._numbered(came)
        self._trues[state] = found
        return found

    @cached_property
    def _always(self) -> State:
        changing = self._task.fluents | self._task.derived
        return frozenset(each for each in self._task.init if each.predicate not in changing)

    @cached_property
    def _possible(self) -> State:
        return self._task.reachable_atoms | self._task.init

    @cached_property
    def _relaxation(self) -> Relaxation:
        return Relaxation([*self._rules, *self._changes])

    def _mended(self, missing: Needs, true: int) -> bool:
        return all(self._relaxation.at_once(true, each) for each in literals_of(missing))

    @cached_property
    def _changes(self) -> list[Way]:
        """What each action needs for some of its effects, what it makes true and what false."""
        found: dict[Needs, tuple[int, int]] = {}
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

    @cached_property
    def _rules(self) -> list[Way]:
        """What the derived facts that are asked for follow from, and their parts."""
        found: list[Way] = []
        bodies: dict[Atom, list[Condition]] = {}
        _ = self._changes  # what they need is asked for, too
        if self._unruled and self._task.axioms:
            for rule in self._task.derivation(self._task.init).rules:
                bodies.setdefault(rule.head, []).append(rule.condition)
        while self._unruled:
            each = self._unruled.pop()
            parts = each.parts if isinstance(each, Disjunction) else bodies.get(each, ())
            found += [(self._needs([part], derived=True), self._bits[each], 0) for part in parts]
        return found

    def _needs(self, conditions: Iterable[Condition], *, derived: bool = False) -> Needs:
        """The literals of conjunctions of what actions change, and what follows, as bits."""
        parts, need, bar = list(conditions), 0, 0
        while parts:
            part = parts.pop()
            if isinstance(part, Conjunction):
                parts += part.parts
            elif isinstance(part, Disjunction):
                need |= self._followed(part) if derived else 0
            elif part.atom.predicate in self._fluents:
                bit = self._numbered([part.atom])
                need, bar = (need | bit, bar) if part.positive else (need, bar | bit)
            elif part.positive and part.atom.predicate in self._task.derived:
                need |= self._followed(part.atom)
        return need, bar

    def _followed(self, what: Atom | Disjunction) -> int:
        if what not in self._bits:
            self._unruled.append(what)
        return self._numbered([what])

    def _with_what_follows(self, true: int) -> int:
        before = -1
        while before != true:
            before = true
            for (need, bar), add, _ in self._rules:
                if not (need & ~true or bar & true):
                    true |= add
        return true

    def _numbered(self, atoms: Iterable[Atom | Disjunction]) -> int:
        """Facts as bits of a number, one for each fact that was ever asked for."""
        found = 0
        for atom in atoms:
            found |= self._bits.setdefault(atom, 1 << len(self._bits))
        return found


def dead_ends_of(task: Task) -> DeadEnds:
    """Those of a task, the same object for the world and the belief, and in the trials of a bench.

    Args:
        task: One that differs in what may hold besides, or in its goal, is equal and has others.
    """
    return _kept(task, task.besides, task.goal)


@lru_cache(maxsize=4)
def _kept(task: Task, besides: State, goal: Condition) -> DeadEnds:
    return DeadEnds(task)
