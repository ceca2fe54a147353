"""The worker processes: started when needed, lent to one caller at a time, never left behind."""

import atexit
import contextlib
import json
import os
import select
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from tpvqa.errors import PlannerError
from tpvqa.pddl.time_limit import limit_of

SILENCE = 10.0
"""Seconds without a heartbeat after which a worker that does nothing counts as hung."""


class WorkerDied(Exception):  # noqa: N818
    """The worker ended or hung in the middle of a call."""


class WorkerTimedOut(Exception):  # noqa: N818
    """The worker was still at work when the caller's time was over."""


class WorkerProcess:
    """One worker process and the pipes to it. Used by one thread at a time.

    Args:
        module: What it runs: a module that reads requests and writes replies and heartbeats.
    """

    def __init__(self, module: str = "tpvqa.pddl.worker") -> None:
        command = [sys.executable, "-P", "-m", module]
        if threading.current_thread() is threading.main_thread():
            # The signal comes when the *thread* that started the worker ends; only the main one
            # lives as long as the process.
            command.append("--die-with-parent")
        self._errors = os.memfd_create("errors")
        self._process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            cwd="/",
            env=_environment(),
            start_new_session=True,
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._requests = self._process.stdin.fileno()
        self._replies = self._process.stdout.fileno()
        os.set_blocking(self._requests, False)
        self._rest = b""
        self._number = 0
        self.known: set[str] = set()

    @property
    def pid(self) -> int:
        """The process id."""
        return self._process.pid

    @property
    def alive(self) -> bool:
        """Whether the process still runs."""
        return self._process.poll() is None

    def call(self, request: Mapping[str, Any], *, end: float | None) -> dict[str, Any]:
        """Send a request and wait for its reply.

        Args:
            request: What to do.
            end: When the caller's time is over, by `time.monotonic`.

        Raises:
            WorkerDied: The worker ended, or was silent for longer than `SILENCE`.
            WorkerTimedOut: The time is over.
        """
        self._number += 1
        self._send(json.dumps({"id": self._number, **request}).encode() + b"\n")
        while True:
            reply: dict[str, Any] = json.loads(self._line(end))
            if reply.get("id") == self._number:
                return reply

    def _send(self, data: bytes) -> None:
        view = memoryview(data)
        poll = select.poll()
        poll.register(self._requests, select.POLLOUT)
        while view:
            before = self._processor_ticks()
            if not poll.poll(SILENCE * 1000):
                if not self._makes_progress(before):
                    raise WorkerDied("it took no request")
                continue
            try:
                view = view[os.write(self._requests, view) :]
            except BrokenPipeError:
                raise WorkerDied(self._how_it_ended()) from None

    def _line(self, end: float | None) -> bytes:
        parts = [self._rest]
        poll = select.poll()
        poll.register(self._replies, select.POLLIN)
        while b"\n" not in parts[-1]:
            wait = SILENCE
            if end is not None:
                wait = min(wait, end - time.monotonic())
            if wait <= 0:
                raise WorkerTimedOut
            before = self._processor_ticks()
            if not poll.poll(wait * 1000):
                if wait == SILENCE and not self._makes_progress(before):
                    raise WorkerDied(f"it gave no sign of life for {SILENCE:g} s")
                continue
            data = os.read(self._replies, 1 << 20)
            if not data:
                raise WorkerDied(self._how_it_ended())
            parts.append(data)
        line, self._rest = b"".join(parts).split(b"\n", 1)
        return line

    def _how_it_ended(self) -> str:
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(1.0)
        code = self._process.returncode
        how = f"was killed by signal {-code}" if code and code < 0 else "ended"
        size = os.lseek(self._errors, 0, os.SEEK_END)
        last = os.pread(self._errors, 2000, max(0, size - 2000)).decode(errors="replace")
        said = [line.strip() for line in last.splitlines() if line.strip()]
        return f"it {how}" + (f" ({said[-1]})" if said else "")

    def _processor_ticks(self) -> int:
        with contextlib.suppress(OSError):
            words = Path(f"/proc/{self.pid}/stat").read_text().rsplit(")", 1)[1].split()
            return int(words[11]) + int(words[12])
        return 0

    def _makes_progress(self, ticks: int) -> bool:
        """Whether it has worked since, or only waits for a processor or a disk.

        On a machine with too much to do a healthy worker can be silent for long.
        """
        if self._processor_ticks() != ticks:
            return True
        with contextlib.suppress(OSError):
            for stat in Path(f"/proc/{self.pid}/task").glob("*/stat"):
                if stat.read_text().rsplit(")", 1)[1].split()[0] in "RD":
                    return True
        return False

    def kill(self) -> None:
        """End the process and whatever it started, at once."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        self.forget()

    def forget(self) -> None:
        """Close the pipes; the worker leaves when it notices."""
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                stream.close()
        if self._errors >= 0:
            os.close(self._errors)
            self._errors = -1


def _environment() -> dict[str, str]:
    """The caller's environment, and the folders that the three packages lie in.

    Raises:
        PlannerError: One of them is not installed.
    """
    folders = []
    for package in ("tpvqa", "fast_downward", "up_fast_downward"):
        spec = find_spec(package)
        locations = list(spec.submodule_search_locations or ()) if spec else []
        if not locations:
            raise PlannerError(
                "Fast Downward is not installed; install it: pip install up-fast-downward"
            )
        folders.append(str(Path(locations[0]).resolve().parent))
    return {**os.environ, "PYTHONPATH": os.pathsep.join(dict.fromkeys(folders))}


class WorkerPool:
    """Lends workers. Every caller has one of its own, so a long search holds up no other.

    Args:
        keep: So many idle workers stay for the next calls.
        limit: So many are at work at once; further callers wait.
        module: What they run.
    """

    def __init__(self, *, keep: int = 8, limit: int = 16, module: str = "tpvqa.pddl.worker"):
        self._keep, self._limit, self._module = keep, limit, module
        self._free = threading.Semaphore(limit)
        self._lock = threading.Lock()
        self._idle: list[WorkerProcess] = []
        self._lent: set[WorkerProcess] = set()

    @contextlib.contextmanager
    def lend(self, key: str, *, end: float | None) -> Iterator[WorkerProcess]:
        """A worker for one call, preferably one that already knows the task.

        A worker whose call ended with an exception is killed, as what it is doing is not known.

        Args:
            key: The task.
            end: When the caller's time is over, by `time.monotonic`.

        Raises:
            WorkerTimedOut: All workers were at work until then.
        """
        if not self._free.acquire(
            timeout=None if end is None else max(0.0, end - time.monotonic())
        ):
            raise WorkerTimedOut
        try:
            worker = self._take(key)
            try:
                yield worker
            except BaseException:
                with self._lock:
                    self._lent.discard(worker)
                worker.kill()
                raise
            self._give_back(worker)
        finally:
            self._free.release()

    def _take(self, key: str) -> WorkerProcess:
        with self._lock:
            knowing = [worker for worker in self._idle if key in worker.known]
            worker = next(reversed(knowing or self._idle), None)
            if worker is not None:
                self._idle.remove(worker)
        if worker is None or not worker.alive:
            if worker is not None:
                worker.kill()
            worker = WorkerProcess(self._module)
        with self._lock:
            self._lent.add(worker)
        return worker

    def _give_back(self, worker: WorkerProcess) -> None:
        with self._lock:
            self._lent.discard(worker)
            if len(self._idle) < self._keep:
                self._idle.append(worker)
                return
        worker.kill()

    def close(self) -> None:
        """End the idle workers; those at work end when the process does. New calls start anew."""
        with self._lock:
            idle, self._idle = self._idle, []
        for worker in idle:
            worker.kill()

    def end(self) -> None:
        """End all workers, at the end of the process."""
        with self._lock:
            workers = [*self._idle, *self._lent]
            self._idle, self._lent = [], set()
        for worker in workers:
            worker.kill()

    def forget(self) -> None:
        """In a forked child: the parent's workers are not ours."""
        self._lock, self._free = threading.Lock(), threading.Semaphore(self._limit)
        for worker in (*self._idle, *self._lent):
            worker.forget()
        self._idle, self._lent = [], set()


def lasting_pool(*, keep: int = 8, limit: int = 16, module: str) -> WorkerPool:
    """A pool that ends with this process and that a forked child does not share."""
    pool = WorkerPool(keep=keep, limit=limit, module=module)
    atexit.register(pool.end)
    os.register_at_fork(after_in_child=pool.forget)
    return pool


WORKERS = lasting_pool(module="tpvqa.pddl.worker")
"""The workers of this process, shared by reading and planning: who reads a task grounds it too."""


def ask_worker(
    request: Mapping[str, Any],
    *,
    key: str,
    domain: str,
    problem: str,
    seconds: float | None,
) -> dict[str, Any]:
    """Send a request about a task to a worker; a worker that dies is replaced, once.

    Args:
        request: What to do.
        key: Names the task.
        domain: The text of the domain, for a worker that does not know the task.
        problem: The text of the problem.
        seconds: The time limit; None for none.

    Returns:
        The worker's reply.

    Raises:
        PlannerError: The worker died or hung twice, or the time limit is none.
        WorkerTimedOut: The time is over.
    """
    seconds = limit_of(seconds)
    end = None if seconds is None else time.monotonic() + seconds
    reasons: list[str] = []
    while len(reasons) < 2:
        try:
            with WORKERS.lend(key, end=end) as worker:
                full = {**request, "key": key, "domain": domain, "problem": problem}
                short = {**request, "key": key}
                reply = worker.call(short if key in worker.known else full, end=end)
                if reply.get("unknown"):
                    reply = worker.call(full, end=end)
                if "error" not in reply:
                    worker.known.add(key)
                return reply
        except WorkerDied as death:
            reasons.append(str(death))
    raise PlannerError(
        f"the planning process failed twice: {'; then '.join(reasons)}. If this happens again, "
        "check that there is enough free memory and that up-fast-downward is installed"
    )
