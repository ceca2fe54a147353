"""The worker's loop: a request a line on standard input, a reply a line on standard output.

A thread watches beside it. So the worker notices at any moment that the package's process is gone
(the pipe hangs up), also while it grounds or searches; and the thread's heartbeats tell a worker
that is busy from one that hangs.
"""

import contextlib
import ctypes
import json
import math
import os
import resource
import select
import signal
import sys
import threading
from collections import OrderedDict
from typing import Any

from tpvqa.pddl.worker.known_task import KnownTask, Leaving
from tpvqa.pddl.worker.memory_limit import within
from tpvqa.pddl.worker.reading_error import ReadingError
from tpvqa.pddl.worker.search import Searcher, SearchOutcome

_KEPT_TASKS = 8
_HEARTBEAT = 0.5  # seconds
# A process at the limit that the system holds it to can turn there for minutes, allocating and
# failing; so that one lies above the limit at which the heartbeat ends the grounding.
_MARGIN = 64 << 20  # bytes, at least
_PR_SET_PDEATHSIG = 1


class Worker:
    """Answers requests until its standard input ends.

    Args:
        replies: The file descriptor that replies go to.
    """

    def __init__(self, replies: int):
        self._replies = replies
        self._writing = threading.Lock()
        self._searcher = Searcher()
        self._tasks: OrderedDict[str, KnownTask] = OrderedDict()
        self._busy = False
        self._request: dict[str, Any] = {}
        self._exhausted = False
        self._memory: float = math.inf  # bytes

    def run(self) -> None:
        """Read and answer; does not return."""
        threading.Thread(target=self._watch, daemon=True).start()
        rest = b""
        while True:
            data = os.read(0, 1 << 20)
            if not data:
                os._exit(0)  # the searches end with this process
            *lines, rest = (rest + data).split(b"\n")
            for line in lines:
                self._busy = True
                request = self._request = json.loads(line)
                reply = self._encoded(request, self._answer(request))
                self._busy = False
                self._send(reply)
                if self._exhausted:
                    os._exit(0)  # gives the memory back; the next call starts another worker
                self._searcher.prepare()

    def _watch(self) -> None:
        poll = select.poll()
        poll.register(0, 0)  # nothing but the end of the pipe
        while True:
            if poll.poll(_HEARTBEAT * 1000):
                os._exit(0)
            if self._busy:
                with contextlib.suppress(MemoryError):
                    self._send(b"{}\n")
                    if _memory_taken() > self._memory and self._busy:
                        told = self._out_of_memory(self._request)
                        line = json.dumps({"id": self._request["id"], **told}).encode()
                        self._send(line + b"\n")
                        os._exit(0)

    def _encoded(self, request: dict[str, Any], reply: dict[str, Any]) -> bytes:
        """A reply as a line; one that cannot be written is a crash."""
        try:
            return json.dumps({"id": request["id"], **reply}).encode() + b"\n"
        except MemoryError:
            told = self._out_of_memory(request)
        except (TypeError, ValueError, RecursionError) as error:
            told = _crashed(error)
        return json.dumps({"id": request["id"], **told}).encode() + b"\n"

    def _send(self, line: bytes) -> None:
        view = memoryview(line)
        try:
            with self._writing:
                while view:
                    view = view[os.write(self._replies, view) :]
        except BrokenPipeError:
            os._exit(0)

    def _answer(self, request: dict[str, Any]) -> dict[str, Any]:
        try:
            self._limit_memory(request.get("grounding_memory"))
            task = self._task(request)
            if task is None:
                return {"unknown": True}
            if request["do"] == "describe":
                return {"task": task.describe(request["init"], request.get("also"))}
            leaving = request.get("leaving")
            outcome = task.plan(
                request["state"],
                self._searcher,
                searches=request["searches"],
                seconds=request["seconds"],
                memory=request["memory"],
                leaving=leaving and Leaving(frozenset(leaving["keep"]), leaving["effort"]),
            )
            return {"outcome": _as_json(outcome), "groundings": task.groundings}
        except ReadingError as error:
            return {"error": [error.message, error.part, error.line]}
        except MemoryError:
            return self._out_of_memory(request)
        except Exception as error:  # noqa: BLE001  the translator asserts and raises many kinds
            return _crashed(error)

    def _out_of_memory(self, request: dict[str, Any]) -> dict[str, Any]:
        self._exhausted = True
        self._tasks.clear()
        self._limit_memory(None)
        memory = request.get("grounding_memory")
        than = "there is" if memory is None else f"{memory / 1024:.3g} GB"
        reason = (
            f"grounding needs more memory than {than}; make the problem smaller (fewer objects, "
            "fewer parameters of an action)"
        )
        return {"outcome": _as_json(SearchOutcome("memory", reason=reason))}

    def _limit_memory(self, memory: int | None) -> None:
        """Limit this process to so many MiB; None for no limit but that it was started with."""
        _, highest = resource.getrlimit(resource.RLIMIT_AS)
        self._memory = math.inf if memory is None else memory << 20
        limit = highest
        if memory is not None:
            limit = within((memory << 20) + max(_MARGIN, memory << 18))
            if highest != resource.RLIM_INFINITY:
                self._memory = min(self._memory, highest - _MARGIN)
        resource.setrlimit(resource.RLIMIT_AS, (limit, highest))

    def _task(self, request: dict[str, Any]) -> KnownTask | None:
        key = request["key"]
        if key not in self._tasks:
            if "domain" not in request:
                return None
            self._tasks[key] = KnownTask(request["domain"], request["problem"])
            if len(self._tasks) > _KEPT_TASKS:
                self._tasks.popitem(last=False)
        self._tasks.move_to_end(key)
        return self._tasks[key]


def _memory_taken() -> int:
    """Bytes of address space that this process has."""
    with open("/proc/self/statm", "rb", buffering=0) as file:
        return int(file.read(64).split()[0]) * resource.getpagesize()


def _crashed(error: Exception) -> dict[str, Any]:
    said = f"{type(error).__name__} {error}".strip()[:300]
    return {
        "outcome": _as_json(SearchOutcome("crash", reason=f"the planning process failed: {said}"))
    }


def _as_json(outcome: SearchOutcome) -> dict[str, Any]:
    return {
        "kind": outcome.kind,
        "steps": outcome.steps,
        "cost": outcome.cost,
        "reason": outcome.reason,
        "left_out": outcome.left_out,
    }


def main() -> None:
    """Set the process up and answer requests."""
    # Ctrl-C goes to the whole group of the terminal; the package decides when the worker ends.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if "--die-with-parent" in sys.argv:
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    replies = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    sys.setrecursionlimit(20_000)
    Worker(replies).run()


if __name__ == "__main__":
    main()
