"""The child's side: requests come in on standard input, replies and heartbeats go out.

A process watches beside the engine: when the package's process is gone, the engine and whatever it
started end, at once, whatever they do. A thread sees that they do not take too much memory.
"""

import contextlib
import json
import os
import select
import signal
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

_HEARTBEAT = 0.2  # seconds


class Serving:
    """Answers requests until standard input ends.

    Args:
        answer: What answers one.
    """

    def __init__(self, answer: Callable[[dict[str, Any]], dict[str, Any]]):
        self._answer = answer
        self._replies = os.dup(1)
        self._writing = threading.Lock()
        self._watcher = 0
        self._request: dict[str, Any] | None = None

    def run(self) -> None:
        """Read and answer; does not return."""
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        nowhere = os.open(os.devnull, os.O_RDWR)
        os.dup2(nowhere, 1)  # engines print
        requests = os.dup(0)
        os.dup2(nowhere, 0)
        self._watcher = os.fork()
        if not self._watcher:
            os.close(self._replies)
            _wait_for_end(requests)
        threading.Thread(target=self._watch, daemon=True).start()
        rest = b""
        while True:
            data = os.read(requests, 1 << 20)
            if not data:
                _end_all()
            *lines, rest = (rest + data).split(b"\n")
            for line in lines:
                self._request = request = json.loads(line)
                reply = self._answered(request)
                self._request = None
                self._send({"id": request["id"], **reply})

    def _answered(self, request: dict[str, Any]) -> dict[str, Any]:
        folder = request.get("folder") or "/"
        os.chdir(folder)  # engines leave files where they stand
        tempfile.tempdir = folder
        os.environ["TMPDIR"] = folder
        try:
            return self._answer(request)
        except MemoryError:
            return {"kind": "memory"}
        except Exception as error:  # noqa: BLE001  engines raise anything
            said = " ".join(f"{type(error).__name__}: {error}".split())[:500]
            return {"kind": "crash", "reason": said}
        finally:
            os.chdir("/")

    def _watch(self) -> None:
        while True:
            time.sleep(_HEARTBEAT)
            request = self._request
            if request is None:
                continue
            self._write(b"{}\n")
            limit = request.get("memory")
            if limit is not None and memory_of_group(self._watcher) > limit << 20:
                self._send({"id": request["id"], "kind": "memory"})
                _end_all()

    def _send(self, reply: dict[str, Any]) -> None:
        self._write(json.dumps(reply).encode() + b"\n")

    def _write(self, line: bytes) -> None:
        view = memoryview(line)
        try:
            with self._writing:
                while view:
                    view = view[os.write(self._replies, view) :]
        except BrokenPipeError:
            _end_all()


def memory_of_group(without: int) -> int:
    """Bytes of memory that this process and all that it started hold, one process left out."""
    group, total = os.getpgrp(), 0
    for folder in Path("/proc").iterdir():
        if folder.name.isdigit() and int(folder.name) != without:
            with contextlib.suppress(OSError, ProcessLookupError):
                if int((folder / "stat").read_text().rsplit(")", 1)[1].split()[2]) == group:
                    total += int((folder / "statm").read_text().split()[1])
    return total * os.sysconf("SC_PAGESIZE")


def _wait_for_end(requests: int) -> None:
    """Wait until nobody can send a request any more; then end the whole group."""
    poll = select.poll()
    poll.register(requests, 0)  # nothing but the end of the pipe
    while not poll.poll():
        pass
    _end_all()


def _end_all() -> None:
    os.killpg(0, signal.SIGKILL)
