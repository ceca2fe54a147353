"""A table that is made once: building it takes a second."""

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
