"""A step of clean_dishes, for every monitor."""

from collections.abc import Callable

import pytest

from tests.doubles import perform
from tpvqa.monitors import Monitor, Step
from tpvqa.pddl import Task, load_task
from tpvqa.planning import Plan
from tpvqa.questions import Question, QuestionBook
from tpvqa.tasks import find_task
from tpvqa.vlm import Reply


def agree(question: Question) -> Reply:
    return Reply.YES if question.expected else Reply.NO


@pytest.fixture(scope="module")
def task() -> Task:
    return load_task("clean_dishes")


@pytest.fixture(scope="module")
def book(task: Task) -> QuestionBook:
    return QuestionBook.load(find_task("clean_dishes").questions, task)


@pytest.fixture
def at(task: Task, book: QuestionBook) -> Callable[..., Step]:
    names = [
        ("find", ("plate", "tv")),
        ("pick_up", ("plate", "table", "left")),
        ("find", ("sink", "plate")),
        ("wash", ("plate", "sink", "left")),
    ]
    plan = Plan(tuple(task.action(*name) for name in names), 4, "by hand", 0.0)

    def step(index: int, monitor: Monitor | None = None) -> Step:
        """Step `index`, reached by a monitor that saw every earlier step succeed."""
        state = task.init
        for number in range(index):
            here = Step(task, book, plan, number, state)
            if monitor is None:
                state = task.apply(state, plan.actions[number])
            else:
                verdict, _, _ = perform(monitor.after(here), agree)
                assert verdict.state is not None
                state = verdict.state
        return Step(task, book, plan, index, state)

    return step
