"""What runs in a simulated world, its clock, and what befalls it meanwhile."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from tpvqa.chance import chance
from tpvqa.pddl import Action, Atom, State, Task, holds, literals
from tpvqa.pddl.lasting import Lasting, Phase
from tpvqa.worlds.outcome import Failure, Outcome
from tpvqa.worlds.undo import Undoing

_SLACK = 1e-3
"""So much before its time an action may be ended, as times are rounded."""


class TrueState(Protocol):
    """A simulation, as far as it is needed here; see `Simulation`."""

    task: Task
    state: State
    ended: list[Atom]
    undoing: Sequence[Undoing]
    seed: int
    episode: int

    def become(self, after: State) -> None:
        """Change the true state."""


@dataclass(slots=True)
class _Run:
    """An action under way.

    Attributes:
        began: When it began.
        breaks: When something that it needs is undone; None where that does not happen.
        draws: Which fact, and how.
    """

    began: float
    breaks: float | None = None
    draws: tuple[float, float] = (0.0, 0.0)


class RunningActions:
    """The actions that run in a simulation.

    With the probability `interruption` a fact that an action needs while it runs is undone once,
    at a moment drawn from its time, as the world file says. Whatever undoes such a fact, the
    action stops then: it is as if it were cancelled.

    Args:
        simulation: Where the true state lies.
        lasting: The task's durative actions.
        interruption: That probability.
    """

    def __init__(self, simulation: TrueState, lasting: Lasting, interruption: float):
        self._simulation, self._lasting = simulation, lasting
        self.interruption = interruption
        self.clock = 0.0
        self._runs: dict[Action, _Run] = {}
        task, state = simulation.task, simulation.state
        for action in lasting.under_way(task, state):
            self._runs[action] = _Run(0.0)

    def without_moving(self, action: Action) -> Outcome | None:
        """What comes of a look, and of ending or stopping what does not run, or not yet so long:
        nothing moves. None for all else."""
        phase = self._lasting.phase_of(action.name)
        if phase in (None, Phase.START):
            return None
        state, run = self._simulation.state, self._runs.get(self._start_of(action))
        if phase is Phase.WHILE or (phase is Phase.CANCEL and run is None):
            return Outcome(None, None, "", state, state)
        least = self._lasting.duration(action)[0]
        if phase is Phase.END and (run is None or self.clock < run.began + least - _SLACK):
            return Outcome(Failure.PRECONDITION, None, "", state, state)
        return None

    def executed(self, action: Action, attempt: int, outcome: Outcome) -> Outcome:
        """Follow what was done: what begins runs, and what it broke stops."""
        phase = self._lasting.phase_of(action.name)
        under_way = set(self._lasting.under_way(self._simulation.task, self._simulation.state))
        if phase is Phase.START and action in under_way and action not in self._runs:
            self._runs[action] = self._drawn(action, attempt)
        for gone in [each for each in self._runs if each not in under_way]:
            del self._runs[gone]
        self._stop_broken()
        after = self._simulation.state
        if after == outcome.after:
            return outcome
        return Outcome(outcome.failure, outcome.undone, outcome.undoing, outcome.before, after)

    def wait(self, until: float | None) -> Outcome | None:
        """Let time pass; what came of it, None for nothing.

        Args:
            until: What the clock is to show.
        """
        if until is None or until <= self.clock:
            return None
        before = self._simulation.state
        undone: Atom | None = None
        said: list[str] = []
        while (found := self._next_break(until)) is not None:
            action, run = found
            assert run.breaks is not None
            self.clock, run.breaks = max(self.clock, run.breaks), None
            broken = self._broken(action, run)
            if broken is None:
                continue
            atom, say, after = broken
            self._simulation.become(after)
            self._stop_broken()
            undone = undone or atom
            said.append(say)
        self.clock = until
        if not said:
            return None
        return Outcome(None, undone, "; ".join(said), before, self._simulation.state)

    def _start_of(self, action: Action) -> Action:
        return self._lasting.part(self._simulation.task, action, Phase.START)

    def _drawn(self, action: Action, attempt: int) -> _Run:
        here = self._simulation
        draw = chance(here.seed, here.episode, "interruption", action.pddl(), attempt)
        breaks, when, which, how = (draw.random() for _ in range(4))
        if breaks >= self.interruption:
            return _Run(self.clock)
        lasts = self._lasting.duration(action)[0]
        return _Run(self.clock, self.clock + when * lasts, (which, how))

    def _next_break(self, until: float) -> tuple[Action, _Run] | None:
        due = [
            (run.breaks, action.pddl(), action, run)
            for action, run in self._runs.items()
            if run.breaks is not None and run.breaks <= until
        ]
        return min(due, key=lambda each: each[:2])[2:] if due else None

    def _broken(self, action: Action, run: _Run) -> tuple[Atom, str, State] | None:
        """What is undone of what an action needs; None where the world file undoes none of it."""
        here = self._simulation
        results = []
        for literal in literals(self._lasting.meanwhile(here.task, action)):
            atom = literal.atom
            if literal.positive and atom in here.state and atom.predicate in here.task.fluents:
                found = [
                    result
                    for rule in here.undoing
                    for result in rule.results(atom, here.state, here.ended, here.task)
                ]
                if found:
                    results.append((atom, found))
        if not results:
            return None
        atom, outcomes = results[int(run.draws[0] * len(results))]
        say, after = outcomes[int(run.draws[1] * len(outcomes))]
        return atom, say, after

    def _stop_broken(self) -> None:
        """Stop what lacks what it needs. That may take from others what they need."""
        here = self._simulation
        while True:
            true = here.task.extend(here.state)
            broken = [
                action
                for action in self._runs
                if not holds(self._lasting.meanwhile(here.task, action), true)
            ]
            if not broken:
                return
            for action in broken:
                del self._runs[action]
                cancel = self._lasting.part(here.task, action, Phase.CANCEL)
                here.become(here.task.apply(here.state, cancel))

    def snapshot(self) -> dict[str, Any]:
        """Clock and runs as plain JSON values."""
        return {
            "clock": self.clock,
            "runs": [
                [action.pddl(), run.began, run.breaks, *run.draws]
                for action, run in self._runs.items()
            ],
        }

    def restore(self, snapshot: Mapping[str, Any]) -> None:
        """Put back what `snapshot` gave.

        Raises:
            PDDLError: Its actions are not of the task.
            ValueError: It is another damaged snapshot, as are a KeyError and a TypeError.
        """
        runs: dict[Action, _Run] = {}
        for said, began, breaks, which, how in snapshot["runs"]:
            words = Atom.parse(said)
            action = self._simulation.task.action(words.predicate, words.arguments)
            if self._lasting.phase_of(action.name) is not Phase.START:
                raise ValueError(f"{said} begins nothing")
            draws = _finite(which), _finite(how)
            if not all(0 <= draw < 1 for draw in draws):
                raise ValueError("a draw is not between 0 and 1")
            runs[action] = _Run(_finite(began), None if breaks is None else _finite(breaks), draws)
        clock = _finite(snapshot["clock"])
        self._runs, self.clock = runs, clock


def _finite(value: Any) -> float:
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f"{value!r} is no time")
    return number
