"""One call of the `downward` binary: a SAS+ text goes in, a plan or a reason comes out.

Nothing is written to disk: text, plan and log are files in memory that the two processes share.
"""

import ctypes
import os
import resource
import select
import signal
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

_PR_SET_PDEATHSIG = 1


@dataclass(frozen=True)
class Outcome:
    """How a search ended.

    Attributes:
        kind: "plan", "unsolvable", "timeout", "memory" or "crash".
        steps: The plan, each step a name and its arguments.
        cost: Its cost.
        reason: What happened, in words.
    """

    kind: str
    steps: tuple[tuple[str, ...], ...] = ()
    cost: int = 0
    reason: str = ""


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


def _memory_file(name: str, content: bytes = b"") -> int:
    number = os.memfd_create(name, os.MFD_CLOEXEC)
    view = memoryview(content)
    while view:
        view = view[os.write(number, view) :]
    os.lseek(number, 0, os.SEEK_SET)
    return number


def _contents(number: int) -> str:
    os.lseek(number, 0, os.SEEK_SET)
    parts = []
    while part := os.read(number, 1 << 20):
        parts.append(part)
    return b"".join(parts).decode(errors="replace")


class Searcher:
    """Runs searches, one after the other, and can be told to stop from another thread."""

    def __init__(self) -> None:
        self._binary = str(find_downward())
        libc = ctypes.CDLL(None, use_errno=True)
        self._prctl: Callable[[int, int], int] = libc.prctl
        self._own = os.getpid()
        self._child: subprocess.Popen[bytes] | None = None

    def _in_child(self) -> None:
        self._prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != self._own:
            os._exit(1)

    def kill(self) -> None:
        """End the search that is running, if one is."""
        child = self._child
        if child is not None and child.poll() is None:
            child.kill()

    def run(
        self, text: bytes, search: str, *, seconds: float | None, memory: int | None
    ) -> Outcome:
        """Search for a plan.

        Args:
            text: The SAS+ task.
            search: Fast Downward's search, e.g. "astar(lmcut())".
            seconds: The time limit; None for none.
            memory: The limit of the search's memory in MiB; None for none.
        """
        task = _memory_file("task", text)
        plan = _memory_file("plan")
        log = _memory_file("log")
        try:
            self._child = subprocess.Popen(
                [self._binary, "--search", search, "--internal-plan-file", f"/dev/fd/{plan}"],
                stdin=task,
                stdout=log,
                stderr=log,
                cwd="/",
                pass_fds=(plan,),
                preexec_fn=self._in_child,
            )
            if memory is not None:
                limit = memory << 20
                resource.prlimit(self._child.pid, resource.RLIMIT_AS, (limit, limit))
            if not self._wait(seconds):
                return Outcome("timeout")
            return _outcome(self._child.returncode, _contents(plan), _contents(log), memory)
        finally:
            self.kill()
            if self._child is not None:
                self._child.wait()
            for number in (task, plan, log):
                os.close(number)

    def _wait(self, seconds: float | None) -> bool:
        """Wait for the child; False where the time is over."""
        assert self._child is not None
        handle = os.pidfd_open(self._child.pid)
        try:
            poll = select.poll()
            poll.register(handle, select.POLLIN)
            end = None if seconds is None else time.monotonic() + seconds
            while True:
                left = None if end is None else (end - time.monotonic()) * 1000
                if left is not None and left <= 0:
                    return False
                if poll.poll(left):
                    self._child.wait()
                    return True
        finally:
            os.close(handle)


def _outcome(code: int, plan: str, log: str, memory: int | None) -> Outcome:
    if code in (0, 1, 2, 3) and "; cost = " in plan:
        steps = tuple(
            tuple(line.strip("()").split()) for line in plan.splitlines() if line.startswith("(")
        )
        return Outcome("plan", steps, int(plan.rsplit("; cost = ", 1)[1].split()[0]))
    if code in (10, 11) or (code == 12 and "Completely explored state space" in log):
        return Outcome("unsolvable", reason="the search went through all states that matter")
    if code == 12:
        return Outcome("incomplete", reason="the search gave up without a proof")
    if code in (22, 24) or "std::bad_alloc" in log:
        limit = f" (its limit is {memory} MiB)" if memory is not None else ""
        return Outcome("memory", reason=f"Fast Downward ran out of memory{limit}")
    if code == 23:
        return Outcome("timeout")
    last = " | ".join(line for line in log.splitlines()[-3:] if line.strip())
    how = f"was killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
    return Outcome("crash", reason=f"Fast Downward {how}: {last}".rstrip(": "))
