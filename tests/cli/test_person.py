"""A person at the terminal."""

import os
import pty
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import nullcontext
from io import StringIO
from itertools import pairwise
from pathlib import Path
from threading import Timer

import pytest
from rich.console import Console

from tpvqa.assembly import Trial
from tpvqa.cli.person import TerminalPerson
from tpvqa.cli.terminal import EpisodeView
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter, read_episode
from tpvqa.events import Ended
from tpvqa.events.events import Answered, Asked, Resumed
from tpvqa.observation import Observation
from tpvqa.pddl import Literal, load_task
from tpvqa.questions import QuestionBook
from tpvqa.tasks import find_task
from tpvqa.vlm import Reply

LOOK = Observation(0, 0.0)


@pytest.fixture
def typing() -> Iterator[tuple[int, TerminalPerson]]:
    keyboard, terminal = pty.openpty()
    with os.fdopen(terminal) as source:
        console = Console(file=StringIO())
        yield keyboard, TerminalPerson(console, nullcontext, wait=0.3, source=source)
    os.close(keyboard)


@pytest.mark.parametrize(
    ("typed", "reply"),
    [
        ("y\n", Reply.YES),
        (" No \n", Reply.NO),
        ("\n", Reply.CANNOT_SEE),
        ("perhaps\nperhaps\n", Reply.CANNOT_SEE),
        ("perhaps\ny\n", Reply.YES),
        ("\udcff\n", Reply.CANNOT_SEE),
        ("", Reply.UNKNOWN),
        ("\x04", Reply.UNKNOWN),
    ],
)
def test_what_is_typed_counts_and_what_is_late_is_unknown(
    typing: tuple[int, TerminalPerson], typed: str, reply: Reply
) -> None:
    keyboard, person = typing
    task = load_task("clean_dishes")
    book = QuestionBook.load(find_task("clean_dishes").questions, task)
    question = book.fact(Literal(next(iter(task.init))))
    os.write(keyboard, b"n\nn\n")  # before the question: no answer to it
    typist = Timer(0.1, os.write, (keyboard, typed.encode(errors="surrogateescape")))
    typist.start()
    assert [answer.reply for answer in person.ask(LOOK, [question])] == [reply]


def test_a_user_at_a_terminal_is_asked(tmp_path: Path) -> None:
    """With a real terminal: whoever says yes to everything is believed, and it is on record."""
    command = [sys.executable, "-m", "tpvqa", "run", "clean_dishes", "--world", "symbolic"]
    command += ["--vlm", "oracle:0.6", "--monitor", "belief:person=0.05", "--out", "here"]
    keyboard, terminal = pty.openpty()
    run = subprocess.Popen(
        command, stdin=terminal, stdout=terminal, stderr=terminal, cwd=tmp_path, close_fds=True
    )
    os.close(terminal)
    shown, ends = b"", time.monotonic() + 60
    try:
        while time.monotonic() < ends:
            try:
                part = os.read(keyboard, 4096)
            except OSError:  # the terminal is closed: it has ended
                break
            shown += part
            for _ in range(part.count(b"y, n, or Enter")):
                os.write(keyboard, b"y\n")
    finally:
        run.kill()
        run.wait()
        os.close(keyboard)
    events = read_episode(tmp_path / "here")
    assert isinstance(events[-1], Ended)
    told = [
        answered.answers[0]
        for asked, answered in pairwise(events)
        if isinstance(asked, Asked) and asked.person and isinstance(answered, Answered)
    ]
    assert told
    assert all(answer.reply is Reply.YES for answer in told)
    assert b"y, n, or Enter" in shown


def test_what_was_said_before_stays_on_the_screen() -> None:
    out = StringIO()
    view = EpisodeView(Console(file=out, force_terminal=True, width=80), live=True)
    with view:
        trial_of("clean_dishes").run(MemoryWriter(resumable=False), listeners=[view])
        before = len(out.getvalue())
        with view.aside():
            out.write("Is it? y\n")
            asked = len(out.getvalue())
        view(Resumed())
    after = out.getvalue()[asked:]
    assert out.getvalue()[before:asked].endswith("Is it? y\n")
    first = after[: after.index("gone on")]
    assert "\x1b[1A" not in first  # the cursor does not go up over the answer


def trial_of(task: str) -> Trial:
    return Trial(TrialConfig(task=task, world="symbolic", vlm="oracle"))
