"""The true state of a simulated world, and the faults that befall it.

As in the paper's experiment: an action fails with probability 0.25, and a quarter of the failures
also undo something achieved before. The truth is kept for judging and never shown to a monitor.
"""

import operator
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from enum import StrEnum
from random import Random
from typing import Any

from tpvqa.chance import chance
from tpvqa.observation import SensedFact
from tpvqa.pddl import Action, Atom, State, Task
from tpvqa.pddl.achieved import achieved
from tpvqa.pddl.atoms import holds_in
from tpvqa.worlds.dead import NOTHING_DEAD, Dead
from tpvqa.worlds.earlier_truth import EarlierTruth, fingerprint
from tpvqa.worlds.numbers import drifted, readings
from tpvqa.worlds.outcome import Failure, Outcome
from tpvqa.worlds.people import somebody_moves
from tpvqa.worlds.running import RunningActions
from tpvqa.worlds.sensing import Sensors
from tpvqa.worlds.shown import shown
from tpvqa.worlds.undo import Undoing
from tpvqa.worlds.world_file import WorldRules

FAILURE = 0.25
DISTURBANCE = 0.25
LEAST_TIME = 1e-6
"""Seconds: whatever has less is late."""

BY_SOMEBODY = "somebody moves the "
"""How what people do is told."""


class Redo(StrEnum):
    """What comes of an action whose effects hold already; the paper does not say."""

    FREE = "free"  # nothing happens, and nothing can fail
    RISKY = "risky"  # it fails as any action, preconditions waived, and may undo something
    REFUSED = "refused"  # nothing happens, and the skill reports that it failed


class Simulation:
    """A true state that actions change, with seeded faults.

    Args:
        task: Gives the initial state and the actions.
        rules: What disturbances can undo, what is sensed, and more (see `load_world_file`).
        failure: Probability that an action fails although it is possible.
        disturbance: Probability that a failure also undoes an achieved fact.
        spontaneous: Probability that an achieved fact is undone after a success.
        moved: Probability that somebody moves a thing after an action that disturbed nothing.
        interruption: Probability that what an action needs while it runs is undone meanwhile.
        redo: What comes of an action whose effects hold already.
        dead: Skills that never work.
        undoing: What disturbances undo; by default what the rules say.
        start: The true state at first; by default the task's.
        seed: With `episode`, the action and its attempt, decides every fault.
        episode: Number of the episode under this seed.
    """

    def __init__(
        self,
        task: Task,
        rules: WorldRules | None = None,
        *,
        failure: float = FAILURE,
        disturbance: float = DISTURBANCE,
        spontaneous: float = 0.0,
        moved: float = 0.0,
        interruption: float = 0.0,
        redo: Redo | str = Redo.FREE,
        dead: Dead = NOTHING_DEAD,
        undoing: Sequence[Undoing] | None = None,
        start: State | None = None,
        seed: int = 0,
        episode: int = 0,
    ):
        self.task, self.rules = task, rules or WorldRules()
        self.failure, self.disturbance, self.spontaneous = failure, disturbance, spontaneous
        self.moved = moved
        self.redo, self.dead = Redo(redo), dead
        self.undoing: Sequence[Undoing] = self.rules.undo if undoing is None else undoing
        self.start = task.init if start is None else start
        self.seed, self.episode = seed, episode
        self.state: State = self.start
        self.before: State = self.start
        self.attempts: Counter[str] = Counter()
        self.ended: list[Atom] = []
        self._sensors = Sensors(self.rules.sensed, task)
        self.running: RunningActions | None = None
        if task.lasting is not None:
            self.running = RunningActions(self, task.lasting, interruption)

    def undoable(self) -> dict[Atom, list[tuple[str, State]]]:
        """The achieved facts that a disturbance could end now, with what each would lead to."""
        found = {}
        lasting = self.task.lasting
        running = frozenset[str]() if lasting is None else lasting.predicates
        for atom in sorted(self.state - self.start):
            if atom.predicate in running:  # what runs stops as it lacks what it needs
                continue
            results = [
                result
                for rule in self.undoing
                for result in rule.results(atom, self.state, self.ended, self.task)
            ]
            if results:
                found[atom] = results
        return found

    def execute(self, action: Action) -> Outcome:
        """Try an action on the true state, and tell what skill and sensors notice."""
        self.before = self.state
        attempt, truly = self.attempts[action.pddl()], self.truly(action)
        still = None if self.running is None else self.running.without_moving(action)
        outcome = self._tried(action) if still is None else still
        if self.running is not None:
            outcome = self.running.executed(action, attempt, outcome)
        if self.moved and outcome.undone is None:
            outcome = self._among_people(outcome, action, attempt)
        if self.rules.numbers:
            outcome = self._drifting(outcome, action, attempt)
        if not (self.rules.sensed or self.rules.reports):
            return outcome
        report = next((r for r in self.rules.reports if r.action in (None, action.name)), None)
        reported = report is not None and report.reports(
            failed=not outcome.succeeded,
            impossible=outcome.failure is Failure.PRECONDITION,
            draw=chance(self.seed, self.episode, "report", action.pddl(), attempt),
        )
        true = self.task.extend(self.state)
        sensed = self._sensors.after((action, truly), true, self._draw_for)
        return replace(outcome, reported=reported, sensed=(*outcome.sensed, *sensed))

    def sensed(self) -> tuple[SensedFact, ...]:
        """What the robot's own sensors tell at a look."""
        measured = readings(self.rules.numbers, self.state)
        if not self.rules.sensed:
            return measured
        return measured + self._sensors.at_look(self.task.extend(self.state), self._draw_for)

    def senses(self) -> frozenset[str]:
        """The predicates that are sensed."""
        return self._sensors.predicates()

    def _draw_for(self, atom: Atom) -> Random:
        """A reading stays what it is until something is done: its error is not drawn again."""
        done = self.attempts.total()
        return chance(self.seed, self.episode, "sensed", atom.pddl(), done)

    def wait(self, until: float | None) -> Outcome | None:
        """Let time pass while actions run; what came of it, None for nothing."""
        outcome = None if self.running is None else self.running.wait(until)
        if outcome is not None:
            self.before = outcome.before
        return outcome

    def _tried(self, action: Action) -> Outcome:
        before = self.state
        attempt = self.attempts[action.pddl()]
        self.attempts[action.pddl()] += 1
        draw = chance(self.seed, self.episode, "fault", action.pddl(), attempt)
        fails, disturbs = draw.random() < self.failure, draw.random()
        achieved = self.achieved(action)
        if achieved and self.redo is not Redo.RISKY:
            failure = Failure.REFUSED if self.redo is Redo.REFUSED else None
            return Outcome(failure, None, "", before, before)
        if self.dead.holds(action):
            return Outcome(Failure.DEAD, None, "", before, before)
        undone, undoing = None, ""
        failure, disturbance = None, self.disturbance
        if not achieved and not self.possible(action):
            failure = Failure.PRECONDITION
        elif fails:
            failure = Failure.CHANCE
        else:
            disturbance = self.spontaneous
            if not achieved:
                self.become(self.task.apply(before, self.truly(action)))
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
        return achieved(self.task, self.state, action)

    def _among_people(self, outcome: Outcome, action: Action, attempt: int) -> Outcome:
        draw = chance(self.seed, self.episode, "moved", action.pddl(), attempt)
        if draw.random() >= self.moved:
            return outcome
        found = somebody_moves(self.task, self.state, draw)
        if found is None:
            return outcome
        gone, after = found
        self.become(after)
        return replace(
            outcome, undone=gone, undoing=f"{BY_SOMEBODY}{gone.arguments[0]}", after=after
        )

    def _drifting(self, outcome: Outcome, action: Action, attempt: int) -> Outcome:
        draw = chance(self.seed, self.episode, "drift", action.pddl(), attempt)
        found = drifted(self.rules.numbers, self.state, draw)
        if found is not None:
            was, say, after = found
            self.become(after)
            said = "; ".join(filter(None, (outcome.undoing, say)))
            outcome = replace(outcome, undone=outcome.undone or was, undoing=said, after=after)
        sensed = readings(self.rules.numbers, self.state)
        return replace(outcome, sensed=(*outcome.sensed, *sensed))

    def become(self, after: State) -> None:
        """Change the true state."""
        self.ended += sorted(self.state - after)
        self.state = after

    def _disturb(self, which: float, how: float) -> tuple[Atom | None, str]:
        undoable = self.undoable()
        if not undoable:
            return None, ""
        atom = list(undoable)[int(which * len(undoable))]
        say, after = undoable[atom][int(how * len(undoable[atom]))]
        self.become(after)
        return atom, say

    def snapshot(self) -> dict[str, Any]:
        """The whole state as plain JSON values."""
        return {
            "state": [atom.pddl() for atom in sorted(self.state)],
            "attempts": dict(self.attempts),
            "ended": [atom.pddl() for atom in self.ended],
            "changed": [atom.pddl() for atom in sorted(self.state ^ self.before)],
            **({} if self.running is None else {"running": self.running.snapshot()}),
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
        changed = frozenset(map(Atom.parse, snapshot.get("changed", ())))  # none in older logs
        self.task.check_state(state | {*ended} | changed)
        if self.running is not None:
            self.running.restore(snapshot["running"])
        self.state, self.attempts, self.ended = state, Counter(attempts), ended
        self.before = state ^ changed


class SimulatedTruth:
    """The truth of a simulation: a `TruthSource` for judges and noise models.

    Args:
        simulation: Where the true state lies.
        visible: Tells whether the last observation shows a fact; by default what the world file
            says, and all else, is shown.
    """

    def __init__(self, simulation: Simulation, visible: Callable[[Atom], bool] | None = None):
        self._simulation = simulation
        self._visible = visible
        self._scene: tuple[State, str] | None = None

    @property
    def state(self) -> State:
        """The true state, derived atoms included."""
        return self._simulation.task.extend(self._simulation.state)

    def holds(self, atom: Atom) -> bool:
        """Whether a fact is true now."""
        return holds_in(atom, self.state)

    def visible(self, atom: Atom) -> bool:
        """Whether the last observation shows if it is true."""
        if self._visible is not None:
            return self._visible(atom)
        here = self._simulation
        return not here.rules.shown or shown(here.rules.shown, atom, self.state, here.task)

    def possible(self, action: Action) -> bool:
        """Whether all preconditions of an action hold now."""
        return self._simulation.possible(action)

    def successful(self, action: Action) -> bool:
        """Whether all effects of an action hold now."""
        return self._simulation.achieved(action)

    def scene(self) -> str:
        """A fingerprint of the true state."""
        state = self._simulation.state
        if self._scene is None or self._scene[0] != state:
            self._scene = state, fingerprint(state)
        return self._scene[1]

    def earlier(self) -> "EarlierTruth":
        """What was true before the last action; at first what is true now."""
        return EarlierTruth(self._simulation.task, self._simulation.before, self.visible)
