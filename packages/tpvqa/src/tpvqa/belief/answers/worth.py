"""What the answers of a VLM are worth: how far to trust its words, and how its errors last."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.answers.bounds import EDGE
from tpvqa.belief.answers.heard import Drawn, Heard, after_answer, own
from tpvqa.belief.answers.information import Floats, Mixture, Reliability
from tpvqa.belief.answers.kinds import KINDS, RECORDED
from tpvqa.belief.answers.lasting import (
    DISPERSED,
    EVERY,
    SHARES,
    STAYS,
    SUREST,
    Columns,
    fresh_rate,
    own_rate,
)
from tpvqa.belief.answers.led import Places
from tpvqa.belief.answers.trust import GRID, Trust

SURE = 1e-9
"""Nothing is surer than this, so that what was impossible can be learnt of."""
SLIGHT = 1e-6
"""What is told apart of the noise and is less probable counts for nothing in what is expected."""
LASTS = 1e-3
"""Where errors last with a smaller probability, what was heard says nothing of another scene."""
ANSWERS = 40.0
"""Answers' worth of belief that they say as much as the calibration's rates of yes and no."""
Pair = tuple[float, float]
_NONE = np.zeros(1), np.zeros(1)
_EITHER = np.array([True, False])


@dataclass(frozen=True, slots=True)
class Cases:
    """What may be the case when a question is asked, jointly with how the VLM errs.

    Attributes:
        mass: Probability of each case (row) with everything that is told apart of the noise.
        truth: Whether yes is right, in each case.
        drawn: What is known of the scene's own answer.
        columns: Of which of all that is told apart of the noise; the rest is left out.
    """

    mass: Floats
    truth: NDArray[np.bool_]
    drawn: Drawn
    columns: Columns = field(default_factory=lambda: EVERY)

    def elsewhere(self, stays: Floats) -> "Cases":
        """What may be the case when it is asked in another scene; see `Drawn.elsewhere`."""
        return replace(self, drawn=self.drawn.elsewhere(stays[self.columns]))

    def either_way(self, heard: Heard) -> "Cases":
        """The two cases that yes is right and that no is, each taken to be so, by what was said in
        this scene.

        Args:
            heard: What was heard of the question.
        """
        _, drawn = self._averaged(EVERY)
        present = np.array([self.truth.any(), not self.truth.all()])
        mass = np.stack([self.mass.sum(axis=0)] * 2)
        return Cases(mass, _EITHER, heard.begun(present, drawn), self.columns)

    def standing_for(self, places: Places, columns: Columns) -> "Cases":
        """The two cases that yes is right and that no is, for what is left out of these.

        Args:
            places: Which of the columns here stand for it.
            columns: What is left out.
        """
        kinds, index = np.unique(places, return_inverse=True)
        weights, drawn = self._averaged(kinds)
        weights = weights / weights.sum(axis=0)
        return Cases(weights[:, index], _EITHER, drawn.only(index), columns)

    def _averaged(self, columns: Columns) -> tuple[Floats, Drawn]:
        """How probable it is that yes is right and that no is, and what is known of the scene's own
        answer then: two rows of some columns."""
        where, drawn = np.array([self.truth, ~self.truth], float), self.drawn
        mass = self.mass[:, columns]
        weights = np.maximum(where @ mass, 1e-300)
        yes, new = (where @ (mass * each[:, columns]) / weights for each in (drawn.yes, drawn.new))
        rows = where * self.mass.sum(axis=1)
        once = rows @ np.stack([drawn.kept, drawn.answers, drawn.yeses], axis=1)
        once /= np.maximum(rows.sum(axis=1, keepdims=True), 1e-300)
        return weights, Drawn(yes, new, *once.T)


@dataclass(frozen=True, slots=True)
class Said:
    """One answer.

    Attributes:
        yes: Whether it is a yes.
        ratio: Its log likelihood ratio, by the calibration.
        repeats: How often an answer only repeats the last one where the fact is what it was.
        same: Whether it is the last one again.
    """

    yes: bool
    ratio: float
    repeats: float = 0.0
    same: bool = False


@dataclass(frozen=True, slots=True)
class Taken:
    """What an answer came to.

    Attributes:
        likely: Its probability in each case, for everything that is told apart of the noise.
        whole: Its probability where yes is right and where no is.
        drawn: What is known of the scene's own answer now.
        first: P(yes) of the scene's own answer before it is drawn.
    """

    likely: Floats
    whole: Pair
    drawn: Drawn
    first: Floats


class Worth:
    """A posterior over how far to trust answers (`Trust`), and how their errors last (`KINDS`).

    Both are learned from the answers alone: those that contradict the belief, or each other, are
    improbable where they can be trusted; those that contradict each other are where errors last.

    Args:
        trust: What is believed of the one beforehand; None to take the calibration at its word.
        lasting: What is believed of the other.

    Attributes:
        stays: `Kind.stays` of everything that is told apart.
        shares: `Kind.share` likewise.
    """

    def __init__(self, trust: Trust | None = None, lasting: Sequence[float] = RECORDED):
        self.trust = trust
        first = np.ones(1) if trust is None else np.array(trust.weights)
        last = np.array(lasting) / sum(lasting)
        self._grid = np.repeat((1.0,) if trust is None else GRID, len(KINDS))
        self.shares, self.stays = (np.tile(each, len(first)) for each in (SHARES, STAYS))
        told = [(kind.share, kind.coin) for kind in KINDS] * len(first)
        distinct = tuple(dict.fromkeys(told))
        self._groups = np.array([[float(each == other) for other in distinct] for each in told])
        self._distinct = np.array([share for share, _ in distinct])
        self._counts = np.array([share > 0 and not coin for share, coin in told])
        self._weights: Floats = np.outer(first, last).ravel()
        self._new: dict[Pair, Reliability] = {}
        self._told: dict[Pair, tuple[Floats, Floats, Floats]] = {}
        self._by_words = self._by_answers = np.full_like(self._grid, ANSWERS)
        self._as_said = int(np.argmin(abs(self._grid - 1.0)))

    @property
    def weights(self) -> Floats:
        """The probability of every factor of `trust.GRID` with each of `KINDS`, these varying
        first; of the kinds alone where the calibration is taken at its word."""
        return self._weights

    def believe(self, weights: Floats) -> None:
        """Take over what is believed of the noise."""
        if self.trust is not None and weights is not self._weights:
            self._weights = weights
            by_trust = weights.reshape(-1, len(KINDS)).sum(axis=1)
            self.trust.weights = tuple(by_trust.tolist())
            self._new.clear()

    @property
    def lasting(self) -> tuple[float, ...]:
        """The probability of each of `KINDS`."""
        return tuple(self._weights.reshape(-1, len(KINDS)).sum(axis=0).tolist())

    @property
    def share(self) -> float:
        """The expected lasting share."""
        return float(self._weights @ self.shares)

    @property
    def nothing(self) -> float:
        """The probability that answers are worth nothing; 0 where that is not learned."""
        return 0.0 if self.trust is None else self.trust.weights[0]

    @property
    def lasts(self) -> bool:
        """Whether errors may last at all, as far as is worth a thought."""
        return float(self._weights[self.shares > 0].sum()) > LASTS

    def expect(self, rates: Pair, cases: Cases | None = None) -> Reliability:
        """What further answers will be.

        Args:
            rates: P(yes) where yes is right, and where no is, by the calibration.
            cases: What may be the case; None where the question was never asked.
        """
        if cases is not None:
            return self.expect_all([(rates, cases)])[0]
        known = self._new.get(rates)
        if known is None:
            told = tuple(each[None] for each in self._rates_of(rates))
            known = self._new[rates] = self._expected(told, None, EVERY)[0]
        return known

    def expect_all(self, asked: Sequence[tuple[Pair, Cases]]) -> list[Reliability]:
        """What further answers to several questions will be; their cases are told apart alike.

        Args:
            asked: For each the arguments of `expect`.
        """
        if not asked:
            return []
        columns = asked[0][1].columns
        rates = zip(*(self._rates_of(each) for each, _ in asked), strict=True)
        told = tuple(np.array(each)[..., columns] for each in rates)
        return self._expected(told, np.array([_aggregated(cases) for _, cases in asked]), columns)

    def _expected(
        self, told: Sequence[Floats], known: Floats | None, columns: Columns
    ) -> list[Reliability]:
        """What is expected of answers to several questions.

        Args:
            told: `_rates_of` each, shape (questions, 2, columns).
            known: `_aggregated` of each, shape (questions, 5, 2, columns); None where none was
                asked.
            columns: Those that are told apart.
        """
        believed, counts, groups = (
            each[columns] for each in (self._weights, self._counts, self._groups)
        )
        rate, yes, fresh = told
        weights = np.broadcast_to(believed, rate.shape)
        if known is not None:
            mass, drawn, new, prior, seen = known.swapaxes(0, 1)
            slight = SURE * believed
            weights = mass + slight
            whole = np.maximum(weights, 1e-300)
            yes = (drawn + new * yes + slight * yes) / whole
            fresh = np.where(counts, (prior * rate + seen + slight * fresh) / whole, fresh)
        weights = weights / weights.sum(axis=-1, keepdims=True)
        together, low, said = (each @ groups for each in (weights, weights * fresh, weights * yes))
        low = (1 - self._distinct) * low / np.maximum(together, 1e-12)
        shares = np.broadcast_to(self._distinct, together.shape)
        parts = np.stack([shares, together, low, said], axis=-1).tolist()
        return [Reliability.mixed(_mixture(true), _mixture(false), 0.0) for true, false in parts]

    def _rates_of(self, rates: Pair) -> tuple[Floats, Floats, Floats]:
        """P(yes) of an answer, of the scene's own one, and of one drawn afresh, as long as none
        has come: where yes is right, and where no is."""
        known = self._told.get(rates)
        if known is None:
            every = np.stack(self._rates(rates))
            known = self._told[rates] = every, own_rate(every), fresh_rate(every, *_NONE)
        return known

    def _rates(self, rates: Pair) -> tuple[Floats, Floats]:
        """P(yes) of an answer drawn afresh: drawn towards one half as far as it cannot be
        trusted. More than the calibration says, or the answers themselves, is not expected."""
        true, false = rates
        right = min(max((true + 1 - false) / 2, 0.501), 0.999)
        share: Floats = np.ones_like(self._grid)
        if self.trust is not None:
            share = _says(self._grid, np.log(right / (1 - right))) / (2 * right - 1)
        told = self._by_answers / self._by_words
        share = np.minimum(share * told, max(1.0, told[self._as_said]))
        yes, no = (np.clip(0.5 + share * (each - 0.5), SUREST, 1 - SUREST) for each in rates)
        return yes, no

    def take(self, said: Said, cases: Cases, rates: Pair) -> Taken:
        """What an answer says.

        Args:
            said: It.
            cases: What may be the case.
            rates: As those of `expect`.
        """
        columns, drawn = cases.columns, cases.drawn
        shares = self.shares[columns]
        right = 1 / (1 + np.exp(-self._grid[columns] * said.ratio))
        of_yes = np.array([right, 1 - right] if said.yes else [1 - right, right])
        where = np.where(cases.truth, 0, 1)
        first, of_yes = own_rate(of_yes, columns)[where], of_yes[where]
        own_yes = own(drawn, first)
        of_yes = fresh_rate(of_yes, drawn.answers[:, None], drawn.yeses[:, None], columns)
        this, fresh = (own_yes, of_yes) if said.yes else (1 - own_yes, 1 - of_yes)
        repeats = said.repeats * drawn.kept[:, None]
        again = repeats * said.same
        likely = again + (1 - repeats) * (shares * this + (1 - shares) * fresh)
        repeated = again / np.maximum(likely, 1e-12)
        told = after_answer(said.yes, own_yes, of_yes, repeated, columns)
        probable = (cases.mass * likely).sum(axis=1)
        whole = []
        for true in (True, False):
            there = cases.truth == true
            whole.append(float(probable[there].sum() / max(cases.mass[there].sum(), 1e-300)))
        answers, yeses = drawn.answers + 1, drawn.yeses + said.yes
        drawn = Drawn(told, np.zeros_like(told), np.ones_like(drawn.kept), answers, yeses)
        return Taken(likely, (whole[0], whole[1]), drawn, first)

    def compare(self, said: Said, rates: Pair) -> None:
        """Note how much an answer says beside what the rates of yes and no make one expect: a VLM
        that gives its P(yes) may be less sure than it was."""
        if self.trust is None:
            return
        yes, no = rates if said.yes else (1 - rates[0], 1 - rates[1])
        yes, no = max(yes, EDGE), max(no, EDGE)
        self._by_words = self._by_words + _says(self._grid, abs(np.log(yes / no)))
        self._by_answers = self._by_answers + _says(self._grid, abs(said.ratio))
        self._new.clear()
        self._told.clear()


def _aggregated(cases: Cases) -> Floats:
    """Sums over the cases in which yes is right and in which no is, for everything told apart: of
    their mass; of it where the scene's own answer is a yes, and not drawn yet; of the shares by
    which the rate of those drawn afresh is known beforehand, and from answers; shape (5, 2,
    columns)."""
    truth, drawn, mass = cases.truth, cases.drawn, cases.mass
    size = mass.shape[1]
    where = np.array([truth, ~truth], float)
    prior = DISPERSED / (DISPERSED + drawn.answers)
    seen = prior * drawn.yeses / DISPERSED
    once = np.concatenate([where, where * prior, where * seen])
    found = once @ np.concatenate([mass, mass * drawn.yes, mass * drawn.new], axis=1)
    told = found.reshape(3, 2, 3, size)
    return np.array([told[0, :, 0], told[0, :, 1], told[0, :, 2], told[1, :, 0], told[2, :, 0]])


def _mixture(parts: Sequence[Sequence[float]]) -> Mixture:
    """What several answers come to.

    Args:
        parts: Of each lasting share: it, how probable it is, P(yes) of its answers drawn afresh
            times what does not last, and how probable it is with an own answer that is a yes.
    """
    found: list[Pair] = []
    for share, weight, afresh, own_yes in parts:
        if share == 0.0:
            found.append((weight, afresh))
        elif weight > 0.0:
            found += [(own_yes, share + afresh), (weight - own_yes, afresh)]
    return tuple(found)


def by_truth(weights: Floats, true: float | Floats, drawn: Drawn) -> Cases:
    """The cases that yes is right and that no is.

    Args:
        weights: What is believed of the noise.
        true: The probability that yes is right, for everything that is told apart of it.
        drawn: What is known of the scene's own answer in the one, and the other.
    """
    true = np.clip(true, SURE, 1 - SURE)
    return Cases(np.stack([weights * true, weights * (1 - true)]), np.array([True, False]), drawn)


def moved(true: Floats | None, before: float, now: float) -> float | Floats:
    """P(yes is right) by all that is told apart, as moved by what else was heard since.

    Args:
        true: After the last answer; None where it was never asked.
        before: What was believed of the fact then.
        now: What is believed of it now.
    """
    if true is None:
        return now
    odds = true / (1 - true) * _odds(now) / _odds(before)
    found: Floats = np.clip(odds / (1 + odds), SURE, 1 - SURE)
    return found


def _says(trusted: Floats, ratio: float) -> Floats:
    """How far answers with a log likelihood ratio say yes or no: 0 not at all, 1 for certain.

    Args:
        trusted: Factors of the ratio.
        ratio: It.
    """
    found: Floats = np.tanh(trusted * ratio / 2)
    return found


def _odds(probability: float) -> float:
    bounded = min(max(probability, SURE), 1 - SURE)
    return bounded / (1 - bounded)
