"""Which questions a training step asks about which picture.

Every way of asking gets the same share, whatever the number of its subjects: of five questions
two are about facts (asked as preconditions and as effects, in the same words), one each is
"possible", "successful" and "did". Within a way every predicate or action, every object and every
answer gets its share, so that a rare answer is asked about whenever a picture offers it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tpvqa_household.embedded.lexicon import Lexicon
from tpvqa_household.training.labels import Label
from tpvqa_household.training.subjects import ACTION_WAYS, Subject
from tpvqa_household.training.wordings import wordings

_AS_PRECONDITION = {"near": 0.35, "in_hand": 0.35, "on": 0.2, "opened": 0.1}
_AS_EFFECT = {
    "near": 0.17,
    "in_hand": 0.17,
    "on": 0.22,
    "opened": 0.1,
    "turned_on": 0.1,
    "clean": 0.14,
    "halved": 0.1,
}
_ACTION_SHARES = {"find": 2.0, "pick_up": 2.0, "place": 2.0}
_ANSWERS = {Label.YES: 0.38, Label.NO: 0.2, Label.HARD_NO: 0.24, Label.CANNOT_SEE: 0.18}


def _share(subject: Subject) -> float:
    if subject.form == "fact":
        return _AS_PRECONDITION.get(subject.name, 0.0) + _AS_EFFECT.get(subject.name, 0.0)
    return _ACTION_SHARES.get(subject.name, 1.0)


@dataclass(frozen=True)
class Asked:
    """Questions of a batch.

    Attributes:
        tokens: Pictures × questions × words.
        answers: The right answers, pictures × questions: 0 yes, 1 no, 2 cannot see, -1 none.
    """

    tokens: NDArray[np.int64]
    answers: NDArray[np.int64]


class Sampler:
    """Draws questions for pictures.

    Args:
        subjects: What can be asked about.
        lexicon: Has the words of all wordings.
        labels: Right answers of all pictures, pictures × subjects.
        per_share: Questions a picture for each of the five ways of asking.
    """

    def __init__(
        self,
        subjects: Sequence[Subject],
        lexicon: Lexicon,
        labels: NDArray[np.int8],
        *,
        per_share: int = 2,
    ):
        self._labels = labels
        self._forms = np.array([subject.form for subject in subjects])
        self._counts: Mapping[str, int] = {
            "fact": 2 * per_share,
            **{way.value: per_share for way in ACTION_WAYS},
        }
        self._weights = self._weigh(subjects)
        self._wordings = [self._tokens(subject, lexicon) for subject in subjects]

    def __len__(self) -> int:
        return len(self._labels)

    def _weigh(self, subjects: Sequence[Subject]) -> NDArray[np.float64]:
        """The weight of every subject and label; labels count from UNCLEAR, which has none."""
        weights = np.zeros((len(subjects), len(Label)))
        alike: dict[tuple[str, str], int] = {}
        for subject in subjects:
            alike[subject.form, subject.name] = alike.get((subject.form, subject.name), 0) + 1
        for k, subject in enumerate(subjects):
            share = _share(subject) / alike[subject.form, subject.name]
            hard = bool((self._labels[:, k] == Label.HARD_NO).any())
            for label, part in _ANSWERS.items():
                if label is Label.NO and not hard:
                    part += _ANSWERS[Label.HARD_NO]
                # A little more than the count, so that a few odd pictures are not asked only this.
                count = (self._labels[:, k] == label).sum() + 0.002 * len(self._labels)
                weights[k, label] = share * part / count
        return weights

    @staticmethod
    def _tokens(subject: Subject, lexicon: Lexicon) -> list[tuple[NDArray[np.int64], bool]]:
        found = []
        for wording in wordings(subject):
            tokens = lexicon.tokens(wording.text)
            assert isinstance(tokens, tuple), wording
            row = np.zeros(lexicon.longest, np.int64)
            row[: len(tokens)] = tokens
            found.append((row, wording.inverted))
        return found

    def draw(self, pictures: NDArray[np.int64], rng: np.random.Generator) -> Asked:
        """Questions about the given pictures: without repeats, by weight, a third canonical."""
        labels = self._labels[pictures]
        columns = np.arange(labels.shape[1])
        weights = self._weights[columns, labels]
        chosen = []
        for form, count in self._counts.items():
            among = columns[self._forms == form]
            # Largest log(u)/w: weighted draws without repeats (Efraimidis and Spirakis 2006).
            keys = np.log(rng.random((len(pictures), len(among))))
            keys = keys / np.maximum(weights[:, among], 1e-300)
            chosen.append(among[np.argsort(-keys, axis=1)[:, :count]])
        subjects = np.concatenate(chosen, 1)
        rows = np.arange(len(pictures))[:, None]
        right = labels[rows, subjects]
        right[weights[rows, subjects] == 0] = Label.UNCLEAR
        tokens, answers = [], np.full(right.shape, -1, np.int64)
        for b, s in np.ndindex(right.shape):
            options = self._wordings[subjects[b, s]]
            pick = 0 if rng.random() < 1 / 3 else int(rng.integers(len(options)))
            row, inverted = options[pick]
            tokens.append(row)
            answers[b, s] = answer_class(int(right[b, s]), inverted=inverted)
        return Asked(np.stack(tokens).reshape(*right.shape, -1), answers)


def answer_class(label: int, *, inverted: bool = False) -> int:
    """The network's class of a label: 0 yes, 1 no, 2 cannot see, -1 not asked."""
    if label == Label.UNCLEAR:
        return -1
    if label == Label.CANNOT_SEE:
        return 2
    return int((label == Label.YES) == inverted)
