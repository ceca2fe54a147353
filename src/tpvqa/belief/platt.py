"""What P(yes) is worth: Platt scaling with partial pooling over ways of asking and predicates."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.calibration import EDGE, Calibration, Curve
from tpvqa.belief.counts import PSEUDO
from tpvqa.belief.labelled_answer import LabelledAnswer
from tpvqa.errors import MissingExtraError
from tpvqa.questions.question import Way
from tpvqa.vlm.answer import Reply

Key = tuple[Way | None, str | None]
"""A group: way and predicate, a way alone, or all."""
WHOLE: Key = (None, None)
INTERCEPT, SLOPE = 0.5, 0.3
"""How far the curves of two groups are thought to lie apart: standard deviations of the normal
priors that an L2 penalty is. A way's curve is drawn around that of all, a group's around its
way's."""
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

    Truth on logit P(yes) and the reply's sign, with an intercept and a slope of its own for every
    way and group, under L2. In every group the answers are weighted so that yes is right as often
    as no: what is learnt are likelihood ratios, without the base rate; a group in which only one
    of the two ever was right tells none, and follows the others. `Calibration.default` counts as
    `PSEUDO` answers.

    Args:
        answers: Yes and no with their P(yes).

    Raises:
        MissingExtraError: scikit-learn is not installed.
    """
    groups: list[Key] = sorted({(row.way, row.predicate) for row in answers})
    ways: list[Key] = [(way, None) for way in sorted({row.way for row in answers})]
    place = {key: k for k, key in enumerate([*ways, *groups])}
    curves, errors = _fit(answers, place, with_sign=True)
    if curves[WHOLE].sign < 0:  # a yes would be worth less than a no of the same P(yes)
        curves, errors = _fit(answers, place, with_sign=False)
    notices = []
    for key, curve in curves.items():
        if curve.slope >= 0:
            continue
        if curve.slope < -2 * errors[key]:
            notices.append(
                f"{_said(key)}: P(yes) is higher where no is right (slope {curve.slope:.2f} ± "
                f"{errors[key]:.2f}); its answers are taken the other way round."
            )
        else:
            curves[key] = curve.model_copy(update={"slope": 0.0})
    return Curves(curves, tuple(notices))


def _said(key: Key) -> str:
    return " ".join(str(part) for part in key if part is not None) or "all answers"


def _fit(
    answers: Sequence[LabelledAnswer], place: dict[Key, int], *, with_sign: bool
) -> tuple[dict[Key, Curve], dict[Key, float]]:
    """The curves by group, and the standard errors of their slopes."""
    told, tells, weights = _default_answers()
    x = np.array([*tells, *(_logit(row.p_yes) for row in answers)])
    sign = np.array([*np.sign(tells), *(1 if row.reply is Reply.YES else -1 for row in answers)])
    truth = np.array([*told, *(row.truth for row in answers)], bool)
    weight = np.array([*weights, *_balance(answers)])
    design = np.zeros((len(x), 3 + 2 * len(place)))
    design[:, 0], design[:, 1] = _LOOSE, _LOOSE * x
    design[:, 2] = _LOOSE * sign if with_sign else 0
    for n, row in enumerate(answers, len(tells)):
        for part in ((row.way, None), (row.way, row.predicate)):
            column = 3 + 2 * place[part]
            design[n, column], design[n, column + 1] = INTERCEPT, SLOPE * x[n]
    found = regression().fit(design, truth, sample_weight=weight).coef_[0]
    p = 1 / (1 + np.exp(-design @ found))
    curvature = design.T @ (design * (weight * p * (1 - p))[:, None]) + np.eye(design.shape[1])
    covariance = np.linalg.inv(curvature)
    curves: dict[Key, Curve] = {}
    errors: dict[Key, float] = {}
    for key in (WHOLE, *place):
        intercept, slope = (_combination(key, place, which, design.shape[1]) for which in (0, 1))
        curves[key] = Curve(
            slope=float(slope @ found),
            intercept=float(intercept @ found),
            sign=float(_LOOSE * found[2]) if with_sign else 0.0,
        )
        errors[key] = float(np.sqrt(slope @ covariance @ slope))
    return curves, errors


def _combination(key: Key, place: dict[Key, int], which: int, columns: int) -> NDArray[np.float64]:
    """What of the coefficients makes up the intercept (0) or slope (1) of a group."""
    vector = np.zeros(columns)
    vector[which] = _LOOSE
    for part in {(key[0], None), key} & set(place):
        vector[3 + 2 * place[part] + which] = (INTERCEPT, SLOPE)[which]
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
    count = Counter((row.way, row.predicate, row.truth) for row in answers)
    weights = []
    for row in answers:
        own = count[row.way, row.predicate, row.truth]
        other = count[row.way, row.predicate, not row.truth]
        weights.append(2 * other / (own + other))
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
        raise MissingExtraError("scikit-learn", "bench", "Learning a calibration") from error
    return LogisticRegression(C=1.0, fit_intercept=False, solver="newton-cholesky", max_iter=200)
