"""The folder that holds what a user taught the network."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tpvqa.errors import AnswerError, PictureError
from tpvqa.pictures import read_file
from tpvqa_household.embedded.lexicon import Lexicon, words
from tpvqa_household.embedded.likeness import Floats, Likeness
from tpvqa_household.embedded.taught.arrays import MOST_BYTES, packed, unpacked
from tpvqa_household.embedded.taught.sight import KIND, SIZE
from tpvqa_household.embedded.weights import FROZEN, Weights

TAUGHT, HEADS = "taught.json", "heads.npz"
SCHEMA = 1
_MOST_TEXT = 64 * 2**20
_REMEDY = "Teach it again with `tpvqa train embedded`, or name another folder"


def spoken(question: str) -> str:
    """A question as it is looked up: lower-case words."""
    return " ".join(words(question))


@dataclass(frozen=True)
class Taught:
    """Questions that a user taught, each with a linear head on the frozen branch.

    Attributes:
        questions: In words as `spoken` gives them, one for each head.
        weights: Heads × `SIZE`.
        bias: Of each head.
        known: The pictures that it was taught with.
        unlearnt: Questions that were taught and not learnt, each with why.
        branch: SHA-256 of the frozen branch.
        told: Whatever else is said of it, for readers.
    """

    questions: tuple[str, ...]
    weights: Floats
    bias: Floats
    known: Likeness
    unlearnt: Mapping[str, str]
    branch: str
    told: Mapping[str, Any] = field(default_factory=dict)

    @property
    def lexicon(self) -> Lexicon:
        """All questions that were taught."""
        return Lexicon.of([*self.questions, *self.unlearnt])

    def odds(self, features: Floats) -> NDArray[np.float64]:
        """Log odds of *yes* of every head about a picture, by its `SIZE` features."""
        return self.weights.astype(np.float64) @ features.astype(np.float64) + self.bias

    def knows(self, kind: Floats) -> bool:
        """Whether a picture, by its `KIND` features, is like those that it was taught with."""
        return bool(self.known.distance(kind[None])[0] <= 1.0)

    def files(self) -> Sequence[tuple[str, bytes]]:
        """Names and bytes of what is written into a folder; the description last."""
        arrays = packed({"weights": self.weights, "bias": self.bias, **self.known.arrays("known")})
        description = {
            "schema": SCHEMA,
            "sha256": {HEADS: hashlib.sha256(arrays).hexdigest(), FROZEN: self.branch},
            "questions": list(self.questions),
            "unlearnt": dict(self.unlearnt),
            **self.told,
        }
        text = json.dumps(description, indent=1, ensure_ascii=False) + "\n"
        return ((HEADS, arrays), (TAUGHT, text.encode()))


def read_taught(folder: Path, network: Weights) -> tuple[Taught, str]:
    """Read what a user taught, and what tells it from others.

    Args:
        folder: Where it lies; may come from a stranger.
        network: Whose frozen branch it rests on.

    Raises:
        AnswerError: It is missing, damaged, or was taught on another branch.
    """
    try:
        text = read_file(TAUGHT, inside=folder, most=_MOST_TEXT)
        arrays = read_file(HEADS, inside=folder, most=MOST_BYTES)
    except PictureError as error:
        raise AnswerError(f"{error}. {_REMEDY}.") from error
    try:
        told = json.loads(text)
        if told["schema"] != SCHEMA:
            raise ValueError(f"its schema is {told['schema']!r:.40}, and {SCHEMA} is read here")
        if told["sha256"][HEADS] != hashlib.sha256(arrays).hexdigest():
            raise ValueError(f"{HEADS} is not the file that it describes")
        branch = str(network.description["sha256"][FROZEN])
        if told["sha256"][FROZEN] != branch:
            raise ValueError("it was taught on another network, of another version")
        return _taught(told, unpacked(arrays), branch), hashlib.sha256(text).hexdigest()[:16]
    except (ValueError, KeyError, TypeError, IndexError, RecursionError) as error:
        said = _why(error)
        raise AnswerError(
            f"{folder} does not hold what the network was taught ({said[:300]}). {_REMEDY}."
        ) from error


def _why(error: Exception) -> str:
    if isinstance(error, json.JSONDecodeError):
        return f"{TAUGHT} is no JSON: line {error.lineno}, {error.msg[:1].lower()}{error.msg[1:]}"
    if isinstance(error, KeyError):
        return f"it lacks {error}"
    return str(error) if type(error) is ValueError else repr(error)


def _taught(told: Mapping[str, Any], arrays: Mapping[str, Floats], branch: str) -> Taught:
    questions, unlearnt = told["questions"], told["unlearnt"]
    texts = [*questions, *unlearnt, *unlearnt.values()]
    if not questions or not all(isinstance(text, str) and text for text in texts):
        raise ValueError("it names no questions")
    weights, bias = arrays["weights"], arrays["bias"]
    known = Likeness.of(arrays, "known")
    if weights.shape != (len(questions), SIZE) or bias.shape != (len(questions),):
        raise ValueError("its heads do not fit its questions")
    if known.mean.shape != (KIND,) or min(known.rest, known.edge, *known.variances, 1.0) <= 0:
        raise ValueError("its pictures are not described")
    return Taught(tuple(questions), weights, bias, known, dict(unlearnt), branch)
