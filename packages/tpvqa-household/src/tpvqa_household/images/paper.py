"""The paper's simulator to the letter (Experiments, "Simulator with Diffusion Models").

"To model this uncertainty, we re-sample one of the previous observations to let the robot estimate
the current world state": a failure that changes previous states shows what was seen after an
earlier action again. The true state goes back with it, so that what is shown is true.
"""

from collections.abc import Mapping
from typing import Any

from tpvqa.pddl import Action, Atom, State
from tpvqa.worlds.outcome import Outcome
from tpvqa.worlds.simulation import Simulation


class PaperSimulation(Simulation):
    """A simulation whose disturbances return to what was true after an earlier action.

    Takes the arguments of `Simulation`; what a world file says can be undone is not used.
    """

    def __init__(self, *arguments: Any, **options: Any):
        super().__init__(*arguments, **options)
        self.earlier: list[State] = [self.state]

    @classmethod
    def like(cls, simulation: Simulation) -> "PaperSimulation":
        """The same trial, from its beginning, in the paper's simulator."""
        return cls(
            simulation.task,
            simulation.rules,
            failure=simulation.failure,
            disturbance=simulation.disturbance,
            spontaneous=simulation.spontaneous,
            moved=simulation.moved,
            redo=simulation.redo,
            dead=simulation.dead,
            start=simulation.start,
            seed=simulation.seed,
            episode=simulation.episode,
        )

    def execute(self, action: Action) -> Outcome:
        """Try an action on the true state, and remember what came of a success."""
        outcome = super().execute(action)
        if outcome.succeeded and outcome.before != outcome.after and outcome.undone is None:
            self.earlier.append(outcome.after)
        return outcome

    def _disturb(self, which: float, how: float) -> tuple[Atom | None, str]:
        before = self.state
        choice = [state for state in self.earlier if state != before]
        if not choice:
            return None, ""
        self.become(choice[int(which * len(choice))])
        lost = sorted(before - self.state)
        return (lost[0] if lost else None), "what was so after an earlier action is so again"

    def snapshot(self) -> dict[str, Any]:
        """The whole state as plain JSON values."""
        earlier = [[atom.pddl() for atom in sorted(state)] for state in self.earlier]
        return {**super().snapshot(), "earlier": earlier}

    def restore(self, snapshot: Mapping[str, Any]) -> None:
        """Put back what `snapshot` gave."""
        super().restore(snapshot)
        self.earlier = [frozenset(map(Atom.parse, state)) for state in snapshot["earlier"]]
