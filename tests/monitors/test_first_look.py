"""Trials that begin unsure: what is possible is weighed, or looked for, before anything is done."""

from collections.abc import Iterator
from functools import reduce
from pathlib import Path
from typing import Any

import pytest

from tests import ward
from tpvqa import Trial, TrialConfig
from tpvqa.belief.calibrating.risk import RiskBound
from tpvqa.belief.filtering.priors import Priors
from tpvqa.config import SimulationConfig, StartConfig, TaskConfig
from tpvqa.episodes import EpisodeWriter, MemoryWriter, read_episode
from tpvqa.episodes.log import LOG
from tpvqa.events import Event
from tpvqa.events.events import Acting, Asked, Decided, PlanMade, Started
from tpvqa.pddl import Atom, load_task
from tpvqa.planning import Plan, Planner
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.remembering import Remembering
from tpvqa.resuming import resume
from tpvqa.tasks import find_task


@pytest.fixture(scope="module")
def planner() -> Iterator[Planner]:
    planner = Remembering(FastDownward())
    yield planner
    planner.close()


@pytest.fixture
def night(tmp_path: Path) -> TaskConfig:
    (tmp_path / "domain.pddl").write_text(ward.DOMAIN)
    (tmp_path / "problem.pddl").write_text(ward.PROBLEM)
    domain, problem = (str(tmp_path / f"{name}.pddl") for name in ("domain", "problem"))
    return TaskConfig(domain=domain, problem=problem)


def run(planner: Planner, task: TaskConfig | str, **changes: Any) -> tuple[Trial, list[Event]]:
    settings = {"vlm": "oracle:0.9", "world": "symbolic", **changes}
    writer = MemoryWriter()
    with Trial(TrialConfig(task=task, **settings), planner=planner) as trial:
        trial.run(writer)
    return trial, writer.events


def test_what_is_not_known_is_found_out(planner: Planner, night: TaskConfig) -> None:
    starts = set()
    for episode in range(6):
        trial, events = run(planner, night, episode=episode)
        assert trial.simulation is not None
        starts.add(trial.simulation.start & trial.task.left_open)
        assert trial.task.goal_holds(trial.simulation.state)
    assert len(starts) > 2  # the world draws how it is; the robot is told nothing of it
    assert events


def test_the_world_draws_the_same_for_every_monitor(planner: Planner, night: TaskConfig) -> None:
    starts = [
        trial.simulation.start
        for monitor in ("belief", "tpvqa", "none")
        for trial, _ in [run(planner, night, monitor=monitor, seed=4)]
        if trial.simulation is not None
    ]
    assert len(starts) == 3
    assert len(set(starts)) == 1


def test_what_is_asked_at_first_counts_for_the_trial(planner: Planner) -> None:
    _, events = run(
        planner, "build_tower", start="unknown", seed=2, monitor="belief:questions_per_trial=30"
    )
    assert sum(len(each.questions) for each in events if isinstance(each, Asked)) == 30


def test_with_nothing_known_it_looks_before_there_is_a_plan(planner: Planner) -> None:
    trial, events = run(planner, "build_tower", start="unknown", seed=2)
    assert trial.simulation is not None
    assert trial.simulation.start == trial.task.init
    assert trial.task.goal_holds(trial.simulation.state)
    kinds = [type(event) for event in events]
    followed = next(
        number for number, e in enumerate(events) if isinstance(e, PlanMade) and not e.considered
    )
    asked = [e for e in events[:followed] if isinstance(e, Asked)]
    first = next(e for e in events if isinstance(e, Decided))
    assert asked
    assert kinds.index(Decided) < followed < kinds.index(Acting)
    assert (first.action, first.when, first.step) == ("", "before", 0)
    assert f"after {sum(len(e.questions) for e in asked)} questions at " in first.reason


@pytest.mark.parametrize("vlm", ["recorded:gemma-3-12b", "oracle:0.85:0:0.74"])
def test_what_asking_settles_no_more_is_not_asked_on_and_on(planner: Planner, vlm: str) -> None:
    """Errors that last, and a closed fridge, leave too many states to be weighed for good."""
    _, events = run(
        planner,
        "serve_breakfast",
        vlm=vlm,
        start=StartConfig(what="unknown"),
        seed=1,
    )
    acting = next(place for place, each in enumerate(events) if isinstance(each, Acting))
    asked = sum(len(each.questions) for each in events[:acting] if isinstance(each, Asked))
    assert 100 < asked < 500


def test_a_goal_that_may_hold_already_is_looked_into(planner: Planner, tmp_path: Path) -> None:
    (tmp_path / "domain.pddl").write_text(ward.DOMAIN)
    goal = ward.PROBLEM.replace("(treated anna)", "(in pump store)")
    (tmp_path / "problem.pddl").write_text(goal)
    files = TaskConfig(domain=str(tmp_path / "domain.pddl"), problem=str(tmp_path / "problem.pddl"))
    for episode in range(6):
        trial, _ = run(planner, files, episode=episode)
        assert trial.simulation is not None
        assert trial.task.goal_holds(trial.simulation.state)


def test_a_trial_killed_at_its_first_look_is_gone_on_with(planner: Planner, tmp_path: Path) -> None:
    priors = tmp_path / "priors.yaml"
    priors.write_text("elsewhere: 0.02\n(on red ?x): 0.2\n")
    config = TrialConfig(
        task="build_tower",
        start=StartConfig(what="unknown", priors=str(priors)),
        vlm="oracle:0.9",
        world="symbolic",
    )
    folder = tmp_path / "episode"
    with Trial(config, planner=planner) as trial:
        writer = EpisodeWriter(folder)
        ended = trial.run(writer)
        writer.close()
    whole = read_episode(folder)
    started = whole[0]
    assert isinstance(started, Started)
    assert started.priors == priors.read_text()
    priors.unlink()  # the log has its text
    lines = (folder / LOG).read_bytes().splitlines(keepends=True)
    (folder / LOG).write_bytes(b"".join(lines[:5]))
    again = resume(folder)
    assert (again.completed, again.actions, again.questions) == (
        ended.completed,
        ended.actions,
        ended.questions,
    )


def test_a_thing_that_is_elsewhere_is_found_where_it_may_be(planner: Planner) -> None:
    config = TrialConfig(task="build_tower", vlm="oracle:0.9", world="symbolic")
    with Trial(config, planner=planner, priors=Priors(elsewhere=0.05)) as trial:
        assert trial.simulation is not None
        moved = trial.task.action("moveblock", ("red", "green", "blue", "c1", "c2"))
        trial.simulation.start = trial.simulation.state = trial.task.apply(trial.task.init, moved)
        trial.run(MemoryWriter())
        assert Atom.parse("(on red yellow)") in trial.simulation.state


@pytest.mark.parametrize("above", [0.5, 1.0])
def test_a_goal_that_is_found_done_has_to_be_sure_enough_for_the_risk(
    planner: Planner, tmp_path: Path, above: float
) -> None:
    task = load_task(*(getattr(find_task("build_tower"), name) for name in ("domain", "problem")))
    found = planner.plan(task)
    assert isinstance(found, Plan)
    state = reduce(task.apply, found.actions, task.init)
    (tmp_path / "done").write_text("\n".join(atom.pddl() for atom in sorted(state)))
    simulation = SimulationConfig(true_start=str(tmp_path / "done"))
    config = TrialConfig(
        task="build_tower",
        start="unknown",
        vlm="oracle:0.9",
        world="symbolic",
        monitor="belief:risk=.05",
        simulation=simulation,
    )
    writer, bound = MemoryWriter(), RiskBound(risk=0.05, above=above, trials=19)
    with Trial(config, planner=planner, risk=bound) as trial:
        ended = trial.run(writer)
    first = next(event for event in writer.events if isinstance(event, Decided))
    assert ended.actions == 0
    assert ended.believed_goal == (above < 1)
    assert first.reason.startswith("stop in doubt: ") == (above == 1)
