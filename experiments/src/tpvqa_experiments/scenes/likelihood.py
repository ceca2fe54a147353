"""How likely the answers of a VLM are in every arrangement: learned from scenes with their truth.

Of every fact the log odds of a yes are a sum over its features (`features`). Weights are fitted to
all VLMs together, then to each VLM around those (a hierarchical model, by most probable weights),
so that a VLM of which little is known is taken to be as all are.
"""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tpvqa_experiments.scenes.arrangements import Shape, arrangements
from tpvqa_experiments.scenes.features import OWN_WIDTHS, WIDTHS, Rows, Vocabulary
from tpvqa_experiments.scenes.recorded import PREDICATES, Scene
from tpvqa_experiments.scenes.ridge import Array, logistic
from tpvqa_experiments.scenes.situations import looks

LATER = 0.5
"""How much a scene from the midst of a run counts beside one before the first action."""
MOST_ODDS = 6.0
"""No answer is taken to be surer than this, in log odds."""
Evidence = NDArray[np.float32]
"""Log likelihood of a scene's answers by predicate and arrangement; (3, arrangements)."""


@dataclass(slots=True)
class Encoder:
    """The features of every fact, worked out once for all scenes with the same blocks.

    All scenes that are to be learned from or judged are given at once, so that every weight has
    its place before the first is learned.
    """

    vocabulary: Vocabulary = field(default_factory=Vocabulary)
    _rows: dict[tuple[Shape, tuple[str, ...]], list[Rows]] = field(default_factory=dict)

    @classmethod
    def of(cls, scenes: Iterable[Scene]) -> "Encoder":
        """One that knows the features of these scenes."""
        found = cls()
        for scene in scenes:
            found.rows(scene)
        return found

    @property
    def size(self) -> int:
        """How many features there are."""
        return len(self.vocabulary.places)

    def rows(self, scene: Scene) -> list[Rows]:
        """Of every fact, the features of its situations."""
        key = scene.shape, scene.blocks
        if key not in self._rows:
            self._rows[key] = [
                self.vocabulary.rows(look, scene.shape, scene.blocks) for look in looks(scene.shape)
            ]
        return self._rows[key]

    def true_rows(self, scene: Scene, across: int) -> Rows:
        """The features of every fact as it is in truth, filled up to one width."""
        found = np.full((len(scene.answers), across), self.size)
        for place, (look, rows) in enumerate(
            zip(looks(scene.shape), self.rows(scene), strict=True)
        ):
            own = rows[look.of[scene.truth]]
            found[place, : len(own)] = own
        return found


def learn(scenes: Sequence[Scene], encoder: Encoder) -> dict[str, Array]:
    """The weights of every VLM that answered some of the scenes."""
    across = max(rows.shape[1] for scene in scenes for rows in encoder.rows(scene))
    sizes = [len(scene.answers) for scene in scenes]
    answers = np.concatenate([scene.answers for scene in scenes])
    rows = _Rows(
        present=np.concatenate([encoder.true_rows(scene, across) for scene in scenes]),
        predicate=np.concatenate([predicates(scene.shape) for scene in scenes]),
        yes=(answers == 1).astype(float),
        # An abstention says neither yes nor no.
        counts=np.repeat(weights_of(scenes), sizes) * (answers >= 0),
    )
    models = np.repeat([scene.model for scene in scenes], sizes)
    vocabulary = encoder.vocabulary
    common = rows.fitted(np.zeros(encoder.size), vocabulary.widths(WIDTHS))
    own_widths = vocabulary.widths(OWN_WIDTHS)
    return {
        model: rows.of(models == model).fitted(common, own_widths)
        for model in sorted(set(models.tolist()))
    }


@dataclass(frozen=True, slots=True)
class _Rows:
    """Answers to learn from: their features, their predicates, and how much each counts."""

    present: Rows
    predicate: Rows
    yes: Array
    counts: Array

    def of(self, chosen: NDArray[np.bool_]) -> "_Rows":
        return _Rows(*(getattr(self, name)[chosen] for name in self.__slots__))

    def fitted(self, mean: Array, width: Array) -> Array:
        # No feature belongs to two predicates, so they are fitted one after the other.
        for predicate in range(len(PREDICATES)):
            own = self.of(self.predicate == predicate)
            mean = logistic(own.present, own.yes, own.counts, mean=mean, width=width)
        return mean


def predicates(shape: Shape) -> Rows:
    """The place in `PREDICATES` of every fact's own."""
    return np.array([PREDICATES.index(look.predicate) for look in looks(shape)], np.int64)


def weights_of(scenes: Sequence[Scene]) -> Array:
    """How much each scene counts: one VLM's first looks at one picture count as one together."""
    looks_at = Counter((scene.model, scene.problem) for scene in scenes if scene.look == 0)
    return np.array(
        [LATER if scene.look else 1 / looks_at[scene.model, scene.problem] for scene in scenes]
    )


def evidence(scene: Scene, encoder: Encoder, weights: Mapping[str, Array]) -> Evidence:
    """How likely a scene's answers are in every arrangement, by predicate."""
    own = weights[scene.model]
    found = np.zeros((len(PREDICATES), len(arrangements(scene.shape).column)), np.float32)
    for look, rows, answer in zip(
        looks(scene.shape), encoder.rows(scene), scene.answers, strict=True
    ):
        if answer >= 0:
            odds = np.clip(own[rows].sum(axis=1), -MOST_ODDS, MOST_ODDS)
            said = -np.logaddexp(0.0, -odds if answer else odds)
            found[PREDICATES.index(look.predicate)] += said.astype(np.float32)[look.of]
    return found
