"""How the last action came out: shares of joint states, of success and of failure."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

Came = tuple[float, float, float]
"""Shares of success, of failure, and of nothing left to do."""


@dataclass(slots=True)
class OutcomeWeights:
    """How an action's outcome is shared between its ways, by joint state. Unnormalised."""

    success: dict[int, float] = field(default_factory=dict)
    failure: dict[int, float] = field(default_factory=dict)
    disturbed: dict[int, float] = field(default_factory=dict)
    achieved: dict[int, float] = field(default_factory=dict)
    could_disturb: dict[int, float] = field(default_factory=dict)

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
                ("undisturbed", self.could_disturb),
            )
        }


def carried(
    came: Mapping[int, Came], led: Sequence[tuple[int, int, float]], after: Mapping[int, float]
) -> dict[int, Came]:
    """How an earlier action came out, by the joint states that a later one has led to.

    Args:
        came: By the joint states before it.
        led: What it led from where to where, with which weight.
        after: All weight of each joint state.
    """
    found: dict[int, Came] = {}
    for begun, number, weight in led:
        if begun in came and after[number] > 0:
            share, (a, b, c) = weight / after[number], came[begun]
            x, y, z = found.get(number, (0.0, 0.0, 0.0))
            found[number] = x + share * a, y + share * b, z + share * c
    return found
