"""Dask's workers on this machine: nobody else is let in, and one that dies at the start is told."""

import subprocess
import sys
import time
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import urlopen

import dask
import pytest
from distributed import Client, Future, Security, wait

from tpvqa.bench.dask_workers import as_they_finish, dask_client
from tpvqa.errors import BenchError


def listening() -> set[int]:
    """The ports of TCP that something listens on."""
    found = set()
    for table in ("/proc/net/tcp", "/proc/net/tcp6"):
        for line in Path(table).read_text().splitlines()[1:]:
            _, local, _, state, *_ = line.split()
            if state == "0A":
                found.add(int(local.rpartition(":")[2], 16))
    return found


@pytest.mark.slow
def test_nobody_else_is_let_in_and_there_is_no_page() -> None:
    before = listening()
    with dask_client(1) as client:
        assert client.submit(int, "7").result() == 7
        address = client.scheduler.address
        assert address.startswith("tls://127.0.0.1:")
        with pytest.raises(OSError, match=r"(?s)."):
            Client(address.replace("tls://", "tcp://"), timeout="1s")
        with pytest.raises(OSError, match=r"(?s)."):
            Client(address, security=Security.temporary(), timeout="1s")
        assert 8787 not in listening() - before
        page = client.cluster.scheduler.http_server.port
        for path in ("", "status", "metrics", "json/counts.json"):
            with pytest.raises(HTTPError, match="404"):
                urlopen(f"http://127.0.0.1:{page}/{path}")


@pytest.mark.slow
@pytest.mark.parametrize("broken", ["import os; os._exit(3)", "raise RuntimeError('no licence')"])
def test_a_worker_that_dies_at_the_start(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], broken: str
) -> None:
    preload = tmp_path / "preload.py"
    preload.write_text(broken)
    with (
        dask.config.set({"distributed.worker.preload": [str(preload)]}),
        pytest.raises(BenchError, match=r"workers do not start .*--workers 1") as caught,
        dask_client(1),
    ):
        pass
    assert ("no licence" in str(caught.value)) == ("licence" in broken)
    assert "Traceback" not in capfd.readouterr().err


PRESSED = """
import os, pathlib, signal
pressed = pathlib.Path({!r})
if not pressed.exists():  # a worker may be begun again
    pressed.touch()
    os.kill(os.getppid(), signal.SIGINT)
    os.kill(os.getpid(), signal.SIGINT)
"""
STARTING = """
import os, sys, dask
from tpvqa.bench.dask_workers import dask_client
if __name__ == "__main__":
    try:
        with dask.config.set({"distributed.worker.preload": [sys.argv[1]]}), dask_client(1):
            print("not answered")
    except KeyboardInterrupt:
        print("answered")
"""


@pytest.mark.slow
def test_ctrl_c_while_workers_start_is_answered_once_they_have(tmp_path: Path) -> None:
    """In a process of its own: whatever of it comes late hits no other test."""
    preload, script = tmp_path / "preload.py", tmp_path / "starting.py"
    preload.write_text(PRESSED.format(str(tmp_path / "pressed")))
    script.write_text(STARTING)
    ran = subprocess.run(
        [sys.executable, str(script), str(preload)],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert (tmp_path / "pressed").exists()
    assert ran.stdout == "answered\n"


@pytest.mark.slow
def test_work_that_no_worker_is_left_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tpvqa.bench.dask_workers.WAIT", 1)
    with dask_client(1) as client:
        assert [value for _, value, _ in as_they_finish(client, [client.submit(int, "7")])] == [7]
        client.cluster.scale(0)
        while client.nthreads():
            time.sleep(0.05)
        with pytest.raises(BenchError, match="All of Dask's workers have ended"):
            list(as_they_finish(client, [client.submit(int, "8", pure=False)]))


@pytest.mark.slow
def test_a_scheduler_without_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    from distributed import LocalCluster

    monkeypatch.setattr("tpvqa.bench.dask_workers.WAIT", 1)
    with (
        LocalCluster(n_workers=0, dashboard_address="127.0.0.1:0") as cluster,
        pytest.raises(BenchError, match=r"no workers for 1 s.*dask worker tcp://"),
        dask_client(1, cluster.scheduler_address),
    ):
        pass


@pytest.mark.slow
def test_what_is_lost_with_its_worker_holds_up_nothing_else(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A worker that dies with a result, as after a machine has slept: it is waited for in vain."""
    with dask_client(1) as client:
        lost, other = client.submit(int, "7"), client.submit(int, "8")
        wait([lost, other])
        result = Future.result
        waited: list[str | None] = []

        def late(future: Future, timeout: str | None = None) -> int:
            if future.key == lost.key and not waited:
                waited.append(timeout)
                raise TimeoutError
            value: int = result(future, timeout)
            return value

        monkeypatch.setattr(Future, "result", late)
        found = [value for _, value, _ in as_they_finish(client, [lost, other])]
        assert sorted(found) == [7, 8]
        assert len(waited) == 1


@pytest.mark.slow
def test_what_failed_comes_with_its_error() -> None:
    with dask_client(1) as client:
        ((_, value, failed),) = as_they_finish(client, [client.submit(int, "seven")])
        assert value is None
        assert isinstance(failed, ValueError)
