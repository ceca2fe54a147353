"""How the last action came out: shares of joint states, of success and of failure."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from tpvqa.belief.answers.information import Floats

Weights = dict[int, float]
"""Of joint states, by number."""
Earlier = tuple[tuple[int, ...], Floats]
"""Numbers of joint states; and how earlier actions came out where each is the true one, the latest
first: shares of success, of failure, and of nothing left to do; shape (actions, 3, states)."""


@dataclass(slots=True)
class OutcomeWeights:
    """How an action's outcome is shared between its ways, by joint state. Unnormalised."""

    success: Weights = field(default_factory=dict)
    failure: Weights = field(default_factory=dict)
    disturbed: Weights = field(default_factory=dict)
    achieved: Weights = field(default_factory=dict)
    undisturbed: Weights = field(default_factory=dict)
    fell: Weights = field(default_factory=dict)
    stayed: Weights = field(default_factory=dict)
    slipped: Weights = field(default_factory=dict)
    kept: Weights = field(default_factory=dict)

    def shares(self, now: Mapping[int, float], predicted: Mapping[int, float]) -> dict[str, float]:
        """See `Belief.outcome_shares`.

        Args:
            now: Probabilities of the joint states, after all that was seen since.
            predicted: Their weights before that.
        """
        return {
            name: sum(
                now.get(number, 0.0) * mass / predicted[number]
                for number, mass in masses.items()
                if predicted.get(number, 0.0) > 0
            )
            for name, masses in (
                ("success", self.success),
                ("failure", self.failure),
                ("achieved", self.achieved),
                ("disturbed", self.disturbed),
                ("undisturbed", self.undisturbed),
                ("fell", self.fell),
                ("stayed", self.stayed),
                ("slipped", self.slipped),
                ("kept", self.kept),
            )
        }

    def came(self, numbers: tuple[int, ...], predicted: Mapping[int, float]) -> Floats:
        """How the action came out where each of some joint states is the true one: shares of
        success, of failure, and of nothing left to do, shape (3, joint states).

        Args:
            numbers: The joint states.
            predicted: Their weights before anything was seen.
        """
        whole = np.array([predicted.get(number, 0.0) for number in numbers])
        kinds = self.success, self.failure, self.achieved
        came = np.array([[kind.get(number, 0.0) for number in numbers] for kind in kinds])
        return np.where(whole > 0, came / np.where(whole > 0, whole, 1.0), 0.0)


def aligned(came: Floats, known: tuple[int, ...], numbers: tuple[int, ...]) -> Floats:
    """How earlier actions came out, by other joint states: of those that are not known, nothing.

    Args:
        came: Shares of each of some actions, of each kind; shape (actions, kinds, joint states).
        known: The numbers of these joint states.
        numbers: Those of the others.
    """
    if known == numbers:
        return came
    places = {number: place for place, number in enumerate(known)}
    taken = [places.get(number, -1) for number in numbers]
    found: Floats = np.pad(came, ((0, 0), (0, 0), (0, 1)))[..., taken]
    return found


def carried(
    earlier: Earlier, led: Sequence[tuple[int, int, float]], after: Mapping[int, float]
) -> Earlier:
    """How earlier actions came out, by the joint states that a later one has led to.

    Args:
        earlier: By those before it.
        led: What it led from where to where, with which weight.
        after: All weight of each joint state.
    """
    known, came = earlier
    places = {number: place for place, number in enumerate(known)}
    numbers = {number: place for place, number in enumerate(after)}
    ways = [
        (places[old], numbers[new], weight / after[new])
        for old, new, weight in led
        if old in places and after[new] > 0
    ]
    found = np.zeros((len(after), *came.shape[:2]))
    if ways:
        begun, there, shares = zip(*ways, strict=True)
        gone = came[..., list(begun)] * np.array(shares)
        np.add.at(found, np.array(there), gone.transpose(2, 0, 1))
    return tuple(after), found.transpose(1, 2, 0)
