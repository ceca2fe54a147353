"""What the network knows, and what it says of real photographs, which it does not."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tpvqa.errors import AnswerError
from tpvqa_household.embedded.likeness import Divide, Floats, Likeness, summary
from tpvqa_household.embedded.weights import LIMITS, Weights

UNLIKE = "unlike the pictures it knows"
"""Why nothing is said about a picture."""
UNSURE = f"{UNLIKE}; as a photograph it is not sure"
"""Why nothing is said about a thing in a photograph."""


@dataclass(frozen=True)
class Asked:
    """Which head answers a question.

    Attributes:
        head: Its number.
        inverted: Whether its *yes* is the question's *no*.
    """

    head: int
    inverted: bool


@dataclass(frozen=True)
class Seen:
    """What the frozen branch makes of one picture: 1280 features, its classes, its texture."""

    features: Floats
    classes: Floats
    texture: Floats


@dataclass(frozen=True)
class Limits:
    """Where a network's knowledge ends, and the heads that answer about photographs beyond.

    Attributes:
        known: The pictures it was taught with, by `summary` of their maps.
        photographic: Photographs beyond it, the other side being the pictures that it was taught
            with: real homes are near to them.
        natural: Photographs, by their texture in the frozen branch.
        features: Heads × features, weights.
        classes: Heads × classes, weights.
        bias: Of each head.
        needs: For each head the one of what it is about ("is there a fridge?"), or -1.
        questions: Which head answers which question, in words as the lexicon has them.
        sure: The log odds from which on a head's answer counts.
    """

    known: Likeness
    photographic: Divide
    natural: Likeness
    features: Floats
    classes: Floats
    bias: Floats
    needs: NDArray[np.int64]
    questions: Mapping[str, Asked]
    sure: float

    def knows(self, maps: Floats) -> bool:
        """Whether a picture, by its map, is like those that the network was taught with."""
        features = summary(maps)[None]
        near = self.known.distance(features)[0] <= 1.0
        return bool(near and self.photographic.beyond(features)[0] <= 0.0)

    def odds(self, seen: Seen) -> "Odds":
        """What the heads say about a picture that is not known."""
        z = seen.features @ self.features.T + seen.classes @ self.classes.T + self.bias
        natural = bool(self.natural.distance(seen.texture[None])[0] <= 1.0)
        return Odds(self, z.astype(np.float64), natural)

    @classmethod
    def read(cls, weights: Weights) -> "Limits | None":
        """The limits of a network, None where it came without.

        Raises:
            AnswerError: They are damaged.
        """
        described = weights.description.get("limits")
        if described is None:
            return None
        try:
            with np.load(weights.folder / LIMITS, allow_pickle=False) as data:
                arrays = {name: data[name] for name in data.files}
            return cls._of(described, arrays)
        except (OSError, KeyError, ValueError, TypeError, IndexError) as error:
            raise AnswerError(
                f"{weights.folder / LIMITS} does not hold a network's limits ({error!r}). "
                "Install tpvqa-household again."
            ) from error

    @classmethod
    def _of(cls, described: Mapping[str, Any], arrays: Mapping[str, Floats]) -> "Limits":
        names = [head["name"] for head in described["heads"]]
        questions = {
            text: Asked(number, inverted)
            for number, head in enumerate(described["heads"])
            for text, inverted in head["questions"]
        }
        needs = [
            -1 if head["needs"] is None else names.index(head["needs"])
            for head in described["heads"]
        ]
        features, classes, bias = (
            arrays[f"heads.{part}"] for part in ("features", "classes", "bias")
        )
        if not len(names) == len(features) == len(classes) == len(bias):
            raise ValueError("the heads do not fit each other")
        return cls(
            Likeness.of(arrays, "known"),
            Divide.of(arrays, "photographic"),
            Likeness.of(arrays, "natural"),
            features,
            classes,
            bias,
            np.array(needs, np.int64),
            questions,
            float(described["sure"]),
        )


@dataclass(frozen=True)
class Odds:
    """The heads' log odds about one picture.

    Attributes:
        limits: Whose heads they are.
        z: Log odds of each head.
        natural: Whether the picture is like a photograph.
    """

    limits: Limits
    z: NDArray[np.float64]
    natural: bool

    def of(self, question: str) -> float | None:
        """The log odds of *yes*, however unsure; None where no head answers the question."""
        asked = self.limits.questions.get(question)
        if asked is None:
            return None
        z = float(self.z[asked.head])
        return -z if asked.inverted else z

    def surely(self, question: str) -> float | str:
        """The log odds of *yes* where they may be answered, else why not."""
        asked, sure = self.limits.questions.get(question), self.limits.sure
        if asked is None or not self.natural:
            return UNLIKE
        about = int(self.limits.needs[asked.head])
        there = about < 0 or self.z[about] >= sure
        if not there or abs(self.z[asked.head]) < sure:
            return UNSURE
        z = float(self.z[asked.head])
        return -z if asked.inverted else z


def described(
    heads: Sequence[tuple[str, str | None, Sequence[tuple[str, bool]]]], *, sure: float
) -> dict[str, Any]:
    """The part of a description that `Limits.read` reads beside the arrays.

    Args:
        heads: Of each its name, the name of the one that it needs, and its questions, inverted or
            not.
        sure: As in `Limits`.
    """
    told = [
        {"name": name, "needs": needs, "questions": [[text, turned] for text, turned in asked]}
        for name, needs, asked in heads
    ]
    found: dict[str, Any] = json.loads(json.dumps({"sure": sure, "heads": told}))
    return found
