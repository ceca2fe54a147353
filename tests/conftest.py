"""What holds for all tests: how long an example takes on a busy machine is no failure."""

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

Install = Callable[..., None]

settings.register_profile("tpvqa", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("tpvqa")

# A suite that is started in the background ignores Ctrl-C, and so would the commands it starts.
if threading.current_thread() is threading.main_thread():
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session", autouse=True)
def _no_wait_for_the_disk() -> Iterator[None]:
    """What is written is there for everyone at once; only a power cut would tell the difference."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", os.fstat)  # what is no open file is still refused
        yield


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Install:
    """Put a package with entry points where Python finds it."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def put(
        package: str,
        source: str,
        *points: str,
        group: str = "tpvqa.vlms",
        extras: Mapping[str, str] | None = None,
    ) -> None:
        (tmp_path / f"{package}.py").write_text(source)
        metadata = tmp_path / f"{package}-1.0.dist-info"
        metadata.mkdir()
        (metadata / "METADATA").write_text(
            f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n"
            + "".join(
                f'Provides-Extra: {extra}\nRequires-Dist: {needed}; extra == "{extra}"\n'
                for extra, needed in (extras or {}).items()
            )
        )
        (metadata / "entry_points.txt").write_text(f"[{group}]\n" + "\n".join(points) + "\n")
        monkeypatch.delitem(sys.modules, package, raising=False)

    return put
