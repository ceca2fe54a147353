"""What P(yes) is worth: Platt scaling with partial pooling over ways of asking and predicates."""

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from math import erf, exp, pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.answers.bounds import EDGE
from tpvqa.belief.calibrating.calibration import Calibration, Curve
from tpvqa.belief.calibrating.counts import PSEUDO
from tpvqa.belief.calibrating.labelled_answer import LabelledAnswer
from tpvqa.errors import MissingExtraError
from tpvqa.questions.question import Way
from tpvqa.vlm.answer import Reply

Key = tuple[Way | None, str | None]
"""A group: way and predicate, a way alone, or all."""
WHOLE: Key = (None, None)
APART = (0.5, 0.3, 0.3)
"""How far the intercepts, slopes and signs of two groups are thought to lie apart: standard
deviations of the normal priors that an L2 penalty is. A way's curve is drawn around that of all, a
group's around its way's."""
SURE = 3.0
"""Standard errors from which on a user is told that yes and no seem to be swapped."""
_BOTH = {1, 2}
"""Slope and sign."""
_LOOSE = 10.0
"""Standard deviation of what all groups share; the default's pseudo-answers hold it."""


@dataclass(frozen=True, slots=True)
class Curves:
    """The curves by group, and what a user should know of them."""

    by_group: dict[Key, Curve]
    notices: tuple[str, ...] = ()

    def of(self, key: Key) -> Curve:
        """The curve of a group; its way's, or that of all, where it gave no P(yes)."""
        return next(
            self.by_group[each] for each in (key, (key[0], None), WHOLE) if each in self.by_group
        )


def fit_curves(answers: Sequence[LabelledAnswer]) -> Curves:
    """Fit the curves of all groups in one logistic regression.

    Truth on logit P(yes) and the reply's sign, with an intercept, a slope and a sign of its own for
    every way and group, under L2. In every group the answers are weighted so that yes is right as
    often as no: what is learnt are likelihood ratios, without the base rate; a group in which only
    one of the two ever was right tells none, and follows the others. `Calibration.default` counts
    as `PSEUDO` answers. A slope or a sign that points the wrong way is left out, and the rest
    fitted again: of dozens of groups one or two do so by chance, and hardly any VLM means no by
    yes. Where both are left out of a group, its words are worth what they are expected to be worth,
    given that it is not less than nothing: much where few answers say so, next to nothing where
    many do. The curve of a way, and that of all, is the mean of its groups'.

    Args:
        answers: Yes and no with their P(yes).

    Raises:
        MissingExtraError: scikit-learn is not installed.
    """
    groups: list[Key] = sorted({(row.way, row.predicate) for row in answers})
    ways: list[Key] = [(way, None) for way in sorted({row.way for row in answers})]
    place = {key: k for k, key in enumerate([*ways, *groups])}
    without: dict[Key, set[int]] = {}
    first = fitted = _fit(answers, place, without)
    while True:
        astray = {key: found for key in groups if (found := fitted[key].astray())}
        if not astray:
            break
        without = {key: without.get(key, set()) | astray.get(key, set()) for key in groups}
        fitted = _fit(answers, place, without)
    notices = [_swapped(key) for key, each in first.items() if each.gain < -SURE]
    curves = {
        key: Curve(slope=0.0, sign=first[key].least / 2)
        if without.get(key) == _BOTH
        else fitted[key].curve
        for key in groups
    }
    count: defaultdict[Key, float] = defaultdict(float)
    for row in answers:
        count[row.way, row.predicate] += row.weight
    for wider in (*ways, WHOLE):
        within = {key: count[key] for key in groups if wider[0] in (None, key[0])}
        curves[wider] = _mean(curves, within)
    return Curves(curves, tuple(notices))


def _mean(curves: Mapping[Key, Curve], rows: Mapping[Key, float]) -> Curve:
    """What an answer of a group that is not known is worth: as much as in those that are."""
    total = sum(rows.values())
    slope, intercept, sign = (
        sum(n * getattr(curves[key], name) for key, n in rows.items()) / total
        for name in ("slope", "intercept", "sign")
    )
    return Curve(slope=slope, intercept=intercept, sign=sign)


@dataclass(frozen=True, slots=True)
class _Fitted:
    """A group's curve.

    Attributes:
        curve: It.
        apart: By how much more its yeses speak for yes than its noes, in nats.
        error: The standard error of that.
    """

    curve: Curve
    apart: float = 0.0
    error: float = 0.0

    @property
    def gain(self) -> float:
        """By how much more its yeses speak for yes than its noes, in standard errors."""
        return self.apart / self.error if self.error else 0.0

    @property
    def least(self) -> float:
        """`apart` as it is expected, given that it is not negative: the mean of a normal
        distribution that is cut off at 0."""
        if self.gain < -8:
            return self.error / -self.gain
        density = exp(-(self.gain**2) / 2) / sqrt(2 * pi)
        return self.apart + self.error * density / ((1 + erf(self.gain / sqrt(2))) / 2)

    def astray(self) -> set[int]:
        """Which of intercept (0), slope (1) and sign (2) point the wrong way."""
        return {n for n, value in ((1, self.curve.slope), (2, self.curve.sign)) if value < 0}


def _swapped(key: Key) -> str:
    said = " ".join(str(part) for part in key if part is not None) or "all answers"
    return (
        f"{said}: yes is said more often, or more surely, where no is right. What points the wrong "
        "way is not counted; see that the question is not worded the other way round."
    )


def _fit(
    answers: Sequence[LabelledAnswer],
    place: dict[Key, int],
    without: Mapping[Key, Collection[int]],
) -> dict[Key, _Fitted]:
    """The curves by group.

    Args:
        answers: What they are fitted to.
        place: Numbers of the ways and groups.
        without: What is left out of a group's answers: slope (1), sign (2).
    """
    told, tells, weights = _default_answers()
    x = np.array([*tells, *(_logit(row.p_yes) for row in answers)])
    sign = np.array([*np.sign(tells), *(1 if row.reply is Reply.YES else -1 for row in answers)])
    truth = np.array([*told, *(row.truth for row in answers)], bool)
    weight = np.array([*weights, *_balance(answers)])
    terms = np.stack([np.ones(len(x)), x, sign], axis=1)
    for n, row in enumerate(answers, len(tells)):
        terms[n, list(without.get((row.way, row.predicate), ()))] = 0
    design = np.zeros((len(x), 3 + 3 * len(place)))
    design[:, :3] = _LOOSE * terms
    members: dict[Key, list[int]] = {WHOLE: list(range(len(x)))}
    for n, row in enumerate(answers, len(tells)):
        for part in ((row.way, None), (row.way, row.predicate)):
            column = 3 + 3 * place[part]
            design[n, column : column + 3] = APART * terms[n]
            members.setdefault(part, []).append(n)
    found = regression().fit(design, truth, sample_weight=weight).coef_[0]
    p = 1 / (1 + np.exp(-design @ found))
    curvature = design.T @ (design * (weight * p * (1 - p))[:, None]) + np.eye(design.shape[1])
    covariance = np.linalg.inv(curvature)
    fitted: dict[Key, _Fitted] = {}
    for key in (WHOLE, *place):
        parts = [_combination(key, place, which, design.shape[1]) for which in range(3)]
        own = members[key]
        yes, no = (terms[[n for n in own if sign[n] == said]] for said in (1, -1))
        apart = error = 0.0
        if len(yes) and len(no):
            vector = (yes.mean(axis=0) - no.mean(axis=0)) @ np.array(parts)
            apart = float(vector @ found)
            error = float(np.sqrt(vector @ covariance @ vector + 1e-12))
        intercept, slope, worth = (float(part @ found) for part in parts)
        left_out = without.get(key, set())
        if left_out == _BOTH:  # neither the word nor P(yes) tells anything
            intercept = 0.0
        curve = Curve(
            slope=0.0 if 1 in left_out else slope,
            intercept=intercept,
            sign=0.0 if 2 in left_out else worth,
        )
        fitted[key] = _Fitted(curve, apart, error)
    return fitted


def _combination(key: Key, place: dict[Key, int], which: int, columns: int) -> NDArray[np.float64]:
    """What of the coefficients makes up the intercept (0), slope (1) or sign (2) of a group."""
    vector = np.zeros(columns)
    vector[which] = _LOOSE
    for part in {(key[0], None), key} & set(place):
        vector[3 + 3 * place[part] + which] = APART[which]
    return vector


def _logit(p: float | None) -> float:
    assert p is not None
    p = min(max(p, EDGE), 1 - EDGE)
    return float(np.log(p / (1 - p)))


def _balance(answers: Sequence[LabelledAnswer]) -> list[float]:
    """Weights by which in every group yes is right as often as no.

    The sum of a group is that of its answers where they are in balance already, and about four
    times the rarer kind where they are not: more than that the rarer kind cannot tell.
    """
    count: defaultdict[tuple[Way, str, bool], float] = defaultdict(float)
    for row in answers:
        count[row.way, row.predicate, row.truth] += row.weight
    weights = []
    for row in answers:
        own = count[row.way, row.predicate, row.truth]
        other = count[row.way, row.predicate, not row.truth]
        weights.append(2 * other / (own + other) * row.weight)
    return weights


def _default_answers() -> tuple[list[bool], list[float], list[float]]:
    """Truths, logits and weights of the answers that stand for the default."""
    curve = Calibration.default().whole.curve
    assert curve is not None
    grid = [_logit(p / 10) for p in range(1, 10) if p != 5]
    truths, logits, weights = [], [], []
    for x in grid:
        right = float(1 / (1 + np.exp(-curve.slope * x)))
        for truth, share in ((True, right), (False, 1 - right)):
            truths.append(truth)
            logits.append(x)
            weights.append(PSEUDO * share / len(grid))
    return truths, logits, weights


def regression() -> Any:
    """The regression that `fit_curves` uses, not fitted.

    Raises:
        MissingExtraError: scikit-learn is not installed.
    """
    try:
        from sklearn.linear_model import LogisticRegression
    except ImportError as error:
        raise MissingExtraError("scikit-learn", "calibrate", "Learning a calibration") from error
    return LogisticRegression(C=1.0, fit_intercept=False, solver="newton-cholesky", max_iter=200)
