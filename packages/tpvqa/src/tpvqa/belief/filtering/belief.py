"""What is probably true: a Bayes filter over joint states of the ground facts.

The filter is exact over the joint states that the action model with its faults can reach, as long
as they are few; states whose probability falls under a threshold are dropped. What the action model
cannot explain is taken in when answers call for it (`open`).
"""

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.answers.led import Led, Places
from tpvqa.belief.answers.noise import NEVER, JointNoise
from tpvqa.belief.answers.told_apart import ToldApart
from tpvqa.belief.answers.weighed import Instead
from tpvqa.belief.filtering.faults import FaultModel, JointState, Rates
from tpvqa.belief.filtering.outcomes import Earlier, OutcomeWeights, Weights, aligned, carried
from tpvqa.belief.filtering.probable_start import probably
from tpvqa.belief.states.packed import Facts
from tpvqa.pddl import Action, Atom, State

SMALLEST = 1e-5
"""Joint states under this probability are dropped."""
MOST = 300
"""Joint states that are kept; the most probable ones."""
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

    Attributes:
        led: Where the last action has led; None before the first.
        outcome_weights: How it came out.
        predicted: The weights after it, before anything was seen.
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
        self._noise = JointNoise()
        self._summed: Floats | None = None
        self._masses: tuple[tuple[int, ...], Floats] | None = None
        self.led: Led | None = None
        self.outcome_weights: OutcomeWeights | None = None
        self.predicted: dict[int, float] = {}
        self._earlier: Earlier = (), np.zeros((0, 3, 0))
        self._likely: list[float] | None = None
        self._held: tuple[tuple[int, ...], Facts] | None = None
        self._ranked: list[tuple[int, float]] | None = None

    def renew(self) -> dict[int, int]:
        """Forget the joint states that are not possible any more, before an action.

        Returns:
            The new numbers of those that are, by their old ones.
        """
        old, self.model = self.model, self.model.renewed()
        numbers = {number: self.model.number(old.joint_states[number]) for number in self.weights}
        known, came = self._remembered()
        kept = [place for place, number in enumerate(known) if number in numbers]
        self._earlier = tuple(numbers[known[place]] for place in kept), came[:, :, kept]
        self.weights = {numbers[number]: weight for number, weight in self.weights.items()}
        self._noise.renumbered(numbers)
        self.outcome_weights = None
        self.predicted = {}
        self._ranked = self._summed = self._masses = self._likely = self._held = None
        return numbers

    def begin(self, states: Sequence[tuple[State, float]]) -> None:
        """Begin anew from several initial states, each with its weight."""
        self.model.begin(probably(states))
        self.suppose(self.noise)
        self.outcome_weights, self.led, self.predicted = None, None, {}
        self._earlier = (), np.zeros((0, 3, 0))
        self._become({self.model.number(JointState(state)): weight for state, weight in states})

    def suppose(self, noise: Floats) -> None:
        """Begin anew with what is believed of the VLM's noise, the same in every joint state.

        Args:
            noise: Probabilities of what is told apart.
        """
        self._noise.suppose(noise)
        self._summed = self._masses = None

    def tell_apart(self, apart: ToldApart) -> None:
        """Go on with other columns of all that is told apart of the noise."""
        self._noise.tell_apart(apart, self.masses()[1])
        self._summed = self._masses = None

    @property
    def told(self) -> Places:
        """Columns of all that is told apart of the noise, those that are kept in joint states."""
        return self._noise.told

    @property
    def apart(self) -> ToldApart | None:
        """How these stand for the others; None where there are none."""
        return self._noise.apart

    @property
    def noise(self) -> Floats:
        """What is believed of the VLM's noise: probabilities of what is told apart."""
        if self._summed is None:
            self._summed = self._noise.whole(self.masses()[1])
        return self._summed

    def masses(self) -> tuple[tuple[int, ...], Floats]:
        """The numbers of the joint states; and their probabilities (rows), each with everything
        that is told apart of the noise and not left out (`told`)."""
        if self._masses is None:
            numbers, weights = tuple(self.weights), np.array(list(self.weights.values()))
            self._masses = numbers, weights[:, None] * self._noise.rows(numbers)
        return self._masses

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
        if not self.model.packs(atoms):
            truth = self.model.truth(atoms)
            return min(1.0, sum(weight for n, weight in self.weights.items() if truth[n]))
        weights = self.weights.values()
        if self._likely is None:
            self._likely = self._facts().probabilities(np.array(list(weights)))
        if len(atoms) == 1:
            place = self.model.bit(atom)
            return self._likely[place] if place < len(self._likely) else 0.0
        return min(1.0, float(self.holds(atoms) @ np.array(list(weights))))

    def holds(self, atoms: tuple[Atom, ...]) -> NDArray[np.bool_]:
        """Where any of some facts holds, of the joint states as `masses` has them."""
        if not self.model.packs(atoms):
            truth = self.model.truth(atoms)
            return np.array([truth[number] for number in self.weights], bool)
        return self._facts().holds([self.model.bit(atom) for atom in atoms])

    def _facts(self) -> Facts:
        numbers = tuple(self.weights)
        if self._held is None or self._held[0] != numbers:
            self._held = numbers, Facts(self.model.rows(numbers))
        return self._held[1]

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

        def add(number: int, weight: float, *kinds: Weights) -> None:
            after[number] = after.get(number, 0.0) + weight
            led.append((begun, number, weight))
            for kind in kinds:
                kind[number] = kind.get(number, 0.0) + weight

        def fall(
            number: int, weight: float, rate: float, kinds: list[Weights], counted: list[Weights]
        ) -> None:
            """Add a joint state, in which something may come undone."""
            kept, fell = weight * (1 - rate), weight * rate
            undone = self.model.undone(number) if fell > self._smallest else ()
            # Where some are dropped unseen, nothing is counted.
            counts = bool(undone) and fell * min(undone)[0] > self._smallest
            stays, falls = ([each] if counts else [] for each in counted)
            add(number, kept if undone else weight, *kinds, *stays)
            for share, other in undone:
                add(other, fell * share, *kinds, *falls)

        f, d = rates.failure, rates.disturbance
        leads_to = self.model.outcomes(action)
        for number, weight in self.weights.items():
            begun, outcomes = number, leads_to[number]
            if outcomes.achieved:
                fall(number, weight, rates.redone, [came.achieved], [came.kept, came.slipped])
            elif outcomes.intended is None:
                fall(number, weight, rates.impossible, [], [came.undisturbed, came.disturbed])
            else:
                worked = weight * (1 - f), rates.spontaneous, [came.success]
                fall(outcomes.intended, *worked, [came.stayed, came.fell])
                fall(number, weight * f, d, [came.failure], [came.undisturbed, came.disturbed])
        self.outcome_weights = came
        numbers = tuple(self.weights)
        noise = dict(zip(numbers, self._noise.rows(numbers), strict=True))
        scenes = {n: self.model.kind(n) for n in (*self.weights, *after)}
        self.predicted = dict(after)
        self._become(after)
        self.led = Led.of(led, self.weights, noise, scenes, self.told)
        self._noise.take(self.led.after, self.led.mixed)
        self._noise.keep(tuple(self.weights))
        self._summed = self._masses = None
        self._earlier = carried(remembered, led, after)

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
        return self.weigh(lambda number: if_true if truth[number] else if_false)

    def hear(self, likely: Floats, left_out: Floats | None = None) -> None:
        """Weigh by an answer.

        Args:
            likely: Its probability in every joint state (rows, as of `masses`), with everything
                that is told apart of the VLM's noise.
            left_out: The same with each of what is left out of them; as before where not given.
        """
        numbers, masses = self.masses()
        masses = masses * likely
        weights = masses.sum(axis=1)
        if left_out is not None:
            self._noise.answered(left_out, float(weights.sum()))
        noise = np.maximum(masses / np.maximum(weights, 1e-300)[:, None], NEVER)
        if self._weighed(dict(zip(numbers, weights.tolist(), strict=True))):
            self._noise.take(numbers, noise)
            self._noise.keep(tuple(self.weights))
            self._summed = self._masses = None

    def weigh_outcome(self, *, succeeded: float, failed: float, achieved: float) -> None:
        """Weigh by how probable something is where the last action succeeded, where it failed, and
        where nothing was left for it to do."""
        came = self.outcome_weights
        if came is None:
            return

        def likelihood(number: int) -> float:
            whole = self.predicted[number]
            success = came.success.get(number, 0.0) / whole
            idle = came.achieved.get(number, 0.0) / whole
            return success * succeeded + idle * achieved + (1 - success - idle) * failed

        self.weigh(likelihood)

    def open(self, atoms: tuple[Atom, ...], chance: float, instead: Instead | None = None) -> int:
        """Take in that a fact may have changed without the action model knowing.

        From every joint state with a share of at least a hundredth, the nearest consistent ones
        in which the fact is the other way get `chance` of its probability, as far as what was said
        is as probable in them.

        Returns:
            How many of these are kept.
        """
        grown, met, most = dict(self.weights), set[int](), 1
        rows = dict(zip(grown, self._noise.rows(tuple(grown)), strict=True))
        for number, weight in self.weights.items():
            state = self.model.state(number)
            others = self._surprise.flips(state, atoms) if weight >= 0.01 else ()
            if not others:
                continue
            grown[number] -= chance * weight
            most = max(most, len(others))
            for other in others:
                there = self.model.become(number, other)
                row = rows[number]
                if instead and (more := instead(number, there)) is not None:
                    row = row * np.exp(more)
                share = chance * weight / len(others) * (likely := float(row.sum()))
                if share > 0.0:
                    met.add(there)
                    self._noise.mix(there, grown.get(there, 0.0), row / likely, share)
                    grown[there] = grown.get(there, 0.0) + share
        self._become(grown, self._smallest / most)
        return len(met & self.weights.keys())

    def where_noise(self, part: NDArray[np.bool_]) -> dict[int, float]:
        """The probabilities of the joint states where the VLM's noise is one of some.

        Args:
            part: Which, of all that is told apart of it.
        """
        numbers, masses = self.masses()
        weights = masses[:, part[self.told]].sum(axis=1)
        if not weights.any():  # left out: it says nothing of joint states
            weights = masses.sum(axis=1)
        weights = weights / max(float(weights.sum()), 1e-300)
        return dict(zip(numbers, weights.tolist(), strict=True))

    def outcome_shares(self, weights: Mapping[int, float] | None = None) -> Mapping[str, float]:
        """How the last action came out, after all that was seen since.

        Args:
            weights: Probabilities of the joint states; by default as they are believed.

        Returns:
            Expected numbers, each between 0 and 1: "success", "failure", and of what something
            could be undone in: "disturbed" and "undisturbed" without a success, "fell" and "stayed"
            with one, "slipped" and "kept" with nothing to do. Empty before the first action.
        """
        if self.outcome_weights is None:
            return {}
        now = self.weights if weights is None else weights
        return self.outcome_weights.shares(now, self.predicted)

    def earlier_shares(
        self, weights: Mapping[int, float] | None = None
    ) -> list[Mapping[str, float]]:
        """How the actions before the last one came out, after all that was seen since; the latest
        first, as `outcome_shares`."""
        now, (numbers, came) = self.weights if weights is None else weights, self._earlier
        likely = np.array([now.get(number, 0.0) for number in numbers])
        kinds = "success", "failure", "achieved"
        return [dict(zip(kinds, each, strict=True)) for each in (came @ likely).tolist()]

    def _remembered(self) -> Earlier:
        """How the last actions came out where a joint state is the true one, the latest first."""
        if self.outcome_weights is None:
            return self._earlier[0], self._earlier[1][:LOOKED_BACK]
        numbers = tuple(self.weights)
        came = self.outcome_weights.came(numbers, self.predicted)
        earlier = aligned(self._earlier[1], self._earlier[0], numbers)
        return numbers, np.concatenate([came[None], earlier])[:LOOKED_BACK]

    def _become(self, weights: dict[int, float], smallest: float | None = None) -> None:
        total = sum(weights.values())
        least = (self._smallest if smallest is None else smallest) * total
        kept = {n: w / total for n, w in weights.items() if w > least}
        if len(kept) > self._most:
            kept = dict(self.model.ranked(kept)[: self._most])
        share = sum(kept.values())
        self.weights = {n: w / share for n, w in kept.items()}
        self._ranked = self._summed = self._masses = self._likely = None
