"""The embedded VLM: needs no key, no server and no download."""

import hashlib
import threading
import time
from collections import OrderedDict
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tpvqa.errors import AnswerError, PictureError
from tpvqa.observation import Frame, Observation
from tpvqa.questions.question import Question
from tpvqa.vlm.answer import Answer, Reply
from tpvqa.vlm.capabilities import Deterministic, NeedsPictures, SideBySide
from tpvqa_household.embedded.lexicon import Unknown
from tpvqa_household.embedded.sessions import Floats, Sessions
from tpvqa_household.embedded.weights import SHIPPED, Weights

REMEMBERED = 8
"""Pictures whose maps are kept, 0.1 MB each."""
_ANSWERS = 100_000
"""Answers that are kept."""


class EmbeddedVLM(NeedsPictures, Deterministic, SideBySide):
    """Answers questions about the household with a small network on the CPU.

    Not a general VLM: it knows the household's objects in pictures like those it was trained on,
    and only questions that its training asked. Others are *unknown*. What the picture does not
    show is *cannot see*.

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
        self._loaded: tuple[Weights, Sessions] | None = None
        self._maps: OrderedDict[bytes, Floats] = OrderedDict()
        self._known: OrderedDict[tuple[bytes, tuple[int, ...]], Floats] = OrderedDict()
        self._remember = remember

    @classmethod
    def from_spec(cls, arguments: str = "", *, remember: int = REMEMBERED) -> "EmbeddedVLM":
        """Make it from `embedded` or `embedded:FOLDER`, a folder with other weights."""
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
        return self._load()[0]

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
        chances: dict[tuple[int, ...], tuple[float, float]] = {}
        if known and observation.frames:
            frames = observation.frames.values()
            logits = np.stack([self._logits(frame, known) for frame in frames])
            p_yes, p_unseen = combine(logits / np.float32(weights.temperature))
            pairs = zip(p_yes.tolist(), p_unseen.tolist(), strict=True)
            chances = dict(zip(known, pairs, strict=True))
        seconds = (time.perf_counter() - began) / max(1, len(questions))
        return [
            self._answer(question, tokens, chances, seconds)
            for question, tokens in zip(questions, found, strict=True)
        ]

    @staticmethod
    def _answer(
        question: Question,
        tokens: tuple[int, ...] | Unknown,
        chances: dict[tuple[int, ...], tuple[float, float]],
        seconds: float,
    ) -> Answer:
        if isinstance(tokens, Unknown):
            return Answer(
                question, Reply.UNKNOWN, source="network", text=tokens.reason, seconds=seconds
            )
        if tokens not in chances:
            return Answer(
                question,
                Reply.UNKNOWN,
                source="network",
                text="the observation has no picture",
                seconds=seconds,
            )
        p_yes, p_unseen = chances[tokens]
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

    def _load(self) -> tuple[Weights, Sessions]:
        with self._lock:
            if self._loaded is None:
                weights = Weights.read(self._folder)
                self._loaded = weights, Sessions(weights, threads=self._threads)
            return self._loaded

    def _logits(self, frame: Frame, questions: Sequence[tuple[int, ...]]) -> Floats:
        """Logits of questions about a frame; each is worked out once."""
        weights, sessions = self._load()
        picture = hashlib.blake2b(frame.data, digest_size=16).digest()
        with self._lock:
            found = {q: self._known[picture, q] for q in questions if (picture, q) in self._known}
        new = [question for question in questions if question not in found]
        if new:
            rows = np.zeros((len(new), weights.lexicon.longest), np.int64)
            for i, tokens in enumerate(new):
                rows[i, : len(tokens)] = tokens
            logits = sessions.answer(self._encoded(frame, sessions), rows)
            found |= dict(zip(new, logits, strict=True))
            with self._lock:
                self._known |= {(picture, q): found[q] for q in new}
                while len(self._known) > _ANSWERS:
                    self._known.popitem(last=False)
        return np.stack([found[question] for question in questions])

    def _encoded(self, frame: Frame, sessions: Sessions) -> Floats:
        """The map of a frame, kept for the next questions about it."""
        with self._lock:
            known = self._maps.get(frame.data)
        if known is not None:
            return known
        try:
            pixels = frame.pixels
        except PictureError as error:
            raise AnswerError(f"The picture {frame.id!r} cannot be read: it {error}") from error
        maps = sessions.encode(pixels)
        with self._lock:
            self._maps[frame.data] = maps
            while len(self._maps) > self._remember:
                self._maps.popitem(last=False)
        return maps


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
