"""A person at the terminal, who is asked where an answer is worth their time."""

import select
import sys
import termios
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, suppress
from typing import TextIO

from rich.console import Console

from tpvqa.cli.saying import marked, rendered
from tpvqa.observation import Observation
from tpvqa.questions import Question
from tpvqa.vlm import Answer, Reply

WAIT = 60.0
"""Seconds to wait for an answer. A late one is *unknown*."""
_REPLIES = {"y": Reply.YES, "yes": Reply.YES, "n": Reply.NO, "no": Reply.NO}


class TerminalPerson:
    """Asks whoever sits at the terminal.

    Args:
        console: Where to print the question.
        aside: Called for every question; what it gives clears the terminal meanwhile.
        wait: Seconds to wait for an answer.
        source: Where answers are typed; standard input by default.
    """

    name = "person"

    def __init__(
        self,
        console: Console,
        aside: Callable[[], AbstractContextManager[object]],
        *,
        wait: float = WAIT,
        source: TextIO | None = None,
    ):
        self._console, self._aside, self._wait = console, aside, wait
        self._source = sys.stdin if source is None else source

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        """Answer every question, in order: *cannot see* where they cannot tell, *unknown* where
        nobody answers in time."""
        with self._aside():
            names = ", ".join(frame.id for frame in observation.frames.values())
            return [self._ask(question, names) for question in questions]

    def _ask(self, question: Question, picture: str) -> Answer:
        with suppress(termios.error):  # what was typed before is no answer to this
            termios.tcflush(self._source, termios.TCIFLUSH)
        shown = f"[dim](picture {marked(picture)})[/]" if picture else ""
        self._console.bell()
        self._console.print(rendered(f"  [bold]{marked(question.text)}[/] {shown}"))
        typed = self._typed()
        if typed.strip() and typed.strip().lower() not in _REPLIES:
            typed = self._typed()  # once more
        if not typed:
            self._console.print("[dim]nobody answered[/]")
            return Answer(question, Reply.UNKNOWN, source="person", text="nobody answered")
        reply = _REPLIES.get(typed.strip().lower(), Reply.CANNOT_SEE)
        return Answer(question, reply, source="person", text=typed.strip())

    def _typed(self) -> str:
        """A line; empty where none comes in time, or none can come any more."""
        self._console.print(
            f"  [dim]y, n, or Enter if you cannot tell ({self._wait:g} s):[/] ", end=""
        )
        ready, _, _ = select.select([self._source], [], [], self._wait)
        try:
            return self._source.readline() if ready else ""
        except UnicodeDecodeError:
            return "\n"
