"""Answers questions that a user taught, about pictures like theirs: `embedded:FOLDER`."""

import threading
import time
from collections import OrderedDict
from collections.abc import Mapping, Sequence
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
from tpvqa_household.embedded.limits import UNLIKE
from tpvqa_household.embedded.sessions import Sessions
from tpvqa_household.embedded.taught.folder import Taught, read_taught
from tpvqa_household.embedded.taught.sight import glimpsed
from tpvqa_household.embedded.weights import Weights


class _Loaded(NamedTuple):
    taught: Taught
    fingerprint: str
    sessions: Sessions
    lexicon: Lexicon
    heads: Mapping[str, int]


class _View(NamedTuple):
    """What the heads say of a picture, and whether it is like those that were taught."""

    odds: NDArray[np.float64]
    known: bool


class TaughtVLM(NeedsPictures, Deterministic, SideBySide):
    """Answers the questions that a user taught with labelled pictures, of any domain.

    Questions that were not taught, or could not be learnt, are *unknown*, and so is everything
    about a picture unlike those that it was taught with. It never says *cannot see*: of what a
    picture does not show it says what it was taught of pictures that look like it.

    Several frames of a look are answered from the mean of their log odds; frames that are unlike
    those that it knows are left out.

    Args:
        folder: Holds what `tpvqa train embedded` wrote.
        threads: CPU cores for one call.
        remember: Pictures whose answers are kept.
    """

    def __init__(self, folder: str | Path, *, threads: int = 1, remember: int = 8):
        self._folder, self._threads, self._remember = Path(folder), threads, remember
        self._lock = threading.Lock()
        self._loaded: _Loaded | None = None
        self._views: OrderedDict[bytes, _View] = OrderedDict()

    @property
    def name(self) -> str:
        """What the log calls it."""
        return f"embedded:{self._folder}"

    @property
    def parameters(self) -> dict[str, str]:
        """What its answers depend on: what it was taught.

        Raises:
            AnswerError: That is missing or damaged.
        """
        return {"network": self._load().fingerprint}

    def check(self) -> None:
        """See whether all is there.

        Raises:
            AnswerError: It is missing or damaged.
        """
        self._load()

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        """Answer every question, in order.

        Raises:
            AnswerError: The folder is damaged, or a picture cannot be read.
        """
        began = time.perf_counter()
        views = [self._view(frame) for frame in observation.frames.values()]
        known = [view.odds for view in views if view.known]
        odds = np.mean(known, axis=0) if known else None
        nothing = UNLIKE if views else "the observation has no picture"
        told = [self._told(question, odds, nothing) for question in questions]
        seconds = (time.perf_counter() - began) / max(1, len(questions))
        return [_answer(each, of, seconds) for each, of in zip(questions, told, strict=True)]

    def knows(self, frame: Frame) -> bool:
        """Whether a picture is like those that it was taught with.

        Raises:
            AnswerError: The folder is damaged, or the picture cannot be read.
        """
        return self._view(frame).known

    def leanings(self, frame: Frame, questions: Sequence[Question]) -> list[float | None]:
        """P(yes) of one picture, however unlike it is: for measuring, not for acting.

        Args:
            frame: The picture.
            questions: What is asked.

        Returns:
            For each question P(yes), None where it was not learnt.

        Raises:
            AnswerError: The folder is damaged, or the picture cannot be read.
        """
        odds = self._view(frame).odds
        told = [self._told(question, odds, "") for question in questions]
        return [None if isinstance(each, str) else each for each in told]

    def _told(
        self, question: Question, odds: NDArray[np.float64] | None, nothing: str
    ) -> float | str:
        """P(yes), or why there is none."""
        taught, _, _, lexicon, heads = self._load()
        tokens = lexicon.tokens(question.text)
        if isinstance(tokens, Unknown):
            return tokens.reason
        meant = " ".join(lexicon.vocabulary[token - 1] for token in tokens)
        if meant in taught.unlearnt:
            return taught.unlearnt[meant]
        if odds is None:
            return nothing
        return float(1.0 / (1.0 + np.exp(-np.clip(odds[heads[meant]], -60, 60))))

    def _load(self) -> _Loaded:
        with self._lock:
            if self._loaded is None:
                network = Weights.read()
                taught, fingerprint = read_taught(self._folder, network)
                heads = {text: number for number, text in enumerate(taught.questions)}
                sessions = Sessions(network, threads=self._threads)
                self._loaded = _Loaded(taught, fingerprint, sessions, taught.lexicon, heads)
            return self._loaded

    def _view(self, frame: Frame) -> _View:
        loaded = self._load()
        with self._lock:
            found = self._views.get(frame.data)
        if found is not None:
            return found
        try:
            pixels = frame.pixels
        except PictureError as error:
            raise AnswerError(f"The picture {frame.id!r} cannot be read: it {error}") from error
        features, kind = glimpsed(loaded.sessions, pixels)
        view = _View(loaded.taught.odds(features), loaded.taught.knows(kind))
        with self._lock:
            self._views[frame.data] = view
            while len(self._views) > self._remember:
                self._views.popitem(last=False)
        return view


def _answer(question: Question, told: float | str, seconds: float) -> Answer:
    if isinstance(told, str):
        return Answer(question, Reply.UNKNOWN, source="network", text=told, seconds=seconds)
    reply = Reply.YES if told > 0.5 else Reply.NO
    return Answer(question, reply, p_yes=told, source="network", text=str(reply), seconds=seconds)
