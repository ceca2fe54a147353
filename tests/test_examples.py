"""The domains in examples/: they are what their pages say, and run as they lie there."""

from pathlib import Path

import pytest

from tests.doubles import configured
from tpvqa.assembly import Trial
from tpvqa.bench.cell import Cell
from tpvqa.bench.own_task import own_tasks
from tpvqa.bench.stage import stage
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.pddl import Literal, Task, literals, load_task
from tpvqa.planning import Plan
from tpvqa.planning.making import make_planner
from tpvqa.questions import QuestionBook
from tpvqa.worlds.simulation import Simulation
from tpvqa.worlds.world_file import load_world_file
from tpvqa_experiments.abroad.bench import sensed, tasks_in
from tpvqa_experiments.abroad.seeing import seeing

EXAMPLES = Path(__file__).parents[1] / "examples"
DRAWER = Path(__file__).parent / "fixtures/drawer"
NAMES = ("hospital", "store", "workshop")


def _task(folder: Path) -> Task:
    return load_task(folder / "domain.pddl", folder / "problem.pddl")


def _plan(task: Task) -> Plan:
    planner = make_planner("fast-downward")
    found = planner.plan(task)
    planner.close()
    assert isinstance(found, Plan)
    return found


def test_each_example_is_named_on_the_page() -> None:
    folders = sorted(each.parent.name for each in EXAMPLES.glob("*/domain.pddl"))
    assert folders == list(NAMES)
    page = (EXAMPLES / "README.md").read_text(encoding="utf-8")
    assert all(f"[{name}]({name})" in page for name in NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_an_example_takes_20_to_30_steps_and_has_facts_that_are_never_asked(name: str) -> None:
    folder = EXAMPLES / name
    task = _task(folder)
    assert 20 <= len(_plan(task).actions) <= 30
    book = QuestionBook.load(folder / "questions.yaml", task)
    assert not book.notices
    needed = {part.atom for part in literals(task.goal)}
    for action in _plan(task).actions:
        needed |= {part.atom for part in literals(action.precondition)}
    unseen = {atom for atom in needed if not book.asked(Literal(atom))}
    assert {atom.predicate for atom in unseen} & task.fluents


@pytest.mark.parametrize("name", NAMES)
def test_everything_that_an_example_can_undo_comes_up(name: str) -> None:
    folder = EXAMPLES / name
    task = _task(folder)
    rules = load_world_file(folder / "world.yaml", task)
    simulation = Simulation(task, rules, failure=0, disturbance=0)
    met = set()
    for action in _plan(task).actions:
        assert simulation.execute(action).succeeded
        for atom, results in simulation.undoable().items():
            met.add(next(r for r in rules.undo if r.fact.match(atom, {}, task) is not None))
            for _, after in results:
                task.check_state(after)
                for group in task.mutex_groups:
                    assert len(group.atoms & after) <= 1
                    assert not group.exactly_one or group.atoms & after
    assert met == {*rules.undo}
    assert task.goal_holds(simulation.state)


@pytest.mark.parametrize("name", NAMES)
def test_whatever_is_undone_in_an_example_who_sees_all_completes_it(name: str) -> None:
    (own,) = own_tasks([EXAMPLES / name]).items()
    here = stage(*own)
    cell = Cell(own[0], "seeing", "oracle", "symbolic", "limits=none,failure=0.4,disturbance=0.8")
    assert all(seeing(here, cell, TrialConfig(), n).completed for n in range(5))


def test_what_is_sensed_in_the_examples_is_what_is_never_asked() -> None:
    found = sensed(tasks_in(EXAMPLES))
    assert len(found) == len(NAMES)
    for name in NAMES:
        plain = (EXAMPLES / name / "world.yaml").read_text(encoding="utf-8")
        text = (EXAMPLES / name / "world-sensed.yaml").read_text(encoding="utf-8")
        assert text.startswith(plain)
        assert "\nsensed:\n" in text


@pytest.mark.parametrize(
    ("monitor", "world", "most"),
    [
        ("tpvqa", "world.yaml", 3),
        ("belief", "world.yaml", 7),  # nothing tells that it is clean
        ("belief", "world-sensed.yaml", 3),
        ("belief:notices=0.95", "world.yaml", 3),  # who does not report a failure has not failed
    ],
)
def test_the_smallest_case_takes_no_more_than_it_must(monitor: str, world: str, most: int) -> None:
    config = configured(monitor=monitor, vlm="oracle", world="symbolic").but(
        task={
            "domain": str(DRAWER / "domain.pddl"),
            "problem": str(DRAWER / "problem.pddl"),
            "questions": str(DRAWER / "questions.yaml"),
            "world_file": str(DRAWER / world),
        },
        simulation={"failure": 0},
    )
    with Trial(config) as trial:
        ended = trial.run(MemoryWriter())
    assert ended.completed
    assert 3 <= ended.actions <= most
