"""Dask's workers: of this machine, behind credentials of their own, or of a scheduler elsewhere.

A scheduler runs whatever code it is sent. So that of this machine takes none but from the bench:
both ends show certificates that are made for this run and lie in memory alone, and there is no
page of it. Who wants the page starts a scheduler, and names it.
"""

import os
import signal
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import TYPE_CHECKING, Any

from tpvqa.errors import BenchError, MissingExtraError

if TYPE_CHECKING:
    from distributed import Client, Future, LocalCluster

WAIT = 60
"""Seconds that a scheduler may be without workers."""
REACH = 20.0
"""Seconds that a scheduler has to answer."""


@contextmanager
def dask_client(workers: int, scheduler: str | None = None) -> "Iterator[Client]":
    """What work is sent to.

    Args:
        workers: So many processes are started on this machine.
        scheduler: Address of a Dask scheduler to use instead. What protects it is the matter of
            whoever started it, and stands in Dask's own configuration.

    Raises:
        MissingExtraError: Dask, or what it needs for certificates, is not installed.
        BenchError: A worker does not start, or the scheduler cannot be reached or has none.
    """
    try:
        from distributed import Client
    except ImportError as error:
        raise MissingExtraError("distributed", "bench", "Running on several workers") from error
    cluster = None if scheduler is not None else _local_cluster(workers)
    try:
        client = Client(cluster or scheduler, timeout=f"{REACH:g}s")
    except (OSError, ValueError) as error:
        if cluster is not None:
            cluster.close()
        raise BenchError(
            f"The Dask scheduler at {scheduler!r} cannot be reached ({_cause(error)}). Start it, "
            "or leave --scheduler out for workers on this machine"
        ) from error
    try:
        if cluster is None:
            _wait_for_workers(client, scheduler)
        yield client
    finally:
        client.close()
        if cluster is not None:
            cluster.close()


def as_they_finish(
    client: "Client", futures: "Iterable[Future]"
) -> "Iterator[tuple[Future, Any, BaseException | None]]":
    """Futures, each once it is finished, with what came of it, or the error that it ended with.

    Raises:
        BenchError: No worker is left that could finish them.
    """
    from distributed import as_completed

    left = set(futures)
    while left:
        try:
            for future in as_completed(list(left), timeout=f"{WAIT}s"):
                try:
                    failed = future.exception(timeout=f"{WAIT}s")
                    value = None if failed else future.result(timeout=f"{WAIT}s")
                except TimeoutError:  # lost with its worker: it comes again, others before it
                    continue
                left.discard(future)
                yield future, value, failed
        except TimeoutError as error:
            if not client.nthreads():
                raise BenchError(
                    "All of Dask's workers have ended. What is finished is kept: the same command "
                    "goes on there, with --workers 1 in this process"
                ) from error


def _local_cluster(workers: int) -> "LocalCluster":
    import dask
    from distributed import LocalCluster

    no_pages: dict[str, list[str]] = {
        "distributed.scheduler.http.routes": [],
        "distributed.worker.http.routes": [],
    }
    try:
        with dask.config.set(no_pages), _deaf_to_interrupts():
            return LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                protocol="tls://",
                security=_credentials(),
                dashboard_address=None,
                # Dask listens for its page in any case: then at a free port, with nothing on it.
                scheduler_kwargs={"dashboard": False, "dashboard_address": "127.0.0.1:0"},
                silence_logs="CRITICAL",
            )
    except (OSError, RuntimeError) as error:
        raise BenchError(
            f"Dask's workers do not start on this machine ({_cause(error)}). Run without them: "
            "--workers 1"
        ) from error


def _credentials() -> Any:
    from distributed import Security

    try:
        return Security.temporary()
    except ImportError as error:
        raise MissingExtraError("cryptography", "bench", "Running on several workers") from error


def _wait_for_workers(client: "Client", scheduler: str | None) -> None:
    try:
        client.wait_for_workers(1, timeout=WAIT)
    except TimeoutError as error:
        raise BenchError(
            f"The Dask scheduler at {scheduler!r} has had no workers for {WAIT} s. Start one: "
            f"dask worker {scheduler}"
        ) from error


def _cause(error: BaseException) -> str:
    """What lies at the bottom of an error of Dask's, in a line."""
    while error.__cause__ is not None:
        error = error.__cause__
    said = " ".join(str(error).split())[:200]
    return f"{type(error).__name__}: {said}" if said else type(error).__name__


@contextmanager
def _deaf_to_interrupts() -> Iterator[None]:
    """Let processes that start meanwhile be deaf to Ctrl-C: who started them ends them. To a Ctrl-C
    or a SIGTERM this process answers once they have started."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    # Not ignored: what is sent meanwhile would be lost, and nannies end their workers by SIGTERM.
    noted: list[int] = []
    signals = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(each, lambda number, _: noted.append(number)) for each in signals]
    resource_tracker.ensure_running()  # where it is begun, it lets Ctrl-C through to who is next
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])  # processes inherit it
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        for each, handler in zip(signals, before, strict=True):
            signal.signal(each, handler)
        if noted:
            os.kill(os.getpid(), noted[-1])
