"""Heads on the frozen branch: what is in a real photograph, taught by photographs and kitchens.

Logistic regression, as photographs are few: on the branch's features, and on what ImageNet's own
classes say of the thing. Photographs and rendered kitchens weigh together, yes and no alike, so
that the odds are those of a thing that is there as often as not. Pictures with cut-outs pasted into
them teach a head where they make the photographs held back likelier.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tpvqa.errors import MissingExtraError
from tpvqa_household import DISTRIBUTION
from tpvqa_household.embedded.likeness import Floats
from tpvqa_household.teaching.logistic import even
from tpvqa_household.teaching.sureness import losses, slopes
from tpvqa_household.training.imagenet import CLASSES, Seen
from tpvqa_household.training.subjects import Subject

KITCHENS = 0.3
"""What the kitchens weigh, beside photographs that weigh 1."""
PASTED = 0.3
"""What pictures with cut-outs weigh."""
_CLASSES = 0.3
"""How large ImageNet's classes stand beside the features."""
_STRENGTH = 10.0
"""Inverse strength of the regularisation."""
_FOLDS = 5


@dataclass(frozen=True)
class Taught:
    """Pictures and what is true in them.

    Attributes:
        seen: By the frozen branch; of photographs several variants, one after the other.
        labels: n × heads: 1, 0, -1 for not known.
        groups: Of n photographs; n × k where pictures show something of several; none for kitchens.
    """

    seen: Seen
    labels: NDArray[np.int64]
    groups: NDArray[np.str_] = field(default_factory=lambda: np.array([], np.str_))


@dataclass(frozen=True)
class Heads:
    """Linear heads, their log odds made as sure as they were right on photographs held back.

    Attributes:
        features: Heads × features.
        classes: Heads × classes.
        bias: Of each head.
        held_back: n × heads, log odds of every photograph by heads that its group did not teach;
            nan where it has no label.
        helped: For each head the kind of pictures with cut-outs that teaches it, "" for none.
    """

    features: Floats
    classes: Floats
    bias: Floats
    held_back: NDArray[np.float64]
    helped: Sequence[str]


class _Space:
    """Features and classes on one scale, and back to the branch's own."""

    def __init__(self, photographs: Seen):
        self._mean, self._scale = photographs.features.mean(0), photographs.features.std(0) + 1e-2
        self._scale = self._scale * np.sqrt(photographs.features.shape[1])
        self._class_mean = photographs.classes.mean(0)
        self._class_scale = (photographs.classes.std(0) + 1e-3) / _CLASSES

    @staticmethod
    def columns(subject: Subject) -> list[int]:
        """Those of the classes that speak for what a fact says to be there."""
        thing = subject.arguments[0]
        if subject.name != "near" or thing not in CLASSES:
            return []
        first = 2 * list(CLASSES).index(thing)
        return [first, first + 1]

    def inputs(self, seen: Seen, subject: Subject) -> NDArray[np.float64]:
        features = (seen.features - self._mean) / self._scale
        classes = (seen.classes - self._class_mean) / self._class_scale
        joined = np.concatenate([features, classes[:, self.columns(subject)]], 1)
        return np.asarray(joined, np.float64)

    def outputs(
        self, weights: NDArray[np.float64], bias: float, subject: Subject
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
        """Weights and bias for what the branch gives."""
        count = len(self._mean)
        features = weights[:count] / self._scale
        classes = np.zeros(len(self._class_mean))
        columns = self.columns(subject)
        classes[columns] = weights[count:] / self._class_scale[columns]
        shift = float(features @ self._mean + classes @ self._class_mean)
        return features, classes, bias - shift


def taught(
    subjects: Sequence[Subject],
    photographs: Sequence[Taught],
    kitchens: Sequence[Taught],
    pasted: Mapping[str, Taught] | None = None,
) -> Heads:
    """Fit a head for every subject.

    Args:
        subjects: What the heads are about, the columns of all labels.
        photographs: The photographs as they are, then variants of the same ones, in order.
        kitchens: Rendered pictures.
        pasted: Kinds of pictures with cut-outs; each head takes what helps it most, or none.

    Raises:
        MissingExtraError: scikit-learn is not installed.
    """
    space, plain = _Space(photographs[0].seen), photographs[0]
    kinds = {"": None, **(pasted or {})}
    heads = {
        kind: [
            _Head(space, subject, i, photographs, kitchens, taught_by)
            for i, subject in enumerate(subjects)
        ]
        for kind, taught_by in kinds.items()
    }
    held = {kind: np.stack([head.held_back() for head in of], 1) for kind, of in heads.items()}
    loss = np.stack([losses(of, plain.labels) for of in held.values()])
    helped = [list(kinds)[best] for best in loss.argmin(0)]
    rows = [heads[kind][i] for i, kind in enumerate(helped)]
    held_back = np.stack([held[kind][:, i] for i, kind in enumerate(helped)], 1)
    slope = slopes(held_back, plain.labels)
    parts = [space.outputs(*row.fit(None), row.subject) for row in rows]
    features, classes, bias = (np.stack(each) for each in zip(*parts, strict=True))
    return Heads(
        (features * slope[:, None]).astype(np.float32),
        (classes * slope[:, None]).astype(np.float32),
        (bias * slope).astype(np.float32),
        held_back * slope,
        helped,
    )


class _Head:
    def __init__(
        self,
        space: _Space,
        subject: Subject,
        column: int,
        photographs: Sequence[Taught],
        kitchens: Sequence[Taught],
        pasted: Taught | None,
    ):
        self.subject = subject
        self._photographs = [space.inputs(each.seen, subject) for each in photographs]
        self._labels = photographs[0].labels[:, column]
        self._groups = photographs[0].groups
        self._kitchens = np.concatenate([space.inputs(each.seen, subject) for each in kitchens])
        self._kitchen_labels = np.concatenate([each.labels[:, column] for each in kitchens])
        self._pasted = None
        if pasted is not None:
            inputs = space.inputs(pasted.seen, subject)
            self._pasted = (inputs, pasted.labels[:, column], pasted.groups)

    def fit(self, left_out: NDArray[np.str_] | None) -> tuple[NDArray[np.float64], float]:
        """Weights and bias, without some groups of photographs."""
        try:
            from sklearn.linear_model import LogisticRegression
        except ImportError as error:
            raise MissingExtraError(
                "scikit-learn", "train", "Fitting heads", distribution=DISTRIBUTION
            ) from error
        labelled = self._labels >= 0
        if left_out is not None:
            labelled &= ~np.isin(self._groups, left_out)
        rendered = self._kitchen_labels >= 0
        of_photographs = np.tile(self._labels[labelled], len(self._photographs))
        of_kitchens = self._kitchen_labels[rendered]
        x = [*(each[labelled] for each in self._photographs), self._kitchens[rendered]]
        y, count = [of_photographs, of_kitchens], int(labelled.sum())
        weight = [even(of_photographs, count), even(of_kitchens, KITCHENS * count)]
        if self._pasted is not None:
            inputs, labels, groups = self._pasted
            told = labels >= 0
            if left_out is not None:
                told &= ~np.isin(groups, left_out).any(1)
            x.append(inputs[told])
            y.append(labels[told])
            weight.append(even(labels[told], PASTED * count))
        model = LogisticRegression(C=_STRENGTH, max_iter=3000).fit(
            np.concatenate(x), np.concatenate(y), sample_weight=np.concatenate(weight)
        )
        return model.coef_[0], float(model.intercept_[0])

    def held_back(self) -> NDArray[np.float64]:
        """Log odds of each photograph from heads that its group did not teach."""
        found = np.full(len(self._labels), np.nan)
        groups = np.unique(self._groups[self._labels >= 0])
        for fold in range(_FOLDS):
            left_out = groups[fold::_FOLDS]
            out = np.isin(self._groups, left_out) & (self._labels >= 0)
            left = self._labels[(self._labels >= 0) & ~out]
            if not out.any() or len(set(left.tolist())) < 2:
                continue
            weights, bias = self.fit(left_out)
            found[out] = self._photographs[0][out] @ weights + bias
        return found
