"""How often a task can be done without a look: the limit of whoever sees nothing.

`python experiments/tools/without_looks.py TASK… [--redo free,risky] [--price .0125]`

Of a shipped task whose actions fail and disturb as often as in `bench belief --parts lasting`, it
reckons exactly, over all that may happen, how often the goal holds after every step of the plan was
done K times (`blind:K`), and after the best fixed sequence of the plan's actions that was found:
parts of the plan are put in and taken out anywhere as long as the goal comes to hold so much more
often that it is worth their price. That is what such a search finds, no proof that there is nothing
better.
"""

import argparse
import json
import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from functools import cache

from tpvqa.assembly import Trial
from tpvqa.config import TrialConfig
from tpvqa.pddl import Action, Atom, State
from tpvqa.planning.protocol import Plan as Planned
from tpvqa.worlds.simulation import Simulation

TIMES = (1, 2, 3, 4, 5, 8)
"""How often each step is done by those who repeat blindly."""
LONGEST = 6
"""So many actions in a row are taken out at most."""
LEAST = 1e-7
"""What is less probable is left out."""

Stands = tuple[State, tuple[Atom, ...]]
"""A true state, and the facts that ended on the way there, each once, the latest last."""
Plan = tuple[Action, ...]


class Reckoning:
    """What sequences of actions lead to in a simulated world.

    Args:
        simulation: The world, before anything was done.
    """

    def __init__(self, simulation: Simulation):
        self._world, self._start = simulation, (simulation.state, ())
        self._led = cache(self._leads)
        self._after = cache(self._reached)

    def reaches(self, plan: Sequence[Action]) -> float:
        """How probable it is that the goal holds in the end."""
        holds = self._world.task.goal_holds
        return sum(p for (state, _), p in self._after(tuple(plan)).items() if holds(state))

    def _reached(self, plan: Plan) -> dict[Stands, float]:
        if not plan:
            return {self._start: 1.0}
        found: dict[Stands, float] = defaultdict(float)
        for stands, mass in self._after(plan[:-1]).items():
            if mass > LEAST:
                for share, other in self._led(stands, plan[-1]):
                    found[other] += mass * share
        return dict(found)

    def _leads(self, stands: Stands, action: Action) -> list[tuple[float, Stands]]:
        world = self._world
        done, idle = self._set(stands), self._undone(stands, world.disturbance)
        if world.achieved(action):
            if world.redo != "risky":
                return [(1.0, stands)]
            return [*_times(world.failure, idle), (1 - world.failure, stands)]
        self._set(stands)
        if not world.possible(action):
            return idle
        done.become(world.task.apply(world.state, action))
        worked = self._undone(self._stands(stands), world.spontaneous)
        return [*_times(world.failure, idle), *_times(1 - world.failure, worked)]

    def _undone(self, stands: Stands, often: float) -> list[tuple[float, Stands]]:
        undoable = self._set(stands).undoable() if often else {}
        if not undoable:
            return [(1.0, stands)]
        found = [(1 - often, stands)]
        for ways in undoable.values():
            for _, after in ways:
                self._set(stands).become(after)
                found.append((often / len(undoable) / len(ways), self._stands(stands)))
        self._set(stands)
        return found

    def _set(self, stands: Stands) -> Simulation:
        self._world.state, ended = stands
        self._world.ended = list(ended)
        return self._world

    def _stands(self, before: Stands) -> Stands:
        """Where the world stands now; the latest end of a fact tells what it falls back to."""
        ended = self._world.ended
        return self._world.state, tuple(reversed(dict.fromkeys(reversed(ended))))


def _times(share: float, led: Iterable[tuple[float, Stands]]) -> Iterator[tuple[float, Stands]]:
    return ((share * part, stands) for part, stands in led)


def best(reckoning: Reckoning, plan: Plan, price: float) -> Plan:
    """The best sequence that is found from the plan, and from every step twice and three times.

    Args:
        reckoning: What sequences lead to.
        plan: It.
        price: How much more often the goal has to hold for another action.
    """

    def worth(sequence: Plan) -> float:
        return reckoning.reaches(sequence) - price * len(sequence)

    pieces = [plan[i:j] for i in range(len(plan)) for j in range(i + 1, len(plan) + 1)]
    found = []
    for times in TIMES[:3]:
        now = tuple(action for action in plan for _ in range(times))
        while True:
            other = max(_changed(now, pieces), key=worth)
            if worth(other) <= worth(now) + 1e-9:
                break
            now = other
        found.append(now)
    return max(found, key=worth)


def _changed(sequence: Plan, pieces: Sequence[Plan]) -> Iterator[Plan]:
    for i in range(len(sequence) + 1):
        for j in range(i + 1, min(len(sequence), i + LONGEST) + 1):
            yield sequence[:i] + sequence[j:]
        for piece in pieces:
            yield sequence[:i] + piece + sequence[i:]


def main() -> None:
    """Print a line of JSON for each task and each way that redoing goes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tasks", nargs="+")
    parser.add_argument("--redo", default="free,risky")
    parser.add_argument("--price", type=float, default=0.0125)
    given = parser.parse_args()
    for task in given.tasks:
        for redo in given.redo.split(","):
            config = TrialConfig().but(
                task=task, world="symbolic", monitor="none", simulation={"redo": redo}
            )
            with Trial(config) as trial:
                planned = trial.parts.planner.plan(trial.task, trial.task.init)
                if trial.simulation is None or not isinstance(planned, Planned):
                    sys.exit(f"{task}: there is no plan, or no simulated world")
                reckoning, plan = Reckoning(trial.simulation), tuple(planned.actions)
                found = best(reckoning, plan, given.price)
                print(
                    json.dumps(
                        {
                            "task": task,
                            "redo": redo,
                            "blind": {
                                times: round(
                                    reckoning.reaches([a for a in plan for _ in range(times)]), 3
                                )
                                for times in TIMES
                            },
                            "best": round(reckoning.reaches(found), 3),
                            "actions": len(found),
                            "sequence": [action.pddl() for action in found],
                        }
                    ),
                    flush=True,
                )


if __name__ == "__main__":
    main()
