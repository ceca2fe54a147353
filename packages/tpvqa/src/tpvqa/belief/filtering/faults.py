"""What an action can lead to: the action model with failures and disturbances."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from hashlib import blake2b
from itertools import groupby
from operator import itemgetter
from typing import Protocol, TypeVar

import numpy as np

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.states.compiled import Compiled, compiled, met
from tpvqa.belief.states.memory import Past, Undoing, memory_of
from tpvqa.belief.states.packed import Bytes, Packed, held
from tpvqa.belief.states.rebinding import Rebinding
from tpvqa.pddl import Action, Atom, State, Task

_Found = TypeVar("_Found")


class Showing(Protocol):
    """Says from where a form of fact is shown."""

    def needed(self, atom: Atom, task: Task) -> frozenset[Atom] | None:
        """What has to hold so that a fact is shown; None where it has not this form."""


class FaultRules(Protocol):
    """How a domain misbehaves, as its world file says."""

    @property
    def undo(self) -> Sequence[Undoing]:
        """What disturbances can undo."""

    @property
    def rebind(self) -> Sequence[Rebinding]:
        """Arguments that skills do not take."""

    @property
    def shown(self) -> Sequence[Showing]:
        """What a camera shows only from certain places."""


@dataclass(frozen=True, slots=True)
class Rates:
    """Probabilities of faults.

    Attributes:
        failure: That a possible action fails.
        disturbance: That a failure also undoes something achieved.
        spontaneous: That something achieved is undone after a success.
        redone: That doing again what is done undoes something achieved.
        in_vain: That an action undoes something whose preconditions do not hold; None for as
            often as a failure does.
    """

    failure: float = 0.25
    disturbance: float = 0.25
    spontaneous: float = 0.01
    redone: float = 0.001
    in_vain: float | None = None

    @property
    def impossible(self) -> float:
        """How often an action undoes something whose preconditions do not hold."""
        return self.disturbance if self.in_vain is None else self.in_vain

    @property
    def undone(self) -> float:
        """How often an action undoes something achieved."""
        return self.failure * self.disturbance + (1 - self.failure) * self.spontaneous


@dataclass(frozen=True, slots=True)
class JointState:
    """What may be the case, with what it takes to say how faults would undo it.

    It goes by its number, which a `FaultModel` gives it.

    Attributes:
        state: The atoms that hold.
        past: What is remembered of facts that ended, to which a disturbance could lead back.
    """

    state: State
    past: Past = ()


@dataclass(frozen=True, slots=True)
class Outcomes:
    """What an action can lead to from one joint state, by number.

    Attributes:
        number: That state.
        intended: What its effects say; None where a precondition does not hold.
        achieved: Whether nothing is left to do, so that nothing can fail.
    """

    number: int
    intended: int | None
    achieved: bool


class _Met(dict[int, _Found]):
    """Something about joint states, by number; worked out as they are met."""

    def __init__(self, work_out: Callable[[int], _Found]):
        super().__init__()
        self._work_out = work_out

    def __missing__(self, number: int) -> _Found:
        found = self[number] = self._work_out(number)
        return found


class FaultModel:
    """The transitions of a task, worked out once for every joint state that is met.

    It is a pure function of the task and its rules: trials one after the other can share it, but
    not trials in several threads.

    Args:
        task: Gives the actions and the initial state.
        rules: What the world file says about faults; without one a disturbance puts a fact back
            to what held before it, or seldom loses a thing.

    Attributes:
        rebind: Arguments that skills do not take.
    """

    def __init__(self, task: Task, rules: FaultRules | None = None):
        from tpvqa.belief.states.surprise import Surprise  # late: its needs take a while

        self.task = task
        self.surprise = Surprise(task, rules.undo if rules is not None else ())
        self._memory = memory_of(task, () if rules is None else rules.undo)
        self.rebind: Sequence[Rebinding] = () if rules is None else rules.rebind
        self._begun: State = task.init
        self._clear()

    def renewed(self) -> "FaultModel":
        """The same without the joint states that were met."""
        new = FaultModel.__new__(FaultModel)
        new.__dict__.update(self.__dict__)
        new._clear()
        return new

    def _clear(self) -> None:
        self.joint_states: list[JointState] = []
        self._keys: dict[int, bytes] = {}
        self._bits: dict[Atom, int] = {}
        self._holding: dict[int, int] = {}
        self._packed = Packed(self.holding)
        self._kinds: list[int] = []
        self._kind_of: dict[State, int] = {}
        self._states: list[State] = []
        self._firsts: list[int] = []
        self._compiled: dict[Action, Compiled | None] = {}
        self._words: dict[object, str] = {}
        self._said_of: dict[int, str] = {}
        self._goal = met(self.task.goal, self.task, self.bits)
        self.facts = 0
        self._numbers: dict[JointState, int] = {}
        self._outcomes: dict[Action, Mapping[int, Outcomes]] = {}
        self._truths: dict[tuple[Atom, ...], Mapping[int, bool]] = {}
        self._bound: dict[tuple[Action, State], Action] = {}
        self._undone: dict[int, tuple[tuple[float, int], ...]] = {}

    def begin(self, state: State) -> None:
        """Note what is so where a trial begins: a disturbance undoes only what was not so then."""
        if state != self._begun:
            self._begun = state
            self._undone.clear()
            self._outcomes.clear()

    def number(self, joint_state: JointState) -> int:
        """The number of a joint state, the same for equal ones."""
        number = self._numbers.get(joint_state)
        if number is None:
            number = len(self.joint_states)
            kind = self._kind_of.get(joint_state.state)
            if kind is None:
                kind = self._kind_of[joint_state.state] = len(self._states)
                self._states.append(joint_state.state)
                self._firsts.append(number)
                self.facts += len(joint_state.state)
            else:  # one set of atoms for all of them
                joint_state = JointState(self._states[kind], joint_state.past)
            self._numbers[joint_state] = number
            self.joint_states.append(joint_state)
            self._kinds.append(kind)
        return number

    def kind(self, number: int) -> int:
        """The number of the atoms that hold in a joint state, the same for equal ones."""
        return self._kinds[number]

    def ranked(self, weights: Mapping[int, float]) -> list[tuple[int, float]]:
        """Joint states by their weight, the greatest first, the same in every process."""
        found = sorted(weights.items(), key=itemgetter(1), reverse=True)
        for _, ties in groupby(range(len(found)), key=lambda place: found[place][1]):
            places = list(ties)
            if len(places) > 1:
                first, last = places[0], places[-1] + 1
                found[first:last] = sorted(found[first:last], key=lambda each: self._key(each[0]))
        return found

    def _key(self, number: int) -> bytes:
        known = self._keys.get(number)
        if known is None:
            kind, past = self._kinds[number], self.joint_states[number].past
            if kind not in self._said_of:
                self._said_of[kind] = repr(sorted(map(self._said, self._states[kind])))
            words = f"({self._said_of[kind]}, {list(map(self._said, past))!r})"
            known = self._keys[number] = blake2b(words.encode(), digest_size=8).digest()
        return known

    def _said(self, part: object) -> str:
        known = self._words.get(part)
        if known is None:
            known = self._words[part] = str(part)
        return known

    def state(self, number: int) -> State:
        """The atoms that hold in a joint state."""
        return self.joint_states[number].state

    def bits(self, atoms: Iterable[Atom]) -> int:
        """Facts as bits of a number, one for each fact that was ever asked for."""
        known, found = self._bits, 0
        for atom in atoms:
            bit = known.get(atom)
            if bit is None:
                bit = known[atom] = 1 << len(known)
            found |= bit
        return found

    def holding(self, number: int) -> int:
        """What holds in a joint state, as `bits`; derived facts too, static ones not."""
        known = self._holding.get(number)
        if known is None:
            full = self.task.extend(self.state(number)) - self.task.static
            known = self._holding[number] = self.bits(full)
        return known

    def goal_holds(self, number: int) -> bool:
        """Whether the goal holds in a joint state."""
        if self._goal is None:
            return self.task.goal_holds(self.state(number))
        return self.goal_within(self.holding(number))

    def goal_within(self, holding: int) -> bool:
        """Whether the goal holds where some facts do, as bits; it is a conjunction of such."""
        assert self._goal is not None
        needed, barred = self._goal
        return not (needed & ~holding or barred & holding)

    def first(self, number: int) -> int:
        """The first joint state that was met in which the same facts hold."""
        return self._firsts[self._kinds[number]]

    def truth(self, atoms: tuple[Atom, ...]) -> Mapping[int, bool]:
        """In which joint states any of some facts holds, by number."""
        found = self._truths.get(atoms)
        if found is None:
            any_of = frozenset(atoms)
            found = _Met(lambda number: not any_of.isdisjoint(self.state(number)))
            self._truths[atoms] = found
        return found

    def truths(self, facts: Sequence[tuple[Atom, ...]], numbers: Sequence[int]) -> Floats:
        """Where any of some facts holds: ones and zeros, shape (facts, joint states)."""
        rows = self.rows(numbers)
        bits = np.array([self.bit(atoms[0]) for atoms in facts], np.intp)
        found = held(rows, bits).T.astype(float)
        for place, atoms in enumerate(facts):
            if not self.packs(atoms):
                truth = self.truth(atoms)
                found[place] = [truth[number] for number in numbers]
            elif len(atoms) > 1:
                places = np.array([self.bit(atom) for atom in atoms])
                found[place] = held(rows, places).any(axis=1)
        return found

    def rows(self, numbers: Sequence[int]) -> Bytes:
        """What holds in joint states, as rows of bits."""
        return self._packed.rows(np.array(numbers, np.intp))

    def packs(self, atoms: Iterable[Atom]) -> bool:
        """Whether rows of bits tell all of some facts: they do what actions change."""
        fluents = self.task.fluents
        return all(atom.predicate in fluents for atom in atoms)

    def bit(self, atom: Atom) -> int:
        """The place of a fact's bit."""
        known = self._bits.get(atom)
        return (self.bits((atom,)) if known is None else known).bit_length() - 1

    def outcomes(self, action: Action) -> Mapping[int, Outcomes]:
        """What an action can lead to, by the number of the joint state."""
        found = self._outcomes.get(action)
        if found is None:
            found = self._outcomes[action] = _Met(partial(self._work_out, action))
        return found

    def masks(self, actions: Iterable[Action]) -> list[Compiled] | None:
        """Actions as masks; None where these do not tell all of the actions and of the goal."""
        if self.rebind or self.task.derived or self._goal is None:
            return None
        found = [self._masks(action) for action in actions]
        told = [each for each in found if each is not None]
        return told if len(told) == len(found) else None

    def _work_out(self, action: Action, number: int) -> Outcomes:
        state = self.state(number)
        if not self.rebind:
            masks = self._masks(action)
            if masks is not None:
                holding = self.holding(number)
                if masks.achieved(holding):
                    return Outcomes(number, number, True)
                if not masks.possible(holding, state):
                    return Outcomes(number, None, False)
                there = self._changed(number, masks.deleted & state, masks.added - state)
                return Outcomes(number, there, False)
        if self.task.apply(state, action) == state:
            return Outcomes(number, number, True)
        truly = self._truly(action, state)
        if not self.task.applicable(state, truly):
            return Outcomes(number, None, False)
        intended = self.become(number, self.task.apply(state, truly))
        return Outcomes(number, intended, False)

    def _masks(self, action: Action) -> Compiled | None:
        if action not in self._compiled:
            self._compiled[action] = compiled(action, self.task, self.bits)
        return self._compiled[action]

    def applicable(self, action: Action, state: State) -> bool:
        """Whether the preconditions of what an action truly is hold."""
        return self.task.applicable(state, self._truly(action, state))

    def same_skill(self, action: Action, other: Action, state: State) -> bool:
        """Whether two actions make the robot do the same: they differ only in what holds anyway."""
        if action == other:
            return True
        if action.name != other.name:
            return False
        return self._truly(action, state) == self._truly(other, state)

    def _truly(self, action: Action, state: State) -> Action:
        """What an action is where skills do not take all its arguments."""
        if not self.rebind:
            return action
        found = self._bound.get((action, state))
        if found is None:
            found = action
            for rebinding in self.rebind:
                found = rebinding.apply(found, state, self.task)
            self._bound[action, state] = found
        return found

    def become(self, number: int, after: State) -> int:
        """The joint state after a change of its atoms."""
        before = self.state(number)
        return self._changed(number, before - after, after - before)

    def _changed(self, number: int, gone: State, come: State) -> int:
        before = self.joint_states[number]
        past = self._memory.after(before.past, gone, come, self._begun)
        there = self.number(JointState(before.state - gone | come, past))
        if there not in self._holding and not self.task.derived:
            self._holding[there] = self.holding(number) ^ self.bits(gone | come)
        return there

    def undone(self, number: int) -> tuple[tuple[float, int], ...]:
        """What a disturbance leads to: an achieved fact is undone, each as probable."""
        found = self._undone.get(number)
        if found is None:
            joint_state, results = self.joint_states[number], []
            for atom in sorted(joint_state.state - self._begun):
                states = self._memory.undone(atom, joint_state.state, joint_state.past)
                if states:
                    results.append([(each, self.become(number, after)) for each, after in states])
            shares: dict[int, float] = {}
            for outcomes in results:
                for share, outcome in outcomes:
                    shares[outcome] = shares.get(outcome, 0.0) + share / len(results)
            found = tuple((share, outcome) for outcome, share in shares.items())
            self._undone[number] = found
        return found
