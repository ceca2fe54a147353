"""The embedded VLM: needs no key, no server and no download."""

import hashlib
import threading
import time
from collections import OrderedDict
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tpvqa.errors import AnswerError, PictureError
from tpvqa.observation import Frame, Observation
from tpvqa.questions.question import Question
from tpvqa.vlm.answer import Answer, Reply
from tpvqa.vlm.capabilities import Deterministic, NeedsPictures, SideBySide
from tpvqa_household.embedded.lexicon import Lexicon, Unknown
from tpvqa_household.embedded.likeness import Floats
from tpvqa_household.embedded.limits import Limits, Odds
from tpvqa_household.embedded.sessions import Sessions
from tpvqa_household.embedded.taught.vlm import TaughtVLM
from tpvqa_household.embedded.weights import DESCRIPTION, SHIPPED, Weights

REMEMBERED = 8
"""Pictures whose maps are kept, 0.1 MB each."""
_ANSWERS = 100_000
"""Answers that are kept."""
_SILENT = 60.0
"""The logit of *cannot see* of a frame about which nothing is said, beside 0 for yes and no."""

Tokens = tuple[int, ...]


class _Loaded(NamedTuple):
    """A network as it runs; `limits` is None for one that does not know them."""

    weights: Weights
    sessions: Sessions
    limits: Limits | None


class _View(NamedTuple):
    """What was made of a picture; `odds` is None where it is like the pictures that are known."""

    maps: Floats
    odds: Odds | None


class EmbeddedVLM(NeedsPictures, Deterministic, SideBySide):
    """Answers questions about the household with a small network on the CPU.

    Not a general VLM: it knows the household's objects in pictures like those it was trained on,
    and only questions that its training asked. Others are *unknown*. What the picture does not
    show is *cannot see*.

    Of a picture unlike those it was trained on it says that, and *unknown*. If it is a photograph,
    a branch that is as ImageNet left it answers what it is sure of: whether a thing is there,
    whether a fridge is open and a TV on.

    An observation of several frames is answered from all of them: frames that show what is asked
    count by how surely they show it.

    Args:
        folder: Holds the network; the shipped one by default.
        threads: CPU cores for one call. One is quick enough, 13 ms a picture, and leaves the
            others to other work.
        remember: Pictures whose maps are kept for further questions, 0.1 MB each. For a fixed set
            of pictures that are seen again and again: as many as there are.

    Example:
        >>> vlm = EmbeddedVLM()
        >>> vlm.name
        'embedded'
    """

    def __init__(
        self,
        *,
        folder: str | Path | None = None,
        threads: int = 1,
        remember: int = REMEMBERED,
    ):
        self._folder = SHIPPED if folder is None else Path(folder)
        self._threads = threads
        self._lock = threading.Lock()
        self._loaded: _Loaded | None = None
        self._views: OrderedDict[bytes, _View] = OrderedDict()
        self._known: OrderedDict[tuple[bytes, Tokens], Floats | str] = OrderedDict()
        self._remember = remember

    @classmethod
    def from_spec(
        cls, arguments: str = "", *, remember: int = REMEMBERED
    ) -> "EmbeddedVLM | TaughtVLM":
        """Make it from `embedded` or `embedded:FOLDER`.

        The folder holds what `tpvqa train embedded` wrote, or another network.
        """
        if arguments and not (Path(arguments) / DESCRIPTION).is_file():
            return TaughtVLM(arguments, remember=remember)
        return cls(folder=arguments or None, remember=remember)

    @property
    def name(self) -> str:
        """What the log calls it."""
        return "embedded" if self._folder == SHIPPED else f"embedded:{self._folder}"

    @property
    def weights(self) -> Weights:
        """The network's description and lexicon.

        Raises:
            AnswerError: The weights are missing or damaged.
        """
        return self._load().weights

    @property
    def parameters(self) -> dict[str, str]:
        """What its answers depend on: the network.

        Raises:
            AnswerError: The weights are missing or damaged.
        """
        return {"network": self.weights.fingerprint}

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        """Answer every question, in order, in one run of the network a frame.

        Raises:
            AnswerError: The weights are missing or damaged, or a picture cannot be read.
        """
        began = time.perf_counter()
        weights = self.weights
        found = [weights.lexicon.tokens(question.text) for question in questions]
        known = sorted({tokens for tokens in found if not isinstance(tokens, Unknown)})
        chances: dict[Tokens, tuple[float, float] | str] = {}
        if known and observation.frames:
            said = [self._said(frame, known) for frame in observation.frames.values()]
            rows = np.array([[_row(each[q]) for q in known] for each in said], np.float32)
            p_yes, p_unseen = combine(rows / np.float32(weights.temperature))
            pairs = zip(p_yes.tolist(), p_unseen.tolist(), strict=True)
            chances = dict(zip(known, pairs, strict=True))
            for question in known:
                silent = [one for each in said if isinstance(one := each[question], str)]
                if len(silent) == len(said):
                    chances[question] = silent[0]
        seconds = (time.perf_counter() - began) / max(1, len(questions))
        return [
            self._answer(question, tokens, chances, seconds)
            for question, tokens in zip(questions, found, strict=True)
        ]

    def knows(self, frame: Frame) -> bool:
        """Whether a picture is like those that it was taught with; always, without limits.

        Raises:
            AnswerError: The weights are missing or damaged, or the picture cannot be read.
        """
        return self._view(frame).odds is None

    def leanings(self, frame: Frame, questions: Sequence[Question]) -> list[float | None]:
        """P(yes) of one picture, however unlike and unsure it is: for measuring, not for acting.

        Args:
            frame: The picture.
            questions: What is asked.

        Returns:
            For each question P(yes | yes or no), None where it has no words for it.

        Raises:
            AnswerError: The weights are missing or damaged, or the picture cannot be read.
        """
        weights, sessions, _ = self._load()
        view = self._view(frame)
        leaning: list[float | None] = []
        for question in questions:
            tokens = weights.lexicon.tokens(question.text)
            if isinstance(tokens, Unknown):
                leaning.append(None)
                continue
            odds = None if view.odds is None else view.odds.of(_spoken(weights.lexicon, tokens))
            if odds is None:
                row = sessions.answer(view.maps, _padded([tokens], weights.lexicon))[0]
                odds = float(row[0] - row[1]) / weights.temperature
            leaning.append(float(1.0 / (1.0 + np.exp(-np.clip(odds, -60, 60)))))
        return leaning

    @staticmethod
    def _answer(
        question: Question,
        tokens: Tokens | Unknown,
        chances: dict[Tokens, tuple[float, float] | str],
        seconds: float,
    ) -> Answer:
        said = (
            tokens.reason
            if isinstance(tokens, Unknown)
            else chances.get(tokens, "the observation has no picture")
        )
        if isinstance(said, str):
            return Answer(question, Reply.UNKNOWN, source="network", text=said, seconds=seconds)
        p_yes, p_unseen = said
        seen = Reply.YES if p_yes > 0.5 else Reply.NO
        reply = Reply.CANNOT_SEE if p_unseen > 0.5 else seen
        return Answer(
            question,
            reply,
            p_yes=p_yes,
            source="network",
            text=str(reply),
            p_cannot_see=p_unseen,
            seconds=seconds,
        )

    def _load(self) -> _Loaded:
        with self._lock:
            if self._loaded is None:
                weights = Weights.read(self._folder)
                sessions = Sessions(weights, threads=self._threads)
                self._loaded = _Loaded(weights, sessions, Limits.read(weights))
            return self._loaded

    def _said(self, frame: Frame, questions: Sequence[Tokens]) -> dict[Tokens, Floats | str]:
        """Logits of questions about a frame, or why none; each is worked out once."""
        picture = hashlib.blake2b(frame.data, digest_size=16).digest()
        with self._lock:
            found = {q: self._known[picture, q] for q in questions if (picture, q) in self._known}
        new = [question for question in questions if question not in found]
        if new:
            found |= self._logits(frame, new)
            with self._lock:
                self._known |= {(picture, q): found[q] for q in new}
                while len(self._known) > _ANSWERS:
                    self._known.popitem(last=False)
        return found

    def _logits(self, frame: Frame, questions: Sequence[Tokens]) -> dict[Tokens, Floats | str]:
        weights, sessions, _ = self._load()
        lexicon, view = weights.lexicon, self._view(frame)
        if view.odds is None:
            logits = sessions.answer(view.maps, _padded(questions, lexicon))
            return dict(zip(questions, logits, strict=True))
        surely = {q: view.odds.surely(_spoken(lexicon, q)) for q in questions}
        half = weights.temperature / 2
        return {
            q: z if isinstance(z, str) else np.array([z * half, -z * half, -_SILENT], np.float32)
            for q, z in surely.items()
        }

    def _view(self, frame: Frame) -> _View:
        """What is made of a frame, kept for the next questions about it."""
        with self._lock:
            known = self._views.get(frame.data)
        if known is not None:
            return known
        _, sessions, limits = self._load()
        try:
            pixels = frame.pixels
        except PictureError as error:
            raise AnswerError(f"The picture {frame.id!r} cannot be read: it {error}") from error
        maps = sessions.encode(pixels)
        alike = limits is None or limits.knows(maps)
        view = _View(maps, None if limits is None or alike else limits.odds(sessions.see(pixels)))
        with self._lock:
            self._views[frame.data] = view
            while len(self._views) > self._remember:
                self._views.popitem(last=False)
        return view


def _padded(questions: Sequence[Tokens], lexicon: Lexicon) -> NDArray[np.int64]:
    rows = np.zeros((len(questions), lexicon.longest), np.int64)
    for row, tokens in zip(rows, questions, strict=True):
        row[: len(tokens)] = tokens
    return rows


def _spoken(lexicon: Lexicon, tokens: Tokens) -> str:
    return " ".join(lexicon.vocabulary[token - 1] for token in tokens)


def _row(said: Floats | str) -> Floats:
    return np.array([0.0, 0.0, _SILENT], np.float32) if isinstance(said, str) else said


def combine(logits: Floats) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Answers of several frames as one.

    Args:
        logits: Frames × questions × (yes, no, cannot see).

    Returns:
        P(yes | yes or no), and the probability that no frame shows what is asked; one frame's
        are the softmax of its logits.
    """
    logits = logits.astype(np.float64)
    exponentials = np.exp(logits - logits.max(-1, keepdims=True))
    chances = exponentials / exponentials.sum(-1, keepdims=True)
    seen = 1.0 - chances[..., 2]
    weight = seen / np.maximum(seen.sum(0, keepdims=True), 1e-12)
    log_odds = ((logits[..., 0] - logits[..., 1]) * weight).sum(0)
    return 1.0 / (1.0 + np.exp(-np.clip(log_odds, -60, 60))), chances[..., 2].min(0)
