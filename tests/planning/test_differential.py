"""Plans from random states, judged by VAL, and solvability by a fresh Fast Downward call."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from tests.pddl.feature_domains import SAMPLES, Sample
from tests.planning.judges import COMPLETE, INFORMED, solvable, val_value
from tests.planning.random_states import random_states
from tpvqa.pddl import State, Task, load_task, task_from_text, validate
from tpvqa.planning import Plan, Unsolvable
from tpvqa.planning.fast_downward import SEARCHES, FastDownward
from tpvqa.tasks import shipped_tasks

PER_TASK, PER_SAMPLE, PER_SEARCH = 40, 11, 4  # 3 × 40 + 18 × (11 + 2 × 4) = 462 states


def judge(
    task: Task, states: list[State], folder: Path, *, search: str, val: bool, spec: str = ""
) -> tuple[int, int]:
    """Plan from every state, compare with the judges; how many had a plan and how many none."""
    planner = FastDownward.from_spec(spec)

    def one(numbered: tuple[int, State]) -> bool:
        number, state = numbered
        own = folder / str(number)
        own.mkdir()
        result = planner.plan(task, state)
        assert isinstance(result, Plan | Unsolvable), result
        assert isinstance(result, Plan) == solvable(task, state, own, search=search), sorted(
            map(str, state)
        )
        if isinstance(result, Unsolvable):
            return False
        assert validate(task, result.actions, state).valid
        assert not val or result.cost == val_value(task, state, result.actions, own)
        return True

    with ThreadPoolExecutor(2) as threads:
        planned = list(threads.map(one, enumerate(states)))
    return sum(planned), len(planned) - sum(planned)


@pytest.mark.slow
@pytest.mark.parametrize("name", [files.name for files in shipped_tasks()])
def test_shipped_tasks_agree_with_the_judges(name: str, tmp_path: Path) -> None:
    task = load_task(name)
    states = list(random_states(task, seed=1, count=PER_TASK))
    with_plan, without = judge(task, states, tmp_path, search=INFORMED, val=True)
    assert with_plan >= PER_TASK // 3
    assert without > 0


@pytest.mark.slow
@pytest.mark.parametrize("sample", SAMPLES, ids=lambda sample: sample.name)
def test_every_feature_agrees_with_the_judges(sample: Sample, tmp_path: Path) -> None:
    task = task_from_text(sample.domain, sample.problem)
    states = list(random_states(task, seed=2, count=PER_SAMPLE))
    judge(task, states, tmp_path, search=COMPLETE, val=sample.val)


@pytest.mark.slow
@pytest.mark.parametrize("search", SEARCHES)
@pytest.mark.parametrize("sample", SAMPLES, ids=lambda sample: sample.name)
def test_every_search_agrees_with_the_judges(sample: Sample, search: str, tmp_path: Path) -> None:
    task = task_from_text(sample.domain, sample.problem)
    states = list(random_states(task, seed=3, count=PER_SEARCH))
    judge(task, states, tmp_path, search=COMPLETE, val=sample.val, spec=search)
