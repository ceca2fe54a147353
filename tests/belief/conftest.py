"""The three household tasks with what their world file says."""

import pytest

from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.pddl import Task, load_task
from tpvqa.questions import QuestionBook
from tpvqa.tasks import find_task
from tpvqa.worlds.world_file import WorldRules, load_world_file

TASKS = ("clean_dishes", "serve_breakfast", "eat_apple")


@pytest.fixture(scope="session", params=TASKS)
def task(request: pytest.FixtureRequest) -> Task:
    return load_task(request.param)


@pytest.fixture(scope="session")
def rules(task: Task) -> WorldRules:
    return load_world_file(find_task(task.name).world, task)


@pytest.fixture(scope="session")
def book(task: Task) -> QuestionBook:
    return QuestionBook.load(find_task(task.name).questions, task)


@pytest.fixture(scope="session")
def model(task: Task, rules: WorldRules) -> FaultModel:
    return FaultModel(task, rules)
