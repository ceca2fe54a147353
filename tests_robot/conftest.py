"""A table that is made once: building it takes a second."""

import os
import signal
import threading
from collections.abc import Callable, Iterator
from threading import Event

import pytest

from tpvqa import Action, Task, load_task
from tpvqa.tasks import find_task
from tpvqa_robots.mishaps import Mishaps
from tpvqa_robots.world import ToysWorld

Act = Callable[[str], Action]

# A suite that is started in the background ignores Ctrl-C, and so would the commands it starts.
if threading.current_thread() is threading.main_thread():
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session", autouse=True)
def _no_wait_for_the_disk() -> Iterator[None]:
    """What is written is there for everyone at once; only a power cut would tell the difference."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda file: None)
        yield


@pytest.fixture(scope="session")
def task() -> Task:
    files = find_task("collect_toys")
    return load_task(files.domain, files.problem)


@pytest.fixture(scope="session")
def act(task: Task) -> Act:
    return lambda said: task.action(said.split()[0], said.split()[1:])


@pytest.fixture
def world(task: Task) -> Iterator[ToysWorld]:
    """A table on which nothing is made to go wrong."""
    made = ToysWorld(task, mishaps=Mishaps(), seed=1)
    yield made
    made.close()


@pytest.fixture
def never() -> Event:
    return Event()
