"""What is probably true: a Bayes filter over joint states of the ground facts.

The filter is exact over the joint states that the action model with its faults can reach, as long
as they are few; states whose probability falls under a threshold are dropped. What the action model
cannot explain is taken in when answers call for it (`open`).
"""

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.faults import FaultModel, JointState, Rates
from tpvqa.belief.information import Floats
from tpvqa.belief.led import Led
from tpvqa.belief.outcome_weights import Came, OutcomeWeights, carried
from tpvqa.pddl import Action, Atom, State

SMALLEST = 1e-5
"""Joint states under this probability are dropped."""
MOST = 300
"""Joint states that are kept; the most probable ones."""
NEVER = 1e-12
"""Nothing that is told apart of a VLM's noise is less probable, so that it can be learnt of."""
LOOKED_BACK = 4
"""Actions before the last one of which it is still known how they came out."""


class Belief:
    """A probability for every joint state that is possible, jointly with how the VLM errs.

    What is believed of its noise is not the same in every joint state: where the answers are
    wrong, it is the worse one. So when answers turn out to be worth little, what they were taken
    to say goes, too.

    Args:
        model: The action model with its faults.
        state: The initial state, believed for certain (see `open`).
        smallest: Joint states under this probability are dropped.
        most: Joint states that are kept.
    """

    def __init__(
        self,
        model: FaultModel,
        state: State | None = None,
        *,
        smallest: float = SMALLEST,
        most: int = MOST,
    ):
        self.model, self._smallest, self._most = model, smallest, most
        self._surprise = model.surprise
        first = model.task.init if state is None else state
        model.begin(model.task.init)
        self.weights: dict[int, float] = {model.number(JointState(first)): 1.0}
        self._noise: dict[int, Floats] = {}
        self._summed: Floats | None = None
        self._masses: tuple[tuple[int, ...], Floats] | None = None
        self._unaware: Floats = np.ones(1)
        self.led: Led | None = None
        self.outcome_weights: OutcomeWeights | None = None
        self._predicted: dict[int, float] = {}
        self._earlier: list[dict[int, Came]] = []
        self._marginals: dict[tuple[Atom, ...], float] = {}
        self._ranked: list[tuple[int, float]] | None = None

    def renew(self) -> dict[int, int]:
        """Forget the joint states that are not possible any more, before an action.

        Returns:
            The new numbers of those that are, by their old ones.
        """
        old, self.model = self.model, self.model.renewed()
        numbers = {number: self.model.number(old.joint_states[number]) for number in self.weights}
        self._earlier = [
            {numbers[number]: each for number, each in came.items() if number in numbers}
            for came in self._remembered()
        ]
        self.weights = {numbers[number]: weight for number, weight in self.weights.items()}
        self._noise = {
            numbers[number]: self._noise[number] for number in numbers if number in self._noise
        }
        self.outcome_weights = None
        self._predicted = {}
        self._marginals.clear()
        self._ranked = self._summed = self._masses = None
        return numbers

    def begin(self, states: Sequence[tuple[State, float]]) -> None:
        """Begin anew from several initial states, each with its weight.

        What disturbances undo is what was not so in the most probable one.
        """
        self.model.begin(max(states, key=lambda each: each[1])[0])
        self.suppose(self.noise)
        self.outcome_weights = self.led = None
        self._earlier = []
        self._become({self.model.number(JointState(state)): weight for state, weight in states})

    def suppose(self, noise: Floats) -> None:
        """Begin anew with what is believed of the VLM's noise, the same in every joint state.

        Args:
            noise: Probabilities of what is told apart.
        """
        self._unaware = noise
        self._noise, self._summed, self._masses = {}, None, None

    @property
    def noise(self) -> Floats:
        """What is believed of the VLM's noise: probabilities of what is told apart."""
        if self._summed is None:
            self._summed = self.masses()[1].sum(axis=0)
        return self._summed

    def masses(self) -> tuple[tuple[int, ...], Floats]:
        """The numbers of the joint states; and their probabilities (rows), each with everything
        that is told apart of the noise."""
        if self._masses is None:
            rows = np.stack([w * self._noise_in(number) for number, w in self.weights.items()])
            self._masses = tuple(self.weights), rows
        return self._masses

    def _noise_in(self, number: int) -> Floats:
        return self._noise.get(number, self._unaware)

    def states(self) -> list[tuple[State, float]]:
        """The joint states with their probabilities, the most probable first."""
        return [(self.model.state(number), weight) for number, weight in self.ranked()]

    def ranked(self) -> Sequence[tuple[int, float]]:
        """The numbers of the joint states with their probabilities, the most probable first."""
        if self._ranked is None:
            self._ranked = self.model.ranked(self.weights)
        return self._ranked

    def most_probable(self) -> tuple[State, float]:
        """The most probable joint state. It is consistent: every joint state is."""
        number, weight = self.ranked()[0]
        return self.model.state(number), weight

    def probability(self, atom: Atom, alike: Iterable[Atom] = ()) -> float:
        """The probability of a fact, or of it or any fact alike."""
        atoms = (atom, *alike)
        known = self._marginals.get(atoms)
        if known is None:
            truth = self.model.truth(atoms)
            total = sum(weight for number, weight in self.weights.items() if truth[number])
            known = self._marginals[atoms] = min(total, 1.0)
        return known

    def probabilities(self, atoms: Sequence[Atom]) -> dict[Atom, float]:
        """The probabilities of many facts."""
        truths = self.model.truths([(atom,) for atom in atoms], list(self.weights))
        likely = np.minimum(truths @ np.array(list(self.weights.values())), 1.0)
        return dict(zip(atoms, likely.tolist(), strict=True))

    def where(self, holds: Callable[[State], bool]) -> float:
        """The probability that something holds."""
        return min(
            1.0,
            sum(
                weight for number, weight in self.weights.items() if holds(self.model.state(number))
            ),
        )

    def act(self, action: Action, rates: Rates) -> None:
        """Predict what an action leads to."""
        after: dict[int, float] = {}
        came, remembered = OutcomeWeights(), self._remembered()
        led: list[tuple[int, int, float]] = []

        def add(number: int, weight: float, kind: dict[int, float] | None = None) -> None:
            after[number] = after.get(number, 0.0) + weight
            led.append((begun, number, weight))
            if kind is not None:
                kind[number] = kind.get(number, 0.0) + weight

        f, d, s = rates.failure, rates.disturbance, rates.spontaneous
        leads_to = self.model.outcomes(action)
        for number, weight in self.weights.items():
            begun, outcomes = number, leads_to[number]
            if outcomes.achieved:
                add(number, weight, came.achieved)
                continue
            failing = weight
            possible = outcomes.intended is not None
            if outcomes.intended is not None:
                failing = weight * f
                falling = weight * (1 - f) * s
                after_it = outcomes.undone_after if falling > self._smallest else ()
                lasting = 1 - s if after_it else 1.0
                add(outcomes.intended, weight * (1 - f) * lasting, came.success)
                for share, other in after_it:
                    add(other, falling * share, came.success)
            undone = outcomes.undone if failing * d > self._smallest else ()
            if not undone:
                add(number, failing, came.failure if possible else None)
                continue
            add(number, failing * (1 - d), came.failure if possible else None)
            came.could_disturb[number] = came.could_disturb.get(number, 0) + failing * (1 - d)
            for share, other in undone:
                mass = failing * d * share
                add(other, mass, came.failure if possible else None)
                came.disturbed[other] = came.disturbed.get(other, 0.0) + mass
        self.outcome_weights = came
        self._earlier = [carried(each, led, after) for each in remembered]
        noise = {begun: self._noise_in(begun) for begun in self.weights}
        scenes = {n: self.model.kind(n) for n in (*self.weights, *after)}
        self._predicted = dict(after)
        self._become(after)
        self.led = Led.of(led, self.weights, noise, scenes)
        self._noise = dict(zip(self.led.after, self.led.mixed, strict=True))
        self._summed = self._masses = None

    def weigh(self, likelihood: Callable[[int], float]) -> float:
        """Weigh every joint state by how probable what was seen is in it (Bayes' rule).

        Args:
            likelihood: Of the number of a joint state.

        Returns:
            How probable it was, before it was seen. Where it is impossible in every joint
            state, nothing changes.
        """
        return self._weighed({n: weight * likelihood(n) for n, weight in self.weights.items()})

    def _weighed(self, weights: dict[int, float]) -> float:
        total = sum(weights.values())
        if total <= 0.0:
            return 0.0
        self._become(weights)
        return total

    def see(self, atoms: tuple[Atom, ...], if_true: float, if_false: float) -> float:
        """Weigh by an answer about a fact (or any of several alike).

        Args:
            atoms: Yes is right where any of them holds.
            if_true: Probability of the answer where yes is right; only the ratio matters.
            if_false: Where no is right.
        """
        truth = self.model.truth(atoms)
        return self._weighed(
            {n: weight * (if_true if truth[n] else if_false) for n, weight in self.weights.items()}
        )

    def hear(self, likely: Floats) -> None:
        """Weigh by an answer.

        Args:
            likely: Its probability in every joint state (rows, as of `masses`), with everything
                that is told apart of the VLM's noise.
        """
        numbers, masses = self.masses()
        masses = masses * likely
        weights = masses.sum(axis=1)
        noise = np.maximum(masses / np.maximum(weights, 1e-300)[:, None], NEVER)
        if self._weighed(dict(zip(numbers, weights.tolist(), strict=True))):
            rows = dict(zip(numbers, noise, strict=True))
            self._noise = {number: rows[number] for number in self.weights}
            self._summed = self._masses = None

    def weigh_outcome(self, *, succeeded: float, failed: float, achieved: float) -> None:
        """Weigh by how probable something is where the last action succeeded, where it failed, and
        where nothing was left for it to do."""
        came = self.outcome_weights
        if came is None:
            return

        def likelihood(number: int) -> float:
            whole = self._predicted[number]
            success = came.success.get(number, 0.0) / whole
            idle = came.achieved.get(number, 0.0) / whole
            return success * succeeded + idle * achieved + (1 - success - idle) * failed

        self.weigh(likelihood)

    def open(self, atoms: tuple[Atom, ...], chance: float) -> int:
        """Take in that a fact may have changed without the action model knowing.

        From every joint state with a share of at least a hundredth, the nearest consistent ones
        in which the fact is the other way get `chance` of its probability.

        Returns:
            How many joint states that added.
        """
        grown = dict(self.weights)
        new, most = 0, 1
        for number, weight in self.weights.items():
            if weight < 0.01:
                continue
            state = self.model.state(number)
            others = self._surprise.flips(state, atoms)
            if not others:
                continue
            grown[number] -= chance * weight
            most = max(most, len(others))
            for other in others:
                there = self.model.become(number, other)
                new += there not in grown
                share = chance * weight / len(others)
                self._noise[there] = (
                    grown.get(there, 0.0) * self._noise_in(there) + share * self._noise_in(number)
                ) / (grown.get(there, 0.0) + share)
                grown[there] = grown.get(there, 0.0) + share
        self._become(grown, self._smallest / most)
        return new

    def where_noise(self, part: NDArray[np.bool_]) -> dict[int, float]:
        """The probabilities of the joint states where the VLM's noise is one of some.

        Args:
            part: Which, of all that is told apart of it.
        """
        numbers, masses = self.masses()
        weights = masses[:, part].sum(axis=1)
        weights = weights / max(float(weights.sum()), 1e-300)
        return dict(zip(numbers, weights.tolist(), strict=True))

    def outcome_shares(self, weights: Mapping[int, float] | None = None) -> Mapping[str, float]:
        """How the last action came out, after all that was seen since.

        Args:
            weights: Probabilities of the joint states; by default as they are believed.

        Returns:
            Expected numbers, each between 0 and 1: "success", "failure", and of those in which
            something could be disturbed, "disturbed" and "undisturbed". Empty before the first
            action.
        """
        if self.outcome_weights is None:
            return {}
        now = self.weights if weights is None else weights
        return self.outcome_weights.shares(now, self._predicted)

    def earlier_shares(
        self, weights: Mapping[int, float] | None = None
    ) -> list[Mapping[str, float]]:
        """How the actions before the last one came out, after all that was seen since; the latest
        first, as `outcome_shares`."""
        now = self.weights if weights is None else weights
        return [
            {
                kind: sum(w * came[n][place] for n, w in now.items() if n in came)
                for place, kind in enumerate(("success", "failure", "achieved"))
            }
            for came in self._earlier
        ]

    def _remembered(self) -> list[dict[int, Came]]:
        """How the last actions came out where a joint state is the true one, the latest first."""
        came = self.outcome_weights
        if came is None:
            return self._earlier[:LOOKED_BACK]
        kinds = (came.success, came.failure, came.achieved)
        last: dict[int, Came] = {}
        for number in self.weights:
            whole = self._predicted.get(number, 0.0)
            if whole > 0:
                success, failure, idle = (kind.get(number, 0.0) / whole for kind in kinds)
                last[number] = success, failure, idle
        return [last, *self._earlier][:LOOKED_BACK]

    def _become(self, weights: dict[int, float], smallest: float | None = None) -> None:
        total = sum(weights.values())
        least = (self._smallest if smallest is None else smallest) * total
        kept = {n: w / total for n, w in weights.items() if w > least}
        if len(kept) > self._most:
            kept = dict(self.model.ranked(kept)[: self._most])
        share = sum(kept.values())
        self.weights = {n: w / share for n, w in kept.items()}
        if len(self._noise) > len(kept):
            self._noise = {n: self._noise[n] for n in kept if n in self._noise}
        self._marginals.clear()
        self._ranked = self._summed = self._masses = None
