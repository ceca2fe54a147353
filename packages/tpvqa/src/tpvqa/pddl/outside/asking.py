"""The package's side: an engine's process is lent, given a problem, and ended where it hangs."""

import tempfile
import time
from collections.abc import Mapping
from functools import cache
from typing import Any

from tpvqa.pddl.description import MEMORY
from tpvqa.pddl.processes import WorkerDied, WorkerPool, WorkerTimedOut, lasting_pool
from tpvqa.pddl.time_limit import limit_of

_GRACE = 0.5  # seconds that an engine gets to say itself that the time is over


@cache
def pool_of(module: str) -> WorkerPool:
    """The processes that run a module."""
    return lasting_pool(keep=2, limit=16, module=module)


def ask_engine(
    module: str, request: Mapping[str, Any], *, seconds: float | None, memory: int | None = MEMORY
) -> dict[str, Any]:
    """Have a request answered in a process of its own; one that dies is replaced, once.

    Args:
        module: What serves requests, a module of ours.
        request: What is asked.
        seconds: The time limit; None for none.
        memory: What the process, and all that it starts, may hold in MiB; None for no limit.

    Returns:
        The reply; its "kind" is "timeout", "memory" or "crash" (with a "reason") where the engine
        came to no end of its own.

    Raises:
        PlannerError: The time limit is none.
    """
    seconds = limit_of(seconds)
    start = time.monotonic()
    end = None if seconds is None else start + seconds + _GRACE
    reason = ""
    for _ in range(2):
        try:
            with (
                tempfile.TemporaryDirectory(prefix="tpvqa-", ignore_cleanup_errors=True) as folder,
                pool_of(module).lend(module, end=end) as worker,
            ):
                left = None if seconds is None else max(0.0, start + seconds - time.monotonic())
                reply = worker.call(
                    {**request, "folder": folder, "seconds": left, "memory": memory}, end=end
                )
        except WorkerTimedOut:
            return {"kind": "timeout"}
        except WorkerDied as death:
            reason = f"its process failed: {death}"
        else:
            if reply["kind"] == "memory":
                limit = "" if memory is None else f" (its limit is {memory} MiB)"
                return {"kind": "crash", "reason": f"it ran out of memory{limit}"}
            return reply
    return {"kind": "crash", "reason": reason}


def end_engines(module: str) -> None:
    """End the idle processes of a module. New requests start others."""
    pool_of(module).close()
