"""`tpvqa train embedded`: the small network learns a user's own questions about their pictures."""

import json
from collections.abc import Callable, Sequence
from importlib.metadata import version
from pathlib import Path

import numpy as np

from tpvqa.errors import TrainingError, WriteError
from tpvqa.files import write_whole
from tpvqa.training.example import Example
from tpvqa.training.protocol import TrainingSettings
from tpvqa.vlm.metrics import auroc
from tpvqa_household import DISTRIBUTION
from tpvqa_household.embedded.sessions import Sessions
from tpvqa_household.embedded.taught.folder import Taught
from tpvqa_household.embedded.weights import FROZEN, Weights
from tpvqa_household.teaching.glimpses import glimpses, views_of
from tpvqa_household.teaching.heads import Fit, fit_heads, folds_of
from tpvqa_household.teaching.kinds import FALSE_ALARMS, known_pictures
from tpvqa_household.teaching.lessons import Lessons, lessons_of

_ROOM = "Make room, or name another folder with --out"
_ONE_GROUP = (
    "all pictures that were learnt from are of one group: how sure answers may be was learnt from "
    "pictures of the same group, and may be too much for others"
)
_WEAK = 0.65
"""The AUROC below which a question is hardly learnt."""


class EmbeddedTrainer:
    """Fits a linear head for every question on the frozen branch of the embedded network.

    The branch is as ImageNet left it and knows nothing of any domain. Each picture goes through it
    whole and in nine parts; where pictures are few also as another camera might have taken it, in
    all at most as often as `epochs` says. Heads are logistic regression with yes and no weighing
    the same, so that P(yes) is that of a thing that is there as often as not. How far they are
    regularised, and how sure they may be, is learnt from pictures that did not teach them.

    Of the settings of a training it knows seed and epochs.

    Attributes:
        notices: What could not be learnt, or hardly; after `fit`.
    """

    def __init__(self) -> None:
        self.notices: Sequence[str] = ()
        self._taught: Taught | None = None

    @classmethod
    def from_spec(cls, arguments: str = "") -> "EmbeddedTrainer":
        """Make it from `embedded`.

        Raises:
            TrainingError: A folder is named.
        """
        if arguments:
            raise TrainingError(
                f"embedded:{arguments} cannot be taught more. Teach 'embedded' again, with all "
                "pictures together: it takes seconds"
            )
        return cls()

    def fit(
        self,
        examples: Sequence[Example],
        folder: Path,
        *,
        settings: TrainingSettings,
        progress: Callable[[int, int], None],
    ) -> None:
        """See `Trainer`; steps are views of pictures, and then questions."""
        lessons = lessons_of(examples)
        network = Weights.read()
        branch = Sessions(network, threads=1)
        views = views_of(len(lessons.pictures), settings.epochs)
        seen = views * len(lessons.pictures)
        total = seen + len(lessons.questions)
        progress(0, total)
        features, kinds = glimpses(
            branch,
            lessons.pictures,
            folder,
            views=views,
            seed=settings.seed,
            done=lambda done: progress(done, total),
        )

        def one() -> None:
            nonlocal seen
            seen += 1
            progress(seen, total)

        groups = lessons.groups
        alone = len(set(groups.tolist())) == 1
        held = np.arange(len(groups)).astype(str) if alone else groups
        fit = fit_heads(features, lessons.labels, held, seed=settings.seed, done=one)
        areas = _areas(fit, lessons)
        self.notices = [*([_ONE_GROUP] if alone else []), *_notices(lessons, areas)]
        self._taught = Taught(
            tuple(lessons.questions),
            fit.weights,
            fit.bias,
            known_pictures(kinds, folds_of(held, settings.seed)),
            lessons.unlearnt,
            str(network.description["sha256"][FROZEN]),
            {
                "made_by": f"{DISTRIBUTION} {version(DISTRIBUTION)}",
                "seed": settings.seed,
                "views": views,
                "pictures": len(lessons.pictures),
                "groups": len(set(groups.tolist())),
                "false_alarms": FALSE_ALARMS,
                "heads": _told(fit, lessons, areas),
            },
        )

    def save(self, folder: Path) -> str:
        """See `Trainer`."""
        if self._taught is None:
            raise TrainingError("Nothing was taught yet. Call fit first")
        try:
            folder.mkdir()
        except OSError as error:
            raise WriteError.of(folder, error, _ROOM) from error
        for name, data in self._taught.files():
            write_whole(folder / name, data, remedy=_ROOM)
        return f"embedded:{folder}"


def _areas(fit: Fit, lessons: Lessons) -> list[float | None]:
    """The AUROC of each head on pictures that did not teach it."""
    found = []
    for column in range(len(lessons.questions)):
        odds, labels = fit.held_back[:, column], lessons.labels[:, column]
        asked = (labels >= 0) & ~np.isnan(odds)
        found.append(auroc(odds[asked], labels[asked] == 1))
    return found


def _told(
    fit: Fit, lessons: Lessons, areas: Sequence[float | None]
) -> list[dict[str, str | int | float | None]]:
    return [
        {
            "text": lessons.texts[question],
            "predicate": lessons.predicates[column],
            "yes": int((lessons.labels[:, column] == 1).sum()),
            "no": int((lessons.labels[:, column] == 0).sum()),
            "strength": float(fit.strengths[column]),
            "auroc_cross_validated": areas[column],
        }
        for column, question in enumerate(lessons.questions)
    ]


def _notices(lessons: Lessons, areas: Sequence[float | None]) -> list[str]:
    def quoted(question: str) -> str:
        return json.dumps(lessons.texts[question], ensure_ascii=False)

    told = [f"{quoted(each)} is unknown: {why}" for each, why in lessons.unlearnt.items()]
    for question, area in zip(lessons.questions, areas, strict=True):
        if area is None or area < _WEAK:
            said = "no figure" if area is None else f"AUROC {area:.2f}"
            told.append(
                f"{quoted(question)} is hardly learnt ({said} on pictures that did not teach it): "
                "label more pictures, nearer or larger ones"
            )
    return told
