"""A world that is told, not seen: for experiments without pictures and for users' own domains."""

import operator
from collections.abc import Mapping, Sequence
from threading import Event
from typing import Any

from tpvqa.errors import UnknownNameError
from tpvqa.observation import Observation
from tpvqa.pddl import Action
from tpvqa.worlds.capabilities import Pictureless, Simulated
from tpvqa.worlds.outcome import Outcome
from tpvqa.worlds.protocol import Execution, Report
from tpvqa.worlds.simulation import LEAST_TIME, SimulatedTruth, Simulation


class SymbolicWorld(Simulated, Pictureless):
    """A simulation without pictures; its observations are empty, so only noise models answer.

    Args:
        simulation: The true state and its faults.
    """

    def __init__(self, simulation: Simulation):
        self.simulation = simulation
        self.truth = SimulatedTruth(simulation)
        self.last_outcome: Outcome | None = None
        self._looks = 0

    def views(self) -> Sequence[str]:
        """One view."""
        return ("front",)

    def observe(self, view: str | None = None) -> Observation:
        """A new look, without pictures; by this world's clock it takes a second."""
        if view not in (None, "front"):
            raise UnknownNameError("view", str(view), self.views())
        looks, self._looks = self._looks, self._looks + 1
        return Observation(time=float(looks), facts=self.simulation.sensed())

    def senses(self) -> frozenset[str]:
        """The predicates that the world file says are sensed."""
        return self.simulation.senses()

    def execute(
        self, action: Action, *, deadline: float | None = None, cancel: Event | None = None
    ) -> Execution:
        """Try the action at once; skill and sensors notice what the world file says."""
        if cancel is not None and cancel.is_set():
            return Execution(Report.CANCELLED, 0.0)
        if deadline is not None and deadline < LEAST_TIME:
            return Execution(Report.LATE, 0.0, "no time was given")
        self.last_outcome = self.simulation.execute(action)
        return self.last_outcome.execution(0.0)

    def wait(self, until: float | None, *, cancel: Event | None = None) -> float:
        """Let time pass at once; what an action needs while it runs may be undone meanwhile."""
        outcome = self.simulation.wait(until)
        if outcome is not None:
            self.last_outcome = outcome
        running = self.simulation.running
        return 0.0 if running is None else running.clock

    def snapshot(self) -> Mapping[str, Any]:
        """The true state and the number of looks."""
        return {"look": self._looks, "simulation": self.simulation.snapshot()}

    def restore(self, snapshot: Mapping[str, Any]) -> None:
        """Put back what `snapshot` gave."""
        self._looks = operator.index(snapshot["look"])
        self.simulation.restore(snapshot["simulation"])

    def close(self) -> None:
        """Nothing to let go of."""
