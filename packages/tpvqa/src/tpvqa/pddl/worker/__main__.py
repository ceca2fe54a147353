"""The worker's loop: a request a line on standard input, a reply a line on standard output.

A thread watches beside it. So the worker notices at any moment that the package's process is gone
(the pipe hangs up), also while it grounds or searches; and the thread's heartbeats tell a worker
that is busy from one that hangs.
"""

import ctypes
import json
import os
import select
import signal
import sys
import threading
from collections import OrderedDict
from typing import Any

from tpvqa.pddl.worker.known_task import KnownTask
from tpvqa.pddl.worker.reading import ReadingError
from tpvqa.pddl.worker.search import Searcher, SearchOutcome

_KEPT_TASKS = 8
_HEARTBEAT = 0.5  # seconds
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
                request = json.loads(line)
                reply = self._answer(request)
                self._busy = False
                self._send({"id": request["id"], **reply})
                self._searcher.prepare()

    def _watch(self) -> None:
        poll = select.poll()
        poll.register(0, 0)  # nothing but the end of the pipe
        while True:
            if poll.poll(_HEARTBEAT * 1000):
                os._exit(0)
            if self._busy:
                self._send({})

    def _send(self, message: dict[str, Any]) -> None:
        view = memoryview(json.dumps(message).encode() + b"\n")
        try:
            with self._writing:
                while view:
                    view = view[os.write(self._replies, view) :]
        except BrokenPipeError:
            os._exit(0)

    def _answer(self, request: dict[str, Any]) -> dict[str, Any]:
        try:
            task = self._task(request)
            if task is None:
                return {"unknown": True}
            if request["do"] == "describe":
                return {"task": task.describe(request["init"])}
            outcome = task.plan(
                request["state"],
                self._searcher,
                searches=request["searches"],
                seconds=request["seconds"],
                memory=request["memory"],
            )
            return {"outcome": _as_json(outcome), "groundings": task.groundings}
        except ReadingError as error:
            return {"error": [error.message, error.part, error.line]}
        except MemoryError:
            return {
                "outcome": _as_json(SearchOutcome("memory", reason="grounding ran out of memory"))
            }
        except Exception as error:  # noqa: BLE001  the translator asserts and raises many kinds
            reason = f"the planning process failed: {type(error).__name__} {error}".rstrip()
            return {"outcome": _as_json(SearchOutcome("crash", reason=reason))}

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


def _as_json(outcome: SearchOutcome) -> dict[str, Any]:
    return {
        "kind": outcome.kind,
        "steps": outcome.steps,
        "cost": outcome.cost,
        "reason": outcome.reason,
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
