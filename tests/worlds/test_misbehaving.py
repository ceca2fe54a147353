"""Worlds that are not as the problem says: dead skills, things elsewhere, facts that fall back."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.doubles import configured
from tpvqa.assembly import Trial
from tpvqa.bench.cell import Cell
from tpvqa.bench.condition import normalised
from tpvqa.bench.own_task import own_tasks
from tpvqa.bench.settings import common_settings
from tpvqa.bench.stage import stage
from tpvqa.config import SimulationConfig, TrialConfig
from tpvqa.episodes import EpisodeWriter, MemoryWriter, read_episode
from tpvqa.errors import BenchError, TpvqaError, WorldError
from tpvqa.events import Started
from tpvqa.events.events import Acted
from tpvqa.pddl import Action, Atom, State, load_task
from tpvqa.planning import Plan
from tpvqa.planning.making import make_planner
from tpvqa.resuming import trial_of
from tpvqa.tasks import find_task
from tpvqa.worlds import Report
from tpvqa.worlds.dead import Dead
from tpvqa.worlds.elsewhere import elsewhere
from tpvqa.worlds.outcome import Failure
from tpvqa.worlds.simulation import Simulation
from tpvqa.worlds.world_file import load_world_file

TASK = load_task("eat_apple")
PLANNER = make_planner("fast-downward")
EXAMPLES = Path(__file__).parents[2] / "examples"
LAMPS = Path(__file__).parents[1] / "fixtures/lamps"


def _plan(state: State) -> tuple[Action, ...] | None:
    found = PLANNER.plan(TASK, state)
    return found.actions if isinstance(found, Plan) else None


def test_a_dead_skill_never_does_anything_and_says_nothing_of_it() -> None:
    config = configured(task="eat_apple", monitor="blind:2", vlm="oracle", world="symbolic").but(
        simulation={"dead": "pick_up apple", "failure": 0, "disturbance": 0}
    )
    writer = MemoryWriter()
    with Trial(config) as trial:
        trial.run(writer)
    acted = [event for event in writer.events if isinstance(event, Acted)]
    dead = [each for each in acted if each.truth and each.truth.failure is Failure.DEAD]
    assert len(dead) == 2
    assert all(each.report is Report.DONE for each in dead)
    assert all(not each.truth.added and not each.truth.removed for each in dead if each.truth)


def test_a_skill_is_dead_for_what_is_named_alone() -> None:
    dead = Dead.parse("pick_up apple + (find knife)", TASK)
    actions = {action.pddl(): dead.holds(action) for action in TASK.ground_actions()}
    for name, is_dead in actions.items():
        wanted = name.startswith(("(pick_up apple", "(find knife"))
        assert is_dead == wanted, name
    assert sum(actions.values())
    assert not Dead.parse(None, TASK).skills
    left = Dead.parse("pick_up _ _ left", TASK)
    assert {a.arguments[2] for a in TASK.ground_actions() if left.holds(a)} == {"left"}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("pick_uo", "pick_up"),
        ("pick_up aple", "apple"),
        ("pick_up apple table left left", "takes"),
        ("pick_up left", "takes"),
        ("pick_up+", r"missing before or behind a \+"),
    ],
)
def test_a_dead_skill_that_there_is_not_is_told(text: str, said: str) -> None:
    with pytest.raises(WorldError, match=said):
        Dead.parse(text, TASK)


@settings(max_examples=30)
@given(count=st.integers(1, 2), episode=st.integers(0, 30))
def test_things_elsewhere_keep_the_groups_and_the_goal_in_reach(count: int, episode: int) -> None:
    state = elsewhere(TASK, count, plan=_plan, episode=episode)
    assert len(state - TASK.init) >= count
    assert all(len(group.atoms & state) <= 1 for group in TASK.mutex_groups)
    assert all(len(group.atoms & state) == 1 for group in TASK.mutex_groups if group.exactly_one)
    assert _plan(state)
    assert state == elsewhere(TASK, count, plan=_plan, episode=episode)


def test_some_things_are_behind_a_closed_door() -> None:
    fridge = Atom("on", ("knife", "fridge"))
    starts = [elsewhere(TASK, 1, plan=_plan, episode=n) for n in range(40)]
    assert any(fridge in state for state in starts)
    assert len(set(starts)) > 4


def test_so_many_things_cannot_be_elsewhere() -> None:
    with pytest.raises(WorldError, match="name fewer, or a state with --true-start"):
        elsewhere(TASK, 9, plan=_plan)


def test_the_monitor_is_told_what_the_problem_says_and_the_log_what_is_true(tmp_path: Path) -> None:
    start = tmp_path / "start.txt"
    moved = (TASK.init - {Atom("on", ("knife", "counter"))}) | {Atom("on", ("knife", "fridge"))}
    start.write_text("\n".join(atom.pddl() for atom in sorted(moved - TASK.static)))
    config = configured(task="eat_apple", monitor="tp", vlm="oracle", world="symbolic").but(
        simulation={"true_start": str(start)}
    )
    writer = EpisodeWriter(tmp_path / "episode")
    with Trial(config) as trial:
        assert trial.simulation is not None
        assert trial.simulation.state == moved
        trial.run(writer, folder=tmp_path / "episode")
    writer.close()
    started = read_episode(tmp_path / "episode")[0]
    assert isinstance(started, Started)
    assert "(on knife counter)" in started.initial
    assert started.true_start is not None
    assert "(on knife fridge)" in started.true_start
    start.unlink()  # whoever goes on needs no file that the log names
    with trial_of(started) as again:
        assert again.simulation is not None
        assert again.simulation.start == moved


def test_a_start_that_does_not_fit_is_told_with_its_line(tmp_path: Path) -> None:
    start = tmp_path / "start.txt"
    start.write_text("(on knife fridge)\n(on knief table)\n")
    config = configured(task="eat_apple", monitor="tp", vlm="oracle", world="symbolic").but(
        simulation={"true_start": str(start)}
    )
    with pytest.raises(TpvqaError, match=r"start\.txt:2.*knife"):
        Trial(config)


def test_without_a_world_file_an_undone_fact_gives_way_to_what_held_before() -> None:
    config = TrialConfig(monitor="blind:3", vlm="oracle", world="symbolic").but(
        task={"domain": str(LAMPS / "domain.pddl"), "problem": str(LAMPS / "both.pddl")},
        simulation={"failure": 0.5, "disturbance": 1},
    )
    undone = 0
    for episode in range(10):
        writer = MemoryWriter()
        with Trial(config.but(episode=episode)) as trial:
            trial.run(writer)
        for event in writer.events:
            if isinstance(event, Acted) and event.truth and event.truth.undone:
                assert event.truth.undone in event.truth.removed
                undone += 1
    assert undone


def test_a_world_file_may_say_that_nothing_is_undone(tmp_path: Path) -> None:
    world = tmp_path / "world.yaml"
    world.write_text("undo: []\n")
    task = load_task(LAMPS / "domain.pddl", LAMPS / "both.pddl")
    assert load_world_file(world, task).nothing_undone
    assert not load_world_file(None, task).nothing_undone
    config = TrialConfig(monitor="blind:1", vlm="oracle", world="symbolic").but(
        task={
            "domain": str(LAMPS / "domain.pddl"),
            "problem": str(LAMPS / "both.pddl"),
            "world_file": str(world),
        }
    )
    with Trial(config) as trial:
        assert trial.simulation is not None
        assert not trial.simulation.undoing


def test_a_bench_judges_actions_that_only_a_fault_opens_up() -> None:
    (own,) = own_tasks([EXAMPLES / "hospital"]).items()
    cell = Cell(own[0], "tpvqa", "oracle", "symbolic", "limits=none,disturbance=1,failure=0.4")
    rows = [stage(*own).run(cell, TrialConfig(), episode) for episode in range(4)]
    assert not any(row.error for row in rows)
    assert stage(*own).actions["(pick_up drops floor_one bay_one)"].name == "pick_up"


def test_conditions_of_a_bench_name_dead_skills_and_things_elsewhere() -> None:
    text = normalised(" dead = pick_up  apple + wash , elsewhere=1 ,failure=0 ")
    assert text == "dead=pick_up apple+wash,elsewhere=1,failure=0"
    cell = Cell("eat_apple", "tp", "oracle", "symbolic", text)
    config = cell.config(TrialConfig(), 3)
    assert config.simulation == SimulationConfig(dead="pick_up apple+wash", elsewhere=1, failure=0)
    row = stage("eat_apple").run(cell, TrialConfig(), 3)
    assert not row.error
    with pytest.raises(BenchError, match="elsewhere=THINGS"):
        Cell("eat_apple", "tp", "oracle", "symbolic", "elsewhere=some").config(TrialConfig(), 0)


def test_a_start_and_things_elsewhere_do_not_go_together() -> None:
    with pytest.raises(ValueError, match="or how many things to move"):
        SimulationConfig(true_start="file", elsewhere=1)


def test_settings_of_a_bench_are_as_before_where_the_world_behaves(tmp_path: Path) -> None:
    usual = common_settings(TrialConfig())
    assert usual.keys() >= {"failure", "disturbance", "spontaneous"}
    assert not usual.keys() & {"redo", "moved", "dead", "true_start", "elsewhere"}
    start = tmp_path / "start.txt"
    start.write_text("(on knife fridge)")
    told = common_settings(TrialConfig().but(simulation={"true_start": str(start), "dead": "find"}))
    assert told["dead"] == "find"
    start.write_text("(on knife table)")
    again = common_settings(
        TrialConfig().but(simulation={"true_start": str(start), "dead": "find"})
    )
    assert again["true_start"] != told["true_start"]


def test_a_dead_skill_is_no_failure_of_what_is_done_already() -> None:
    rules = load_world_file(find_task("eat_apple").world, TASK)
    simulation = Simulation(TASK, rules, failure=0, dead=Dead.parse("find", TASK))
    action = next(each for each in TASK.ground_actions() if each.name == "find")
    if simulation.possible(action):
        assert simulation.execute(action).failure is Failure.DEAD
    simulation.state = TASK.apply(simulation.state, action)
    assert simulation.execute(action).succeeded
