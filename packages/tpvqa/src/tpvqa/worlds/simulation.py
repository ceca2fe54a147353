"""The true state of a simulated world, and the faults that befall it.

As in the paper's experiment: an action fails with probability 0.25, and a quarter of the failures
also undo something achieved before. The truth is kept for judging and never shown to a monitor.
"""

import operator
from collections import Counter
from collections.abc import Callable, Mapping
from enum import StrEnum
from typing import Any

from tpvqa.chance import chance
from tpvqa.pddl import Action, Atom, State, Task
from tpvqa.worlds.outcome import Failure, Outcome
from tpvqa.worlds.world_file import WorldRules

FAILURE = 0.25
DISTURBANCE = 0.25


class Redo(StrEnum):
    """What comes of an action whose effects hold already; the paper does not say."""

    FREE = "free"  # nothing happens, and nothing can fail
    RISKY = "risky"  # it fails as any action, preconditions waived, and may undo something
    REFUSED = "refused"  # nothing happens, and the skill reports that it failed


class Simulation:
    """A true state that actions change, with seeded faults.

    Args:
        task: Gives the initial state and the actions.
        rules: What disturbances can undo, and more (see `load_world_file`).
        failure: Probability that an action fails although it is possible.
        disturbance: Probability that a failure also undoes an achieved fact.
        spontaneous: Probability that an achieved fact is undone after a success.
        redo: What comes of an action whose effects hold already.
        seed: With `episode`, the action and its attempt, decides every fault.
        episode: Number of the episode under this seed.
        start: The true initial state; None for the task's.
    """

    def __init__(
        self,
        task: Task,
        rules: WorldRules | None = None,
        *,
        start: State | None = None,
        failure: float = FAILURE,
        disturbance: float = DISTURBANCE,
        spontaneous: float = 0.0,
        redo: Redo | str = Redo.FREE,
        seed: int = 0,
        episode: int = 0,
    ):
        self.task, self.rules = task, rules or WorldRules()
        self.failure, self.disturbance, self.spontaneous = failure, disturbance, spontaneous
        self.redo = Redo(redo)
        self.seed, self.episode = seed, episode
        self.start: State = task.init if start is None else start
        self.state: State = self.start
        self.attempts: Counter[str] = Counter()
        self.ended: list[Atom] = []

    def undoable(self) -> dict[Atom, list[tuple[str, State]]]:
        """The achieved facts that a disturbance could end now, with what each would lead to."""
        found = {}
        for atom in sorted(self.state - self.start):
            results = [
                result
                for rule in self.rules.undo
                for result in rule.results(atom, self.state, self.ended, self.task)
            ]
            if results:
                found[atom] = results
        return found

    def execute(self, action: Action) -> Outcome:
        """Try an action on the true state."""
        before = self.state
        attempt = self.attempts[action.pddl()]
        self.attempts[action.pddl()] += 1
        draw = chance(self.seed, self.episode, "fault", action.pddl(), attempt)
        fails, disturbs = draw.random() < self.failure, draw.random()
        achieved = self.achieved(action)
        if achieved and self.redo is not Redo.RISKY:
            failure = Failure.REFUSED if self.redo is Redo.REFUSED else None
            return Outcome(failure, None, "", before, before)
        undone, undoing = None, ""
        failure, disturbance = None, self.disturbance
        if not achieved and not self.possible(action):
            failure = Failure.PRECONDITION
        elif fails:
            failure = Failure.CHANCE
        else:
            disturbance = self.spontaneous
            if not achieved:
                self._become(self.task.apply(before, self.truly(action)))
        if disturbs < disturbance:
            undone, undoing = self._disturb(draw.random(), draw.random())
        return Outcome(failure, undone, undoing, before, self.state)

    def truly(self, action: Action) -> Action:
        """The action that the robot's skill truly is, see `Rebinding`."""
        for rebinding in self.rules.rebind:
            action = rebinding.apply(action, self.state, self.task)
        return action

    def possible(self, action: Action) -> bool:
        """Whether all preconditions of an action hold in truth."""
        return self.task.applicable(self.state, self.truly(action))

    def achieved(self, action: Action) -> bool:
        """Whether all effects of an action hold already, so that it has nothing left to do."""
        return self.task.apply(self.state, action) == self.state

    def _become(self, after: State) -> None:
        self.ended += sorted(self.state - after)
        self.state = after

    def _disturb(self, which: float, how: float) -> tuple[Atom | None, str]:
        undoable = self.undoable()
        if not undoable:
            return None, ""
        atom = list(undoable)[int(which * len(undoable))]
        say, after = undoable[atom][int(how * len(undoable[atom]))]
        self._become(after)
        return atom, say

    def snapshot(self) -> dict[str, Any]:
        """The whole state as plain JSON values."""
        return {
            "state": [atom.pddl() for atom in sorted(self.state)],
            "attempts": dict(self.attempts),
            "ended": [atom.pddl() for atom in self.ended],
        }

    def restore(self, snapshot: Mapping[str, Any]) -> None:
        """Put back what `snapshot` gave.

        Raises:
            PDDLError: Its facts are not of the task.
            ValueError: It is another damaged snapshot, as are a KeyError and a TypeError.
        """
        state = frozenset(map(Atom.parse, snapshot["state"]))
        ended = list(map(Atom.parse, snapshot["ended"]))
        attempts = {str(name): operator.index(n) for name, n in snapshot["attempts"].items()}
        self.task.check_state(state | {*ended})
        self.state, self.attempts, self.ended = state, Counter(attempts), ended


class SimulatedTruth:
    """The truth of a simulation: a `TruthSource` for judges and noise models.

    Args:
        simulation: Where the true state lies.
        visible: Tells whether the last observation shows a fact; by default all are shown.
    """

    def __init__(self, simulation: Simulation, visible: Callable[[Atom], bool] | None = None):
        self._simulation = simulation
        self._visible = visible

    @property
    def state(self) -> State:
        """The true state, derived atoms included."""
        return self._simulation.task.extend(self._simulation.state)

    def holds(self, atom: Atom) -> bool:
        """Whether a fact is true now."""
        return atom in self.state

    def visible(self, atom: Atom) -> bool:
        """Whether the last observation shows if it is true."""
        return True if self._visible is None else self._visible(atom)

    def possible(self, action: Action) -> bool:
        """Whether all preconditions of an action hold now."""
        return self._simulation.possible(action)

    def successful(self, action: Action) -> bool:
        """Whether all effects of an action hold now."""
        return self._simulation.achieved(action)
