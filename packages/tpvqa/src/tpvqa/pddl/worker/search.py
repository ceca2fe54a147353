"""One call of the `downward` binary: a SAS+ text goes in, a plan or a reason comes out.

Nothing is written to disk: the text goes through a pipe, plan and log are files in memory.
"""

import contextlib
import ctypes
import os
import resource
import select
import signal
import subprocess
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from tpvqa.pddl.worker.ahead import BEGIN, Ahead
from tpvqa.pddl.worker.memory_limit import within

if TYPE_CHECKING:
    from tpvqa.pddl.worker.grounding import AtomKey, SASTemplate

_PR_SET_PDEATHSIG = 1
_PATIENCE = 2.0
"""Seconds in which a process has to have read a task ahead."""


@dataclass(frozen=True)
class SearchOutcome:
    """How a search ended.

    Attributes:
        kind: "plan", "unsolvable", "timeout", "memory" or "crash".
        steps: The plan, each step a name and its arguments.
        cost: Its cost.
        reason: What happened, in words.
        left_out: How many objects of the task were left out.
    """

    kind: str
    steps: tuple[tuple[str, ...], ...] = ()
    cost: int = 0
    reason: str = ""
    left_out: int = 0


def find_downward() -> Path:
    """The `downward` binary that the package up-fast-downward ships.

    The package itself is not imported: it would import unified-planning.

    Raises:
        FileNotFoundError: The package or the binary is missing.
    """
    spec = find_spec("up_fast_downward")
    for folder in (spec.submodule_search_locations or ()) if spec else ():
        binary = Path(folder, "downward/builds/release/bin/downward")
        if binary.is_file():
            return binary
    raise FileNotFoundError(
        "Fast Downward's binary is missing; install it: pip install up-fast-downward"
    )


class _Child:
    """A `downward` process that waits for its task on standard input."""

    def __init__(self, binary: str, search: str, memory: int | None, in_child: Callable[[], None]):
        self.search, self.memory, self._limit = search, memory, memory
        self.ahead: Ahead | None = None
        self._plan = os.memfd_create("plan")
        self._log = os.memfd_create("log")
        self._process = subprocess.Popen(
            [binary, "--search", search, "--internal-plan-file", f"/dev/fd/{self._plan}"],
            stdin=subprocess.PIPE,
            stdout=self._log,
            stderr=self._log,
            cwd="/",
            pass_fds=(self._plan,),
            bufsize=0,
            preexec_fn=in_child,
        )
        assert self._process.stdin is not None
        self._input = self._process.stdin
        os.set_blocking(self._input.fileno(), False)
        self._handle = os.pidfd_open(self._process.pid)
        if memory is not None:
            limit = within(memory << 20)
            self._limit = limit >> 20
            resource.prlimit(self._process.pid, resource.RLIMIT_AS, (limit, limit))

    def fits(self, search: str, memory: int | None, ahead: Ahead | None) -> bool:
        """Whether it still waits, for such a search, and has read nothing else."""
        if self.ahead not in (None, ahead):
            return False
        return (search, memory) == (self.search, self.memory) and self._process.poll() is None

    def read_ahead(self, ahead: Ahead, end: float) -> bool:
        """Have it read all of a task but its state; whether that was done in time."""
        self.ahead = ahead
        return self._write(ahead.first, end)

    def feed(self, text: bytes, end: float | None) -> None:
        """Write the task, or what is left of it; stops early where process or time ends."""
        self._write(text, end)
        self._input.close()

    def _write(self, text: bytes, end: float | None) -> bool:
        view = memoryview(text)
        poll = select.poll()
        poll.register(self._input.fileno(), select.POLLOUT)
        with contextlib.suppress(BrokenPipeError):
            while view and poll.poll(_milliseconds_until(end)):
                view = view[os.write(self._input.fileno(), view) :]
        return not view

    def wait(self, end: float | None) -> bool:
        """Wait until the process ends; False where the time is over first."""
        poll = select.poll()
        poll.register(self._handle, select.POLLIN)
        if not poll.poll(_milliseconds_until(end)):
            return False
        self._process.wait()
        return True

    def outcome(self) -> SearchOutcome:
        """How the search ended, once the process has."""
        plan, log = _contents(self._plan), _contents(self._log)
        return _outcome(self._process.returncode, plan, log, self._limit)

    def kill(self) -> None:
        """End the process, if it still runs."""
        if self._process.poll() is None:
            self._process.kill()

    def close(self) -> None:
        """End the process and let go of everything."""
        self.kill()
        self._process.wait()
        self._input.close()
        for number in (self._plan, self._log, self._handle):
            os.close(number)


def _milliseconds_until(end: float | None) -> float | None:
    return None if end is None else max(0.0, (end - time.monotonic()) * 1000)


def _contents(number: int) -> str:
    os.lseek(number, 0, os.SEEK_SET)
    parts = []
    while part := os.read(number, 1 << 20):
        parts.append(part)
    return b"".join(parts).decode(errors="replace")


class Searcher:
    """Runs searches, one after the other.

    Starting `downward` takes longer than a small search. So `prepare` starts the next process
    between two calls, and it waits for its task.
    """

    def __init__(self) -> None:
        self._ahead: Ahead | None = None
        self._again = False
        self._binary = str(find_downward())
        self._prctl: Callable[[int, int], int] = ctypes.CDLL(None).prctl
        self._own = os.getpid()
        self._waiting: _Child | None = None
        self._last: tuple[str, int | None] | None = None

    def _in_child(self) -> None:
        self._prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
        _, highest = resource.getrlimit(resource.RLIMIT_AS)
        resource.setrlimit(resource.RLIMIT_AS, (highest, highest))  # grounding's is not its own
        if os.getppid() != self._own:
            os._exit(1)

    def _take(self, search: str, memory: int | None, ahead: Ahead | None) -> _Child:
        child, self._waiting = self._waiting, None
        self._last = (search, memory)
        self._again, self._ahead = ahead is not None and ahead is self._ahead, ahead
        if child is not None:
            if child.fits(search, memory, ahead):
                return child
            child.close()
        return _Child(self._binary, search, memory, self._in_child)

    def prepare(self) -> None:
        """Start the process of the next search, expecting one like the last."""
        if self._waiting is None and self._last is not None:
            with contextlib.suppress(OSError):  # no process to be had now; the next call will see
                self._waiting = _Child(self._binary, *self._last, self._in_child)
                if self._again and self._ahead is not None:
                    end = time.monotonic() + _PATIENCE
                    if not self._waiting.read_ahead(self._ahead, end):
                        self._waiting.close()
                        self._waiting = None

    def run(
        self,
        template: "SASTemplate",
        state: "Iterable[AtomKey]",
        search: str,
        *,
        seconds: float | None,
        memory: int | None,
        ahead: bool = False,
    ) -> SearchOutcome:
        """Search for a plan; a search that crashes is tried once more.

        Args:
            template: The SAS+ task.
            state: Its initial state.
            ahead: Whether the next search may read the same task before it is asked for.
            search: Fast Downward's search, e.g. "astar(lmcut())".
            seconds: The time limit; None for none.
            memory: The limit of the search's memory in MiB; None for none.
        """
        end = None if seconds is None else time.monotonic() + seconds
        state = tuple(state)
        known = template.ahead if ahead else None
        outcome = self._once(template, state, search, end, memory, known)
        if outcome.kind == "crash":
            outcome = self._once(template, state, search, end, memory, None)
        return outcome

    def _once(
        self,
        template: "SASTemplate",
        state: "tuple[AtomKey, ...]",
        search: str,
        end: float | None,
        memory: int | None,
        ahead: Ahead | None,
    ) -> SearchOutcome:
        child = self._take(search, memory, ahead)
        try:
            if ahead is None:
                child.feed(template.fill(state), end)
            else:  # the same text, whether read ahead or not, so that plans do not depend on it
                begun = b"" if child.ahead is ahead else ahead.first
                child.feed(begun + ahead.rest(template.values(state)), end)
            return child.outcome() if child.wait(end) else SearchOutcome("timeout")
        finally:
            child.close()


def _outcome(code: int, plan: str, log: str, memory: int | None) -> SearchOutcome:
    if code in (0, 1, 2, 3) and "; cost = " in plan:
        steps = tuple(
            tuple(line.strip("()").split()) for line in plan.splitlines() if line.startswith("(")
        )
        steps = tuple(step for step in steps if step != (BEGIN,))
        return SearchOutcome("plan", steps, int(plan.rsplit("; cost = ", 1)[1].split()[0]))
    if code in (10, 11) or (code == 12 and "Completely explored state space" in log):
        return SearchOutcome("unsolvable", reason="the search went through all states that matter")
    if code == 12:
        return SearchOutcome("incomplete", reason="the search gave up without a proof")
    if code in (22, 24) or "std::bad_alloc" in log:
        limit = f" (its limit is {memory} MiB)" if memory is not None else ""
        return SearchOutcome("memory", reason=f"Fast Downward ran out of memory{limit}")
    if code == 23:
        return SearchOutcome("timeout")
    last = " | ".join(line for line in log.splitlines()[-3:] if line.strip())
    how = f"was killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
    return SearchOutcome("crash", reason=f"Fast Downward {how}: {last}".rstrip(": "))
