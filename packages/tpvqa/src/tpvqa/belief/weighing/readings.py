"""What a robot senses itself as evidence: a reading weighs the belief by what it adds."""

from dataclasses import dataclass
from math import exp

from tpvqa.belief.calibrating.own_words import SensorWorth, at_its_word
from tpvqa.belief.filtering.belief import Belief
from tpvqa.pddl import Atom

AGAIN = 0.25
"""How often a reading after an action only repeats the last one, where the fact is unchanged: what
disturbs a sensor may last."""


@dataclass(slots=True)
class _Reading:
    """The latest reading of a fact.

    Attributes:
        holds: Whether it says that the fact holds.
        true: Probability, after it, that it does.
        weighed: By what joint states in which the fact holds, and others, were weighed.
        before: The latest one before the last action.
        settled: Whether nothing was done since.
    """

    holds: bool
    true: float
    weighed: tuple[float, float]
    before: "_Reading | None"
    settled: bool = True


class Readings:
    """Takes readings into a belief.

    Between two actions a fact has one reading: a further one takes the place of the one before, as
    the same sensor at the same fact errs in the same way. After an action it repeats the last
    reading with probability `AGAIN` where the fact is what it was then.

    Args:
        belief: What is believed.
        worth: What readings are worth, by predicate; of others each is taken at its word, bounded.
    """

    def __init__(self, belief: Belief, worth: tuple[SensorWorth, ...] = ()):
        self._belief = belief
        self._worth = {each.predicate: each for each in worth}
        self._last: dict[Atom, _Reading] = {}

    def acted(self) -> None:
        """Note that an action was executed: facts may have changed."""
        for last in self._last.values():
            last.settled = False

    def ratio(self, atom: Atom, probability: float) -> float:
        """The log likelihood ratio of a reading by itself."""
        known = self._worth.get(atom.predicate)
        return at_its_word(probability) if known is None else known.log_ratio(probability)

    def take(self, atom: Atom, probability: float) -> None:
        """Weigh the belief by a reading.

        Args:
            atom: The fact.
            probability: How probable the reading makes it.
        """
        weighs = self._weighs(atom, probability)
        if weighs is None:
            return
        last = self._last.get(atom)
        (if_true, if_false), before = weighs, last
        if last is not None and last.settled:
            before = last.before
            if_true, if_false = if_true / last.weighed[0], if_false / last.weighed[1]
        self._see(atom, if_true, if_false)
        holds = self.ratio(atom, probability) > 0
        self._last[atom] = _Reading(holds, self.probability(atom), weighs, before)

    def expected(self, atom: Atom, probability: float) -> float:
        """How probable a reading that says this is, by all that is believed; 1 where it says
        nothing, or nothing new."""
        weighs, last = self._weighs(atom, probability), self._last.get(atom)
        if weighs is None or (last is not None and last.settled and last.weighed == weighs):
            return 1.0
        true = self.probability(atom)
        return true * weighs[0] + (1 - true) * weighs[1]

    def probability(self, atom: Atom) -> float:
        """The probability of a fact, also of a derived one."""
        task = self._belief.model.task
        if atom.predicate not in task.derived:
            return self._belief.probability(atom)
        return self._belief.where(lambda state: atom in task.extend(state))

    def _weighs(self, atom: Atom, probability: float) -> tuple[float, float] | None:
        """How probable a reading is where the fact holds, and where not; None where it says
        nothing."""
        ratio = self.ratio(atom, probability)
        if ratio == 0.0:
            return None
        right = 1 / (1 + exp(-ratio))
        last, now = self._last.get(atom), self.probability(atom)
        if last is not None and last.settled:  # it would take that one's place
            if_true, if_false = last.weighed
            true, false = now / if_true, (1 - now) / if_false
            last, now = last.before, true / (true + false)
        if last is None:
            return right, 1 - right
        same = float(last.holds == (ratio > 0))
        # As little has changed as can have: what was as probable then is what it was.
        again_true = AGAIN * min(last.true / max(now, 1e-9), 1.0)
        again_false = AGAIN * min((1 - last.true) / max(1 - now, 1e-9), 1.0)
        return (
            again_true * same + (1 - again_true) * right,
            again_false * same + (1 - again_false) * (1 - right),
        )

    def _see(self, atom: Atom, if_true: float, if_false: float) -> None:
        belief = self._belief
        task = belief.model.task
        if atom.predicate not in task.derived:
            belief.see((atom,), if_true, if_false)
            return
        belief.weigh(lambda n: if_true if atom in task.extend(belief.model.state(n)) else if_false)
