"""ViPlan's problems: the noise of whole recorded scenes, the bench, and what stands beside it."""

import json
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from tests.doubles import made
from tpvqa.bench.statistics import Interval
from tpvqa.cli.app import app
from tpvqa.config import TrialConfig
from tpvqa.errors import BenchError, PluginError, UnknownNameError
from tpvqa.observation import Observation
from tpvqa.pddl import Atom, Literal, State, Task, load_task
from tpvqa.questions import QuestionBook
from tpvqa.vlm import Reply
from tpvqa_experiments.viplan.bench import KNOWING, ViPlanBench, run_viplan_bench
from tpvqa_experiments.viplan.calibrations import calibration, counted, exact
from tpvqa_experiments.viplan.noise import LASTING, as_seen
from tpvqa_experiments.viplan.problems import Environment, problems_in
from tpvqa_experiments.viplan.published import Published, published
from tpvqa_experiments.viplan.scenes import facts_of, models, scenes, true_facts
from tpvqa_experiments.viplan.tables import lies_in

DOMAIN = """(define (domain blocksworld)
  (:requirements :strips :typing :negative-preconditions :conditional-effects :equality)
  (:types block column)
  (:predicates (on ?b1 ?b2 - block) (clear ?b - block) (inColumn ?b - block ?c - column))
  (:action moveBlock :parameters (?b1 - block ?c1 - column)
    :precondition (and (clear ?b1) (not (inColumn ?b1 ?c1)))
    :effect (and (inColumn ?b1 ?c1)
      (forall (?c2 - column) (when (inColumn ?b1 ?c2) (not (inColumn ?b1 ?c2))))
      (forall (?b2 - block) (and
        (when (on ?b1 ?b2) (and (not (on ?b1 ?b2)) (clear ?b2)))
        (when (and (not (= ?b1 ?b2)) (inColumn ?b2 ?c1) (clear ?b2))
          (and (on ?b1 ?b2) (not (clear ?b2)))))))))"""
PROBLEM = """(define (problem {name}) (:domain blocksworld)
  (:objects r g b - block c1 c2 c3 c4 - column)
  (:init (on g r) (clear g) (clear b) (inColumn r c1) (inColumn g c1) (inColumn b c3))
  (:goal (and (on r b) (inColumn r {goal}) (inColumn g c1))))"""
FACTS = ("on", "incolumn", "clear")
COLUMNS = "environment,setting,split,model,episodes,goal_reached,ended_before_first_action,answers"
GROUNDER = f"""{COLUMNS},right
blocksworld,no_cot,simple,Qwen2.5-VL-7B-Instruct,25,19,2,495,489
blocksworld,no_cot,simple,gemma-3-12b-it,25,1,21,52,47
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two problems of blocksworld, laid out as published."""
    root = tmp_path_factory.mktemp("viplan")
    inside = root / "blocksworld/problems/simple"
    inside.mkdir(parents=True)
    (root / "blocksworld/domain.pddl").write_text(DOMAIN)
    for number, goal in enumerate(("c3", "c4")):
        name = f"simple_problem_{100 + number}"
        (inside / f"{name}.pddl").write_text(PROBLEM.format(name=name, goal=goal))
    (root / "grounder.csv").write_text(GROUNDER)
    return root


@pytest.fixture(scope="module")
def task(folder: Path) -> Task:
    root = folder / "blocksworld"
    return load_task(root / "domain.pddl", root / "problems/simple/simple_problem_100.pddl")


class Truth:
    """What is true in a state."""

    def __init__(self, state: State):
        self.state = state

    def holds(self, atom: Atom) -> bool:
        return atom in self.state

    def visible(self, atom: Atom) -> bool:
        return True


def answers(task: Task, truth: Truth, **context: object) -> Callable[[], dict[Atom, bool]]:
    """Asks everything of `recorded-scenes:internvl3-8b`, as often as it is called."""
    vlm = made("recorded-scenes:internvl3-8b", truth=truth, task=task, **context)
    book = QuestionBook(task)
    questions = [
        book.fact(Literal(atom)) for atom in sorted(task.atoms()) if atom.predicate in task.fluents
    ]

    def ask() -> dict[Atom, bool]:
        told = vlm.ask(Observation(0), questions)
        assert {each.reply for each in told} <= {Reply.YES, Reply.NO}
        return {each.question.atom: each.reply is Reply.YES for each in told}

    return ask


def test_every_model_has_an_initial_scene_of_nearly_every_problem() -> None:
    assert len(models()) == 8
    for model in models():
        told = scenes(model)
        initial = {scene.problem for scene in told if scene.initial}
        assert 70 <= len(initial) <= 75
        right = [
            answer == (fact in true_facts(scene.columns))
            for scene in told
            for fact, answer in scene.answers.items()
        ]
        assert 0.6 < sum(right) / len(right) < 0.99


def test_the_same_state_is_answered_the_same(task: Task) -> None:
    truth = Truth(task.init)
    ask = answers(task, truth, seed=3)
    before = ask()
    truth.state = task.apply(task.init, task.action("moveblock", ("g", "c2")))
    ask()
    truth.state = task.init
    assert ask() == before == answers(task, truth, seed=3)()
    assert any(answers(task, truth, seed=seed)() != before for seed in range(4, 10))


def test_errors_outlast_a_move_more_often_than_those_of_other_trials_agree(task: Task) -> None:
    moved = task.apply(task.init, task.action("moveblock", ("g", "c2")))
    kept = {atom for atom in task.atoms() if (atom in task.init) == (atom in moved)}
    again = {True: 0, False: 0}
    wrong = dict(again)
    for seed in range(60):
        truth = Truth(task.init)
        ask = answers(task, truth, seed=seed)
        first = ask()
        truth.state = moved
        for own, later in ((True, ask()), (False, answers(task, truth, seed=seed + 1000)())):
            missed = [a for a in kept & first.keys() if first[a] != (a in task.init)]
            wrong[own] += len(missed)
            again[own] += sum(later[atom] != (atom in moved) for atom in missed)
    assert again[True] / wrong[True] > again[False] / wrong[False] + LASTING / 3


@given(st.data())
def test_seen_as_a_scene_of_the_same_shape_as_many_answers_are_wrong(data: st.DataObject) -> None:
    scene = data.draw(st.sampled_from(scenes("aya-vision-8b")))
    blocks = data.draw(st.permutations("".join(scene.columns)))
    heights = data.draw(st.permutations(scene.heights))
    cut = [sum(heights[:number]) for number in range(len(heights) + 1)]
    here = tuple("".join(blocks[a:b]) for a, b in pairwise(cut))
    seen = as_seen(here, scene, Random(0))
    true = true_facts(here)
    assert list(seen) == list(facts_of(here))
    wrong = sum(answer != (fact in true) for fact, answer in seen.items())
    assert wrong == f"{int(scene.wrong, 16):b}".count("1")


def test_what_cannot_be_answered_is_said(task: Task) -> None:
    truth = Truth(frozenset())
    with pytest.raises(PluginError, match="of 3 blocks on 4 columns"):
        made("recorded-scenes:gemma-3-12b", truth=truth, task=load_task("build_tower"))
    with pytest.raises(PluginError, match="Write recorded-scenes:MODEL"):
        made("recorded-scenes", truth=truth, task=task)
    with pytest.raises(UnknownNameError, match="gemma-3-12b"):
        made("recorded-scenes:gemma", truth=truth, task=task)


def test_a_bench_has_a_row_for_every_model_and_goes_on_where_it_was(
    folder: Path, tmp_path: Path
) -> None:
    bench = ViPlanBench(
        problems=problems_in(folder, Environment.BLOCKSWORLD, ("simple",)),
        models=("qwen2.5-vl-7b", "oracle:1"),
        monitors=("grounder",),
        limits=("20", "none"),
        episodes=3,
    )
    done: list[tuple[int, int]] = []

    def run() -> list[dict[str, object]]:
        done.clear()
        lines = run_viplan_bench(
            bench, tmp_path, published(folder), progress=lambda *told: done.append(told)
        )
        assert not any(line.errors for line in lines)
        return [line.flat() for line in lines]

    rows = run()
    assert done[-1] == (24, 24)
    first = rows[0]
    assert [(row["model"], row["limit"], row["episodes"]) for row in rows] == [
        ("qwen2.5-vl-7b", "20", 6),
        ("oracle:1", "20", 6),
        ("qwen2.5-vl-7b", "none", 6),
        ("oracle:1", "none", 6),
    ]
    assert first["recorded_completion_rate"] == 19 / 25
    assert first["recorded_ended_before_first_action"] == 2 / 25
    assert {"as_recorded", "ended_as_recorded"} <= first.keys()
    assert "as_recorded" not in rows[2]
    for sure in (rows[1], rows[3]):
        assert sure["completion_rate"] == sure["known"] == 1
        assert sure["recorded_completion_rate"] is None
    assert json.loads((tmp_path / "viplan.json").read_text()) == rows
    assert run() == rows
    assert done == [(24, 24)]


def test_beside_the_belief_stands_one_that_knows_how_answers_and_skills_err(
    folder: Path, tmp_path: Path, task: Task
) -> None:
    bench = ViPlanBench(
        problems=problems_in(folder, Environment.BLOCKSWORLD, ("simple",)),
        models=("qwen2.5-vl-72b",),
        monitors=("belief", KNOWING),
        noise="recorded",
        settings=("fail01_no_cot",),
    )
    rows = [line.flat() for line in run_viplan_bench(bench, tmp_path, {})]
    assert [row["monitor"] for row in rows] == ["belief", KNOWING]
    assert {cell.monitor for _, cell in bench.cells()} == {
        "belief",
        "belief:without=learning:failure_rate=0.1:disturbance_rate=0",
    }
    known = exact("recorded:qwen2.5-vl-72b", task)
    assert sorted(known.lasting) == [0.0] * 10 + [1.0]
    assert known.lasting_share > 0.9
    assert exact("recorded:qwen2.5-vl-72b:fresh", task).lasting_share == 0
    with pytest.raises(BenchError, match="--noise recorded"):
        exact("recorded-scenes:qwen2.5-vl-72b", task)


def test_the_command_prints_the_table(folder: Path, tmp_path: Path) -> None:
    named = ["--problems", str(folder), "--splits", "simple", "--models", "gemma-3-12b"]
    more = ["--monitors", "grounder", "--workers", "1", "--out", str(tmp_path), "--json"]
    result = CliRunner().invoke(app, ["bench", "viplan", *named, *more])
    assert result.exit_code == 0, result.output
    (row,) = json.loads(result.stdout)
    assert (row["model"], row["episodes"]) == ("gemma-3-12b", 2)
    assert "As recorded" in (tmp_path / "viplan.md").read_text()


def test_a_record_of_ones_own_is_run_on_the_problems(folder: Path, tmp_path: Path) -> None:
    table = tmp_path / "mine.csv"
    right = [f"{fact},{'yes' if truth else 'no'},{truth}" for fact in FACTS for truth in (0, 1)]
    table.write_text("\n".join(["fact,answer,truth", *right * 30]))
    named = ["--problems", str(folder), "--splits", "simple", "--models", str(table)]
    common = ["--monitors", "knowing", "--workers", "1", "--json", "--out"]
    ran = CliRunner().invoke(
        app, ["bench", "viplan", *named, "--noise", "recorded", *common, str(tmp_path)]
    )
    assert ran.exit_code == 0
    (line,) = json.loads(ran.stdout)
    assert (line["model"], line["completion_rate"]) == (str(table), 1.0)
    assert line["recorded_completion_rate"] is None
    refused = CliRunner().invoke(app, ["bench", "viplan", *named, *common, str(tmp_path / "other")])
    assert "holds no whole scenes. Say --noise recorded" in str(refused.exception)


def test_a_folder_without_problems_is_said(tmp_path: Path) -> None:
    with pytest.raises(BenchError, match="--problems"):
        problems_in(tmp_path, Environment.BLOCKSWORLD)
    assert published(tmp_path) == {}
    (tmp_path / "grounder.csv").write_text(GROUNDER.replace("19", "nineteen"))
    with pytest.raises(BenchError, match=r"grounder.csv:2: not a row"):
        published(tmp_path)


def test_a_calibration_is_learnt_from_every_other_problem(task: Task) -> None:
    told = calibration("recorded-scenes:qwen2.5-vl-72b", task)
    assert told is not None
    assert 12 * 19 <= told.rows <= 13 * 19 * 4
    assert told.repeat_same_view + told.lasting_share > 0.9
    assert calibration("oracle:0.8", task) is None


def test_how_often_skills_fail_is_counted_in_trials_of_other_seeds(folder: Path) -> None:
    problems = problems_in(folder, Environment.BLOCKSWORLD, ("simple",))
    own = {name: problem.task for name, problem in problems.items()}
    never, sometimes = (
        counted(f"failure={rate},disturbance=0", TrialConfig(), own) for rate in (0, 0.1)
    )
    assert never is not None
    assert sometimes is not None
    assert never.skills["moveblock"].failed == 0
    assert never.skills["moveblock"].worked >= 120
    few = sometimes.skills["moveblock"]
    assert 0.03 < few.failed / few.tries < 0.2


def test_rates_agree_where_one_lies_in_the_interval_of_the_other() -> None:
    ours = Interval(0.0, 0.0, 0.037)
    assert lies_in(ours, Interval(0.0, 0.0, 0.13))
    assert lies_in(ours, Interval(0.03, 0.005, 0.1))
    assert lies_in(ours, Interval(0.04, 0.007, 0.195)) is False
    assert lies_in(ours, None) is None
    assert Published(25, 1, 2, 3, 3).ended == 2
