"""What waits is taken together: questions about the same pictures are one call of the VLM.

Requests wait in the loop's thread; other threads ask. While pictures are being looked at, whatever
comes in about them waits until that is done, and is then answered from what the VLM kept of them.
"""

import asyncio
import math
import os
import sys
import time
import traceback
from collections.abc import Sequence
from dataclasses import dataclass, field
from threading import Condition, Thread

from tpvqa.errors import PluginBrokeError, TpvqaError
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Atom
from tpvqa.questions.question import FactQuestion, Way
from tpvqa.serving.refusal import Refusal
from tpvqa.serving.sent import Key
from tpvqa.vlm.answer import Answer
from tpvqa.vlm.capabilities import may_be_asked_side_by_side
from tpvqa.vlm.protocol import VLM
from tpvqa.vlm.sight import ask_seeing

_MOST_THREADS = 4


@dataclass(eq=False, slots=True)
class _Waiting:
    frames: tuple[Frame, ...]
    text: str
    answer: "asyncio.Future[Answer]"
    given_up: bool = False  # nobody waits for it any more


@dataclass
class Counts:
    """What came of questions so far.

    Attributes:
        answered: Were answered by the VLM.
        calls: Calls of the VLM for them.
        refused: Were refused, as too many waited or the end had come.
        failed: The VLM could not be asked.
        given_up: Whoever asked went away, or had no more time.
    """

    answered: int = 0
    calls: int = 0
    refused: int = 0
    failed: int = 0
    given_up: int = 0


@dataclass
class _Pace:
    """Seconds of a question, as of late."""

    seconds: float = 0.05

    def took(self, seconds: float, questions: int) -> None:
        self.seconds += 0.1 * (seconds / questions - self.seconds)


@dataclass
class Desk:
    """Where questions wait for a VLM. Use it in one event loop.

    Args:
        vlm: Asked by one thread, or by several where it allows that.
        most: Questions that may wait at once, those that are being answered included.
        patience: Seconds that a question waits at most.
    """

    vlm: VLM
    most: int
    patience: float
    counts: Counts = field(default_factory=Counts)

    def __post_init__(self) -> None:
        self._changed = Condition()
        self._groups: dict[Key, list[_Waiting]] = {}  # in the order of their oldest question
        self._looked_at: set[Key] = set()
        self._here: set[_Waiting] = set()
        self._closed = self._over = False
        self._pace, self._look = _Pace(), 0
        self._threads = 0
        self._loop: asyncio.AbstractEventLoop | None = None

    def open(self) -> None:
        """Start the threads that ask, in the running loop."""
        self._loop = asyncio.get_running_loop()
        cores = os.cpu_count() or 1
        side_by_side = may_be_asked_side_by_side(self.vlm)
        self._threads = min(cores, _MOST_THREADS) if side_by_side else 1
        for _ in range(self._threads):
            Thread(target=self._work, name="asks the VLM", daemon=True).start()

    @property
    def waiting(self) -> int:
        """Questions that wait or are being answered."""
        return len(self._here)

    @property
    def closed(self) -> bool:
        """Whether no more questions are taken."""
        return self._closed

    async def ask(
        self,
        key: Key,
        frames: tuple[Frame, ...],
        texts: Sequence[str],
        gone: "asyncio.Task[None]",
    ) -> list[Answer]:
        """Wait for the answers to questions about the same pictures.

        Args:
            key: Tells the pictures from others.
            frames: The pictures, views of one moment.
            texts: The questions.
            gone: Done when nobody waits for the answers any more.

        Returns:
            The answers in the order of the questions.

        Raises:
            Refusal: Too many wait, the end has come, the VLM cannot be asked, or it takes too long.
        """
        if self._closed:
            raise self._refused(self._ending())
        if self._here and len(self._here) + len(texts) > self.most:
            seconds = math.ceil(len(self._here) * self._pace.seconds / max(1, self._threads))
            raise self._refused(
                Refusal(
                    429,
                    f"{len(self._here)} questions wait already, of at most {self.most}. Ask again "
                    "later, or fewer at once.",
                    code="too_many_waiting",
                    retry_after=max(1, seconds),
                )
            )
        loop = asyncio.get_running_loop()
        entries = [_Waiting(frames, text, loop.create_future()) for text in texts]
        self._here.update(entries)
        with self._changed:
            self._groups.setdefault(key, []).extend(entries)
            self._changed.notify()
        try:
            answers = asyncio.gather(*(entry.answer for entry in entries))
            await asyncio.wait(
                (answers, gone), timeout=self.patience, return_when=asyncio.FIRST_COMPLETED
            )
            if answers.done():
                return answers.result()
            self.counts.given_up += len(entries)
            raise Refusal(
                503,
                f"There was no answer within {self.patience:g} s. Ask again later.",
                code="late",
                retry_after=max(1, math.ceil(self._pace.seconds)),
            )
        finally:
            self._here.difference_update(entries)
            for entry in entries:
                entry.given_up = True
                if not entry.answer.done():
                    entry.answer.cancel()

    def close(self) -> None:
        """Take no more questions. Those that wait are still answered."""
        self._closed = True

    def tell_all(self) -> None:
        """End: whoever still waits is told so."""
        self._closed = True
        with self._changed:
            self._over = True
            self._groups.clear()
            self._changed.notify_all()
        for entry in self._here:
            if not entry.answer.done():
                entry.answer.set_exception(self._refused(self._ending()))

    def _refused(self, refusal: Refusal) -> Refusal:
        self.counts.refused += 1
        return refusal

    @staticmethod
    def _ending() -> Refusal:
        return Refusal(
            503, "The server is ending. Ask again when it is back.", code="ending", retry_after=5
        )

    def _work(self) -> None:
        while (taken := self._take()) is not None:
            key, entries = taken
            texts = list(dict.fromkeys(entry.text for entry in entries))
            began = time.perf_counter()
            outcome: dict[str, Answer] | Refusal
            try:
                answers = self._answers(entries[0].frames, texts)
                outcome = dict(zip(texts, answers, strict=True))
            except BaseException as error:  # noqa: BLE001 — a plug-in may raise anything
                outcome = _failure(error)
            seconds = time.perf_counter() - began
            with self._changed:
                self._looked_at.discard(key)
                self._changed.notify_all()
            try:
                assert self._loop is not None
                self._loop.call_soon_threadsafe(self._deliver, entries, outcome, seconds)
            except RuntimeError:  # the loop has ended, and with it whoever waited
                return

    def _take(self) -> tuple[Key, list[_Waiting]] | None:
        """The oldest question with all others about its pictures; None at the end."""
        with self._changed:
            while not self._over:
                for key in [each for each in self._groups if each not in self._looked_at]:
                    entries = [each for each in self._groups.pop(key) if not each.given_up]
                    if entries:
                        self._looked_at.add(key)
                        return key, entries
                self._changed.wait()
            return None

    def _answers(self, frames: Sequence[Frame], texts: Sequence[str]) -> list[Answer]:
        with self._changed:
            self._look += 1
            look = self._look
        seen = Observation(look, time.monotonic(), {frame.view: frame for frame in frames})
        # A VLM that looks at pictures goes by the words alone.
        asked = [FactQuestion(text, Way.PRECONDITION, Atom("asked")) for text in texts]
        return ask_seeing(self.vlm, seen, asked)

    def _deliver(
        self, entries: list[_Waiting], outcome: dict[str, Answer] | Refusal, seconds: float
    ) -> None:
        self._pace.took(seconds, len(entries))
        self.counts.calls += 1
        for entry in entries:
            if entry.answer.done():
                continue
            if isinstance(outcome, Refusal):
                self.counts.failed += 1
                entry.answer.set_exception(outcome)
            else:
                self.counts.answered += 1
                entry.answer.set_result(outcome[entry.text])


def _failure(error: BaseException) -> Refusal:
    foreign = isinstance(error, PluginBrokeError)
    if isinstance(error, TpvqaError) and not foreign:
        return Refusal(500, str(error), code="vlm_failed")
    broke = (error.__cause__ if foreign else None) or error
    traceback.print_exception(broke, file=sys.stderr)
    return Refusal(
        500,
        f"The VLM broke with {type(broke).__name__}; the server's log says where.",
        code="vlm_broke",
    )
