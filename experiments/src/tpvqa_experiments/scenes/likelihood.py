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
    counts = weights_of(scenes)
    present = np.concatenate([encoder.true_rows(scene, across) for scene in scenes])
    answers = np.concatenate([scene.answers for scene in scenes])
    sizes = [len(scene.answers) for scene in scenes]
    # An abstention says neither yes nor no.
    counted = np.repeat(counts, sizes) * (answers >= 0)
    models = np.repeat([scene.model for scene in scenes], sizes)
    yes = (answers == 1).astype(float)
    vocabulary = encoder.vocabulary
    common = logistic(
        present, yes, counted, mean=np.zeros(encoder.size), width=vocabulary.widths(WIDTHS)
    )
    found = {}
    for model in sorted(set(models.tolist())):
        own = models == model
        found[model] = logistic(
            present[own], yes[own], counted[own], mean=common, width=vocabulary.widths(OWN_WIDTHS)
        )
    return found


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
