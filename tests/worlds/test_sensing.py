"""What a simulated robot senses, and what its skills notice."""

from collections import Counter
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.pddl.feature_domains import DERIVED
from tpvqa.observation import SensedFact
from tpvqa.pddl import Action, Atom, Task, load_task, task_from_text
from tpvqa.worlds import Report
from tpvqa.worlds.scripted import ScriptedWorld
from tpvqa.worlds.simulation import Redo, Simulation
from tpvqa.worlds.symbolic import SymbolicWorld
from tpvqa.worlds.world_file import WorldRules, load_world_file

WARD = Path(__file__).parents[1] / "fixtures" / "drawers"
TASK = load_task(WARD / "domain.pddl", WARD / "problem.pddl")
UPPER, LOWER = Atom("contaminated", ("upper",)), Atom("contaminated", ("lower",))
OPEN = TASK.action("open_drawer", ["upper"])
DISINFECT = TASK.action("disinfect", ["upper"])


def rules(text: str, folder: Path, task: Task = TASK) -> WorldRules:
    path = folder / "world.yaml"
    path.write_text(text)
    return load_world_file(path, task)


def sensed(text: str, folder: Path, *actions: Action) -> list[set[Atom]]:
    """Which facts are sensed at a first look, and after each action."""
    world = SymbolicWorld(Simulation(TASK, rules(text, folder), failure=0.0))
    found = [world.observe().facts, *(world.execute(action).facts for action in actions)]
    return [{fact.atom for fact in facts} for facts in found]


@pytest.mark.parametrize(
    ("at", "found"),
    [
        ("effect", [set(), set(), {UPPER}]),
        ("action", [set(), {UPPER, LOWER}, {UPPER, LOWER}]),
        ("look", [{UPPER, LOWER}, set(), set()]),
        ("[look, effect]", [{UPPER, LOWER}, set(), {UPPER}]),
    ],
)
def test_a_fact_is_sensed_on_its_occasions(at: str, found: list[set[Atom]], tmp_path: Path) -> None:
    text = f"sensed: [{{fact: '(contaminated ?d)', at: {at}}}]"
    assert sensed(text, tmp_path, OPEN, DISINFECT) == found


def test_by_default_all_of_it_is_sensed_after_every_action_and_right(tmp_path: Path) -> None:
    told = rules("sensed: [{fact: '(contaminated ?d)'}]", tmp_path)
    for failure in (0.0, 1.0):
        simulation = Simulation(TASK, told, failure=failure)
        world = SymbolicWorld(simulation)
        assert world.observe().facts == ()
        for action in (OPEN, DISINFECT):
            facts = world.execute(action).facts
            true = {atom: float(atom in simulation.state) for atom in (LOWER, UPPER)}
            assert {each.atom: each.probability for each in facts} == true


@settings(max_examples=20)
@given(st.floats(0, 1), st.integers(0, 1000))
def test_readings_are_right_as_often_as_they_are_said_to_be(
    tmp_path_factory: pytest.TempPathFactory, right: float, seed: int
) -> None:
    text = f"sensed: [{{fact: (contaminated upper), right: {right}, claims: 0.9}}]"
    told = rules(text, tmp_path_factory.mktemp("world"))
    count = Counter[bool]()
    for episode in range(200):
        simulation = Simulation(TASK, told, failure=0.5, seed=seed, episode=episode)
        simulation.execute(OPEN)
        (fact,) = simulation.execute(DISINFECT).sensed
        assert fact.probability in (0.9, 0.1)
        count[(fact.probability > 0.5) == (UPPER in simulation.state)] += 1
    assert abs(count[True] / 200 - right) < 4.5 * (0.25 / 200) ** 0.5


def test_a_reading_stays_until_something_is_done_and_comes_again_where_it_is_put_back(
    tmp_path: Path,
) -> None:
    told = rules(
        "sensed: [{fact: '(contaminated ?d)', right: 0.6, at: [look, action]}]\n"
        "reports: [{notices: 0.5, false_alarms: 0.5}]",
        tmp_path,
    )

    def world(episode: int) -> SymbolicWorld:
        return SymbolicWorld(Simulation(TASK, told, episode=episode))

    seen, differ = [], 0
    for episode in range(30):
        one, other = world(episode), world(episode)
        one.execute(OPEN)
        looks = [one.observe().facts for _ in range(3)]
        assert looks[0] == looks[1] == looks[2]
        other.restore(one.snapshot())
        assert other.observe().facts == looks[0]
        after = [each.execute(DISINFECT) for each in (one, other)]
        assert after[0] == after[1]
        differ += one.execute(DISINFECT).facts != after[0].facts
        seen.append(looks[0])
    assert len(set(map(tuple, seen))) > 1
    assert differ


def test_of_several_rules_for_a_fact_the_first_counts(tmp_path: Path) -> None:
    text = "sensed: [{fact: (contaminated upper), right: 0.8}, {fact: '(contaminated ?d)'}]"
    facts = SymbolicWorld(Simulation(TASK, rules(text, tmp_path))).execute(OPEN).facts
    sure = {each.atom: abs(each.probability - 0.5) for each in facts}
    assert sure == {UPPER: pytest.approx(0.3), LOWER: 0.5}


def test_derived_facts_are_sensed_as_they_follow(tmp_path: Path) -> None:
    task = task_from_text(DERIVED.domain, DERIVED.problem)
    told = rules("sensed: [{fact: '(clear ?x)', at: look}]", tmp_path, task)
    simulation = Simulation(task, told)
    facts = simulation.sensed()
    true = task.extend(simulation.state)
    assert {each.probability for each in facts} == {0.0, 1.0}
    assert all(each.probability == float(each.atom in true) for each in facts)


def test_a_skill_reports_as_many_failures_as_it_notices(tmp_path: Path) -> None:
    text = "reports: [{action: open_drawer, notices: 0.7, false_alarms: 0.1}]"
    told, count = rules(text, tmp_path), Counter[tuple[bool, Report]]()
    for episode in range(400):
        world = SymbolicWorld(Simulation(TASK, told, failure=0.5, episode=episode))
        report = world.execute(OPEN).report
        assert world.last_outcome is not None
        count[world.last_outcome.succeeded, report] += 1
        assert world.execute(TASK.action("close_drawer", ["upper"])).report is Report.DONE
    failed = count[False, Report.FAILED] / (count[False, Report.FAILED] + count[False, Report.DONE])
    worked = count[True, Report.FAILED] / (count[True, Report.FAILED] + count[True, Report.DONE])
    assert 0.58 < failed < 0.82
    assert 0.03 < worked < 0.2


def test_a_skill_that_refuses_what_is_impossible_notices_no_other_failure(tmp_path: Path) -> None:
    told = rules("reports: [{refuses: 1}]", tmp_path)
    for failure in (0.0, 1.0):
        world = SymbolicWorld(Simulation(TASK, told, failure=failure))
        assert world.execute(DISINFECT).report is Report.FAILED  # the drawer is shut
        assert world.execute(OPEN).report is Report.DONE
    noticing = rules("reports: [{notices: 1}]", tmp_path)
    assert SymbolicWorld(Simulation(TASK, noticing)).execute(DISINFECT).report is Report.FAILED


def test_a_script_changes_what_is_sensed_after_it(tmp_path: Path) -> None:
    told = rules("sensed: [{fact: (contaminated upper)}]", tmp_path)
    script = tmp_path / "story.yaml"
    script.write_text(
        "script:\n  - {action: (disinfect upper), fails: true}\n"
        "  - {action: (disinfect upper), attempt: 3, then: {add: (contaminated upper)}}"
    )
    world = ScriptedWorld.from_spec(
        "", simulation=Simulation(TASK, told, redo=Redo.RISKY), script_file=script
    )
    world.execute(OPEN)
    found = [world.execute(DISINFECT).facts for _ in range(3)]
    assert found == [(SensedFact(UPPER, p),) for p in (1.0, 0.0, 1.0)]
