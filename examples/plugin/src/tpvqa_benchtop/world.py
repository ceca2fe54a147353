"""A simulated world whose pictures are drawn at every look."""

import operator
from collections.abc import Mapping, Sequence
from threading import Event
from typing import Any

from tpvqa.chance import chance
from tpvqa.errors import UnknownNameError
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Action
from tpvqa.worlds import Execution
from tpvqa.worlds.capabilities import Simulated
from tpvqa.worlds.outcome import Outcome
from tpvqa.worlds.simulation import SimulatedTruth, Simulation
from tpvqa_benchtop.scenes import SCENES, picture


class Drawn(Simulated):
    """As it derives from `Simulated`, it is given the true state, and faults happen to it.

    Args:
        simulation: The true state and its faults.
    """

    def __init__(self, simulation: Simulation):
        self.simulation = simulation
        self.truth = SimulatedTruth(simulation)  # for judges and noise models
        self.last_outcome: Outcome | None = None
        self._looks = 0

    def check(self) -> None:
        """See that the domain can be drawn, before anything moves."""
        domain = self.simulation.task.domain_name
        if domain not in SCENES:
            raise UnknownNameError("domain", domain, SCENES)

    def views(self) -> Sequence[str]:
        """One camera."""
        return ("front",)

    def observe(self, view: str | None = None) -> Observation:
        """A new look; which light and noise it has depends on seed, episode and its number."""
        here = self.simulation
        look, self._looks = self._looks, self._looks + 1
        draw = chance(here.seed, here.episode, "drawing", look)
        frame = Frame("front", "front", picture(here.task.domain_name, here.state, draw))
        return Observation(time=float(look), frames={"front": frame}, facts=here.sensed())

    def senses(self) -> frozenset[str]:
        """The predicates that the world file says are sensed."""
        return self.simulation.senses()

    def execute(
        self, action: Action, *, deadline: float | None = None, cancel: Event | None = None
    ) -> Execution:
        """Try the action at once."""
        self.last_outcome = self.simulation.execute(action)
        return self.last_outcome.execution(0.0)

    def snapshot(self) -> Mapping[str, Any]:
        """What a resumed trial needs to go on here."""
        return {"look": self._looks, "simulation": self.simulation.snapshot()}

    def restore(self, snapshot: Mapping[str, Any]) -> None:
        """Put back what `snapshot` gave."""
        self._looks = operator.index(snapshot["look"])
        self.simulation.restore(snapshot["simulation"])

    def close(self) -> None:
        """Nothing to let go of."""
