"""Trials in which actions change numbers: asked as comparisons, measured, and mended."""

import random
import re
from collections import deque
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import pytest

from tests.doubles import configured
from tests.resumed import resumed, story, unbroken
from tpvqa.assembly import Trial
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.errors import PDDLError, QuestionsError, TpvqaError, WorldFileError
from tpvqa.events import Event
from tpvqa.events.events import Acted, Asked, Decided, Ended
from tpvqa.monitors.memory import FactMemory
from tpvqa.pddl import Atom, State, Task, load_task
from tpvqa.pddl.arithmetic import number, values_in
from tpvqa.pddl.numeric import with_values
from tpvqa.pddl.state_file import read_state
from tpvqa.planning import Plan, Planner, Unsolvable
from tpvqa.planning.clingo import ClingoPlanner
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.remembering import remembering
from tpvqa.planning.unified_engine import UnifiedEngine
from tpvqa.questions import QuestionBook
from tpvqa.worlds.capabilities import simulation_of
from tpvqa.worlds.world_file import load_world_file

pytest.importorskip("up_aries")

ROVER = Path(__file__).parents[1] / "examples/numbers/rover"


def _config(world: str) -> TrialConfig:
    return configured(
        domain=str(ROVER / "domain.pddl"),
        problem=str(ROVER / "problem.pddl"),
        questions=str(ROVER / "questions.yaml"),
        world_file=str(ROVER / world),
        planner="up:aries",
        monitor="tpvqa",
        vlm="oracle:1.0",
    )


CONFIG = _config("world.yaml")


@pytest.fixture(scope="module")
def planner() -> Iterator[Planner]:
    planner = remembering(UnifiedEngine("aries"))
    yield planner
    planner.close()


@pytest.fixture(scope="module")
def task() -> Task:
    return load_task(ROVER / "domain.pddl", ROVER / "problem.pddl")


def run(config: TrialConfig, planner: Planner) -> list[Event]:
    writer = MemoryWriter()
    with Trial(config, planner=planner) as trial:
        trial.run(writer)
    return writer.events


def completed(events: list[Event]) -> bool:
    last = events[-1]
    assert isinstance(last, Ended)
    return last.completed is True


def test_comparisons_are_asked_before_and_after(planner: Planner) -> None:
    events = run(CONFIG.but(simulation={"failure": 0.0}, seed=1), planner)
    asked = [q for event in events if isinstance(event, Asked) for q in event.questions]
    said = {(each.way, each.atom.split()[0][1:], each.text) for each in asked if each.atom}
    comparisons = {(way, operator) for way, operator, _ in said if operator in (">=", "<=")}
    assert comparisons >= {("precondition", ">="), ("effect", "<="), ("effect", ">=")}
    for _, operator, text in said:
        if operator == ">=":
            assert re.search(r"(display|basket) show at least [0-9.]+ (percent|kg)\?", text)


def test_what_drained_is_found_out_and_charged(planner: Planner) -> None:
    """Of 12 seeds some drain the battery below what the plan needs."""
    reached = replanned = 0
    for seed in range(1, 13):
        events = run(CONFIG.but(seed=seed), planner)
        reached += completed(events)
        replanned += any(
            isinstance(each, Decided) and each.decision == "replan" and "percent" in each.reason
            for each in events
        )
    assert reached >= 4
    assert replanned


def test_a_measured_number_is_believed(planner: Planner) -> None:
    config = _config("world-sensed.yaml").but(vlm="oracle:0.8", seed=3)
    events = run(config, planner)
    acted = [each for each in events if isinstance(each, Acted)]
    assert all(each.facts and each.facts[0].atom.startswith("(= (battery) ") for each in acted)
    assert any(isinstance(e, Decided) and "measured: battery = " in e.reason for e in events)


def test_killed_it_is_gone_on_with_to_the_same_end(planner: Planner, tmp_path: Path) -> None:
    whole = unbroken(tmp_path / "whole", CONFIG.but(seed=5), planner)
    for cut in range(1, len(whole), max(1, len(whole) // 5)):
        assert story(resumed(tmp_path / "whole", cut, planner)) == story(whole), cut


def test_plans_are_found_where_there_are_any(planner: Planner, task: Task) -> None:
    """Beside a search through all states: from random values of the battery."""
    draw = random.Random(0)
    for battery in draw.sample(range(0, 100, 10), 4):
        state = with_values(task.init, {("battery",): number(str(battery))})
        solvable = _solvable(task, state)
        result = planner.plan(task, state, timeout=5)
        assert isinstance(result, Plan) or not solvable  # what is found is replayed


def test_what_numbers_cannot_come_to_is_told_without_a_search(planner: Planner, task: Task) -> None:
    """A basket that is believed full of nothing cannot be emptied."""
    state = with_values(task.init, {("load",): number("3")})
    result = planner.plan(task, state, timeout=5)
    assert isinstance(result, Unsolvable)
    assert not _solvable(task, state)


def test_nothing_to_do_is_a_plan(planner: Planner, task: Task) -> None:
    state = task.init
    plan = planner.plan(task, state, timeout=10)
    assert isinstance(plan, Plan)
    for action in plan.actions:
        state = task.apply(state, action)
    nothing = planner.plan(task, state, timeout=5)
    assert isinstance(nothing, Plan)
    assert nothing.actions == ()


AIRCRAFT = configured(
    domain=str(ROVER.parent / "aircraft" / "domain.pddl"),
    problem=str(ROVER.parent / "aircraft" / "problem.pddl"),
    planner="up:aries",
    monitor="tpvqa",
    vlm="oracle:1.0",
)


@pytest.mark.parametrize("seed", range(1, 7))
def test_without_a_world_file_numbers_go_with_what_is_undone(seed: int, planner: Planner) -> None:
    """As many are on board as are in the aircraft, whatever fell out of it."""
    writer = MemoryWriter()
    config = AIRCRAFT.but(seed=seed, simulation={"disturbance": 0.5})
    with Trial(config, planner=planner) as trial:
        trial.run(writer)
        true = simulation_of(trial.parts.world).state
    inside = sum(atom.predicate == "in" for atom in true)
    assert values_in(true)["onboard", "plane1"] == inside
    assert isinstance(writer.events[-1], Ended)


def test_a_number_that_nobody_sees_is_doubted_after_three_failures(planner: Planner) -> None:
    reached = doubted = 0
    for seed in range(1, 9):
        writer = MemoryWriter()
        with Trial(AIRCRAFT.but(seed=seed), planner=planner) as trial:
            trial.run(writer)
        reached += completed(writer.events)
        for event in writer.events:
            if isinstance(event, Decided) and "of what is never asked" in event.reason:
                doubted += 1
                assert event.decision == "replan"
                assert re.search(r"failed 3 times.* fuel\(plane1\) = \d+ is believed", event.reason)
    assert doubted
    assert reached >= 5


def _solvable(task: Task, start: State) -> bool:
    seen, waiting = {start}, deque([start])
    while waiting:
        state = waiting.popleft()
        if task.goal_holds(state):
            return True
        for action in task.ground_actions():
            if task.applicable(state, action):
                after = task.apply(state, action)
                if after not in seen:
                    seen.add(after)
                    waiting.append(after)
    return False


@pytest.mark.parametrize("planner", [FastDownward(), ClingoPlanner()], ids=lambda each: each.name)
def test_who_knows_no_numbers_says_who_does(planner: Planner, task: Task) -> None:
    result = planner.plan(task)
    assert not isinstance(result, Plan)
    assert "up:aries" in getattr(result, "reason", "")


def test_the_belief_monitor_is_refused() -> None:
    with pytest.raises(TpvqaError, match=r"change numbers \(battery, load\)"):
        Trial(CONFIG.but(monitor="belief"))


def test_what_was_used_up_comes_back_only_from_the_number_as_it_was_left(task: Task) -> None:
    memory, at = FactMemory(task), Atom("at", ("hill",))
    there = task.apply(task.init, task.action("drive", ("base", "hill")))
    memory.record(task.init, there)
    assert memory.came_with(at, there) == {("battery",): -20}
    assert not memory.came_with(at, with_values(there, {("battery",): Fraction(100)}))


@pytest.mark.parametrize(
    "lines",
    [
        "(at base)\n(= (battery) 60.0) (= (load) .5)",
        '[["at", "base"], ["=", "battery", "60"], "(= (load) 1/2)"]',
    ],
)
def test_a_state_file_gives_values(lines: str, task: Task, tmp_path: Path) -> None:
    file = tmp_path / "state"
    file.write_text(lines)
    state = read_state(file, task)
    assert values_in(state) == {("battery",): 60, ("load",): Fraction(1, 2)}
    assert Atom("at", ("base",)) in state


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("(at base)", "gives (battery) no value"),
        ("(= (battery) 1e99999999)", "'1e99999999' is no number"),
        ("(>= (battery) 5)", "it compares"),
        ("(= (battery) 5) (= (battery) 6)", "it has the value 5 already"),
        ("(= (way hill mud) 5)", "mud is a sample, but ?b of way must be a place"),
        ("(= (capacity) 5)", "no action changes capacity"),
        ("(= (battery) (load))", "is no value of a function"),
        ("(= (battery 5", "')' is missing"),
    ],
)
def test_a_state_file_whose_numbers_do_not_fit(
    line: str, says: str, task: Task, tmp_path: Path
) -> None:
    file = tmp_path / "state"
    file.write_text(f"(= (load) 0)\n{line}")
    with pytest.raises(PDDLError) as caught:
        read_state(file, task)
    assert says in str(caught.value)


def test_a_number_without_words_is_not_asked(task: Task, tmp_path: Path) -> None:
    file = tmp_path / "questions.yaml"
    file.write_text('numbers:\n  battery: "Is the battery {comparison} {number}?"\n')
    book = QuestionBook.load(file, task)
    assert any("number load" in notice for notice in book.notices)
    collect = book.preconditions(task.action("collect", ["flint", "hill"]), task.init)
    assert not any("load" in each.text for each in collect)
    file.write_text('numbers:\n  battery: "Is the battery full?"\n')
    with pytest.raises(QuestionsError, match=r":2: .*\{comparison\} is missing"):
        QuestionBook.load(file, task)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("numbers:\n  - of: batery\n", "Did you mean 'battery'"),
        ("numbers:\n  - of: capacity\n", "actions change no number 'capacity'"),
        ("numbers:\n  - of: battery\n    drift: {by: -10}\n", "needs 'by' and 'chance'"),
        ("numbers:\n  - of: battery\n    drift: {by: much, chance: 1}\n", "such as -10"),
        (
            'undo:\n  - fact: "(aboard ?s)"\n    outcomes: [{numbers: "(decrease (load) 1 2)"}]\n',
            "changes no number",
        ),
        (
            'undo:\n  - fact: "(aboard ?s)"\n    outcomes: [{numbers: "(decrease (load) '
            '(weight ?x))"}]\n',
            "nothing says what ?x stands for",
        ),
        *(
            (f'undo:\n  - fact: "(aboard ?s)"\n    outcomes: [{{numbers: "{change}"}}]\n', says)
            for change, says in [
                ("(decrease (load) much)", "found 'much'"),
                ("(decrease (load) ?s)", "found '?s'"),
                ("(decrease (load) 1e99999999)", "found '1e99999999'"),
                ("(decrease (load) (+ 1 2 3))", "wants two numbers"),
                ("(decrease (load) (/ 1 0.0))", "divides by 0"),
                ("(decrease (load) (weight hill))", "has no value in this task"),
                ("(" * 3000, "changes no number"),
            ]
        ),
    ],
)
def test_a_world_file_that_does_not_fit(text: str, says: str, task: Task, tmp_path: Path) -> None:
    file = tmp_path / "world.yaml"
    file.write_text(text)
    with pytest.raises(WorldFileError) as caught:
        load_world_file(file, task)
    assert says in str(caught.value)
