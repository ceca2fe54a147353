"""Plans for a world that will not do everything, and what becomes of a trial in it."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.planning.test_without import DOMAIN, PROBLEM
from tpvqa.assembly import Trial
from tpvqa.config import TrialConfig
from tpvqa.episodes import EpisodeWriter, read_episode
from tpvqa.events import Ended, Event
from tpvqa.events.events import Acted, PlanMade
from tpvqa.pddl import Action, Task, task_from_text
from tpvqa.pddl.validation import validate
from tpvqa.planning import Plan, Planner, Unsolvable
from tpvqa.planning.bounded import BoundedPlanner

MONITORS = ["tpvqa", "belief", "tp"]


@pytest.fixture(scope="module")
def rooms() -> Task:
    return task_from_text(DOMAIN, PROBLEM)


def _leaves(*places: str) -> Callable[[Action], str]:
    def refuses(action: Action) -> str:
        found = [each for each in action.arguments if each in places]
        return f"{action.pddl()} would leave the workspace: {found[0]}" if found else ""

    return refuses


@pytest.mark.parametrize("outside", ["b", "c"])
def test_another_way_is_planned(rooms: Task, planner: Planner, outside: str) -> None:
    plan = BoundedPlanner(planner, _leaves(outside)).plan(rooms)
    assert isinstance(plan, Plan)
    assert not any(outside in action.arguments for action in plan.actions)
    assert validate(rooms, plan.actions).valid


def test_where_there_is_none_it_is_said_why(rooms: Task, planner: Planner) -> None:
    result = BoundedPlanner(planner, _leaves("b", "c")).plan(rooms)
    assert isinstance(result, Unsolvable)
    assert "would leave the workspace: " in result.reason


def test_a_goal_out_of_reach_anyhow_is_not_put_down_to_it(rooms: Task, planner: Planner) -> None:
    nowhere = rooms.init - {each for each in rooms.init if each.predicate == "at"}
    result = BoundedPlanner(planner, _leaves("b")).plan(rooms, nowhere)
    assert isinstance(result, Unsolvable)
    assert "workspace" not in result.reason


def _events(folder: Path, monitor: str, outside: tuple[str, ...]) -> tuple[Ended, list[Event]]:
    (folder / "domain.pddl").write_text(DOMAIN)
    (folder / "problem.pddl").write_text(PROBLEM)
    config = TrialConfig().but(
        task={"domain": str(folder / "domain.pddl"), "problem": str(folder / "problem.pddl")},
        world={"spec": "symbolic"},
        vlm={"spec": "oracle:1"},
        monitor={"spec": monitor},
        simulation={"failure": 0.0},
    )
    writer = EpisodeWriter(folder / "episode", durable=False)
    with Trial(config) as trial:
        trial.world.refuses = _leaves(*outside)  # type: ignore[attr-defined]
        ended = trial.run(writer)
    writer.close()
    return ended, list(read_episode(folder / "episode"))


@pytest.mark.parametrize("monitor", MONITORS)
def test_a_trial_whose_every_plan_is_refused_ends_before_its_first_action(
    tmp_path: Path, monitor: str
) -> None:
    ended, events = _events(tmp_path, monitor, ("b", "c"))
    assert not ended.completed
    assert "would leave the workspace: " in ended.message
    assert not any(isinstance(event, Acted) for event in events)


@pytest.mark.parametrize("monitor", MONITORS)
def test_a_trial_takes_the_way_that_is_not_refused(tmp_path: Path, monitor: str) -> None:
    ended, events = _events(tmp_path, monitor, ("b",))
    assert ended.completed
    plans = [event for event in events if isinstance(event, PlanMade)]
    assert plans
    assert not any("b" in step.arguments for made in plans for step in made.plan)
