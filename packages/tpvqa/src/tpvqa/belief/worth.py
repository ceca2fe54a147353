"""What the answers of a VLM are worth: how far to trust its words, and how its errors last."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tpvqa.belief.information import Floats, Mixture, Reliability
from tpvqa.belief.lasting import KINDS, NEVER, RECORDED, SHARES, Drawn
from tpvqa.belief.trust import GRID, Trust

SURE = 1e-9
"""Nothing is surer than this, so that what was impossible can be learnt of."""
ANSWERS = 40.0
"""Answers' worth of belief that they say as much as the calibration's rates of yes and no."""
_GRID = np.array(GRID)[:, None]
_ONE = np.ones((1, 1))
Pair = tuple[float, float]


@dataclass(slots=True)
class Heard:
    """What was heard of one question, from one view.

    Attributes:
        drawn: What is known of the scene's own answer.
        true: P(yes is right) by all that is told apart, after the answers of this scene; None
            where there was none yet.
        believed: The same as the belief had it after the last one.
    """

    drawn: Drawn = NEVER
    true: Floats | None = None
    believed: float = 0.5

    def changed(self, same: Pair, still: float) -> "Heard":
        """The same at a later scene, see `Drawn.after`."""
        return Heard(self.drawn.after(same, still))


@dataclass(frozen=True, slots=True)
class Said:
    """One answer.

    Attributes:
        yes: Whether it is a yes.
        ratio: Its log likelihood ratio, by the calibration.
        again: Probability that it only repeats the last one, where yes is right and where no is.
        same: Whether it is the last one again.
    """

    yes: bool
    ratio: float
    again: Pair = (0.0, 0.0)
    same: bool = False


class Worth:
    """A posterior over how far to trust answers (`Trust`), and how their errors last (`KINDS`).

    Both are learned from the answers alone: those that contradict the belief, or each other, are
    improbable where they can be trusted; those that contradict each other are where errors last.

    Args:
        trust: What is believed of the one beforehand; None to take the calibration at its word.
        lasting: What is believed of the other.
    """

    def __init__(self, trust: Trust | None = None, lasting: Sequence[float] = RECORDED):
        self.trust = trust
        self._grid = _ONE if trust is None else _GRID
        first = np.ones(1) if trust is None else np.array(trust.weights)
        last = np.array(lasting) / sum(lasting)
        self._weights: Floats = first[:, None] * last
        self._new: dict[Pair, Reliability] = {}
        self._by_words = self._by_answers = ANSWERS

    @property
    def lasting(self) -> tuple[float, ...]:
        """The probability of each of `KINDS`."""
        return tuple(self._weights.sum(axis=0).tolist())

    @property
    def share(self) -> float:
        """The expected lasting share."""
        return float(self._weights.sum(axis=0) @ SHARES)

    def expect(self, rates: Pair, heard: Heard | None, believed: float) -> Reliability:
        """What further answers will be.

        Args:
            rates: P(yes) where yes is right, and where no is, by the calibration.
            heard: What was heard of the question; None where it was never asked.
            believed: The probability that yes is right.
        """
        if heard is None:
            known = self._new.get(rates)
            if known is None:
                known = self._new[rates] = self._expected(rates, Heard(), believed)
            return known
        return self._expected(rates, heard, believed)

    def _expected(self, rates: Pair, heard: Heard, believed: float) -> Reliability:
        true = self._true(heard, believed)
        mixtures: list[Mixture] = []
        for now, rate in enumerate(self._rates(rates)):
            weights = self._weights * (true if now == 0 else 1 - true)
            weights = weights / weights.sum()
            own, by_rate = heard.drawn.own(now, rate) * weights, rate * weights
            mixture: list[Pair] = []
            for share, places in _BY_SHARE.items():
                weight = float(weights[:, places].sum())
                yes = float(own[:, places].sum())
                low = (1 - share) * float(by_rate[:, places].sum()) / max(weight, 1e-12)
                if share == 0.0:
                    mixture.append((weight, low))
                else:
                    mixture += [(yes, share + low), (weight - yes, low)]
            mixtures.append(tuple(mixture))
        return Reliability.mixed(mixtures[0], mixtures[1], 0.0)

    def _rates(self, rates: Pair) -> tuple[Floats, Floats]:
        """P(yes) of an answer drawn afresh: drawn towards one half as far as it cannot be
        trusted."""
        true, false = rates
        right = min(max((true + 1 - false) / 2, 0.501), 0.999)
        trusted = 1 / (1 + np.exp(-self._grid * np.log(right / (1 - right))))
        share = np.minimum((trusted - 0.5) / (right - 0.5), 1.0) if self.trust else _ONE
        share = share * min(self._by_answers / self._by_words, 1 / max(2 * right - 1, 0.1))
        return 0.5 + share * (true - 0.5), 0.5 + share * (false - 0.5)

    def _true(self, heard: Heard, believed: float) -> Floats:
        """P(yes is right) by all that is told apart."""
        if heard.true is None:
            return np.full(self._weights.shape, min(max(believed, SURE), 1 - SURE))
        # What else was heard since moves all of them alike.
        moved = _odds(believed) / _odds(heard.believed)
        odds = heard.true / (1 - heard.true) * moved
        return np.clip(odds / (1 + odds), SURE, 1 - SURE)

    def take(self, said: Said, heard: Heard, believed: float, rates: Pair) -> tuple[Pair, Heard]:
        """Learn from an answer.

        Args:
            said: It.
            rates: As those of `expect`.
            heard: What was heard of the question before.
            believed: The probability that yes was right.

        Returns:
            Probability of the answer where yes is right and where no is, and what is heard now;
            its `believed` is to be set once the belief was weighed.
        """
        self._compare(said, rates)
        right = 1 / (1 + np.exp(-self._grid * said.ratio))
        of_this = right, 1 - right
        of_yes = of_this if said.yes else (1 - right, right)
        true = self._true(heard, believed)
        likely: list[Floats] = []
        repeated: list[Floats] = []
        found: list[float] = []
        for now in (0, 1):
            own = heard.drawn.own(now, of_yes[now])
            own = own if said.yes else 1 - own
            drawn = SHARES * own + (1 - SHARES) * of_this[now]
            again = said.again[now] * said.same
            here = again + (1 - said.again[now]) * drawn
            weights = self._weights * (true if now == 0 else 1 - true)
            found.append(float((weights * here).sum() / max(weights.sum(), 1e-300)))
            likely.append(here)
            repeated.append(again / np.maximum(here, 1e-12))
        both = true * likely[0] + (1 - true) * likely[1]
        after = np.clip(true * likely[0] / both, SURE, 1 - SURE)
        if self.trust is not None:
            weights = np.maximum(self._weights * both, 1e-12)
            self._weights = weights / weights.sum()
            self.trust.weights = tuple(self._weights.sum(axis=1).tolist())
            self._new.clear()
        told = heard.drawn.told(said.yes, of_yes, (repeated[0], repeated[1]))
        return (found[0], found[1]), Heard(told, after)

    def _compare(self, said: Said, rates: Pair) -> None:
        """Note how much an answer says beside what the rates of yes and no make one expect: a VLM
        that gives its P(yes) may be less sure than it was."""
        yes, no = rates if said.yes else (1 - rates[0], 1 - rates[1])
        by_words = abs(yes - no) / (yes + no)
        self._by_words += by_words
        self._by_answers += min(abs(np.tanh(said.ratio / 2)), 1.0)


_BY_SHARE = {
    share: [place for place, kind in enumerate(KINDS) if kind.share == share]
    for share in dict.fromkeys(kind.share for kind in KINDS)
}


def _odds(probability: float) -> float:
    bounded = min(max(probability, SURE), 1 - SURE)
    return bounded / (1 - bounded)
