"""The belief monitor without one of its parts, to see what each part is worth."""

from itertools import product

from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, JointState, Rates
from tpvqa.pddl import Action

PARTS = ("consistency", "relevance", "calibration", "model", "learning")
"""What can be left out."""
FACTS = 7
"""Facts in doubt that are combined freely, at most."""


class FactwiseBelief(Belief):
    """Without consistency: every fact is believed by itself, whatever the others are."""

    def act(self, action: Action, rates: Rates) -> None:
        """Predict, then forget how the facts hang together."""
        noise = self.noise
        super().act(action, rates)
        self.suppose(noise)
        atoms = {atom for number in self.weights for atom in self.model.state(number)}
        chances = {atom: self.probability(atom) for atom in atoms}
        doubted = sorted(
            (atom for atom in atoms if 1e-3 < chances[atom] < 1 - 1e-3),
            key=lambda atom: (abs(chances[atom] - 0.5), atom),
        )[:FACTS]
        certain = {atom for atom in atoms if atom not in doubted and chances[atom] >= 0.5}
        weights: dict[int, float] = {}
        for values in product((True, False), repeat=len(doubted)):
            weight = 1.0
            for atom, value in zip(doubted, values, strict=True):
                weight *= chances[atom] if value else 1 - chances[atom]
            true = {atom for atom, value in zip(doubted, values, strict=True) if value}
            weights[self.model.number(JointState(frozenset(certain | true)))] = weight
        self.outcome_weights = self.led = None
        self._become(weights)


class ModelFreeBelief(Belief):
    """Without the action model: an action may have done what its effects say, or nothing."""

    def act(self, action: Action, rates: Rates) -> None:
        """Half of every joint state's probability goes to where the effects lead."""
        self.suppose(self.noise)
        weights: dict[int, float] = {}
        for number, weight in self.weights.items():
            after = self.model.become(
                number, self.model.task.apply(self.model.state(number), action)
            )
            for other in (number, after):
                weights[other] = weights.get(other, 0.0) + weight / 2
        self.outcome_weights = self.led = None
        self._become(weights)


def belief_without(part: str | None, model: FaultModel) -> Belief:
    """The belief, without one of `PARTS` that lies in it."""
    kinds = {"consistency": FactwiseBelief, "model": ModelFreeBelief}
    return kinds.get(part or "", Belief)(model)
