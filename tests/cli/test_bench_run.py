"""`tpvqa bench run`, as anybody types it: own domains, plug-ins, conditions, resuming."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from shutil import copy
from typing import Any

import pytest

from tests.cli.conftest import Run
from tests.conftest import Install
from tpvqa.belief import Calibration
from tpvqa.bench.cell import Cell
from tpvqa.bench.ledger import ROWS
from tpvqa.bench.own_task import OwnTask, own_tasks
from tpvqa.bench.stage import Stage
from tpvqa.config import TrialConfig

TOYS = Path(__file__).parents[1] / "fixtures" / "toys"
COLLECT = TOYS / "collect.pddl"
OWN = ["--domain", TOYS / "domain.pddl", "--problem", COLLECT]
QUICK = ["--vlm", "oracle:0.9", "--workers", 1, "--json"]
ROW = """
(define (problem row) (:domain blocksworld)
  (:objects red green - block  c1 c2 - column)
  (:init (on green c1) (on red green) (clear red) (clear c2)
         (incolumn c1 c1) (incolumn c2 c2) (incolumn green c1) (incolumn red c1))
  (:goal (on green red)))
"""
PLUGGED = """
from tpvqa.monitors.none import NoMonitor
from tpvqa.vlm import Answer, Reply
from tpvqa.worlds.symbolic import SymbolicWorld

class Blind(NoMonitor):
    pass

class Yes:
    name = "yes"

    def __init__(self, eagerness: str, seed: int, episode: int):
        self.told = (eagerness, seed, episode)

    def ask(self, observation, questions):
        assert self.told[0] == "great"
        return [Answer(question, Reply.YES, 0.9) for question in questions]

class Robot:
    def views(self):
        return []
"""


def rows_of(folder: str | Path) -> dict[tuple[str, ...], dict[str, Any]]:
    """All rows by cell and episode, without how long they took."""
    found = {}
    for line in (Path(folder) / ROWS).read_text(encoding="utf-8").splitlines():
        row = json.loads(line)
        row.pop("seconds")
        key = tuple(str(row[name]) for name in ("task", "monitor", "vlm", "condition", "episode"))
        assert key not in found, f"{key} was run twice"
        found[key] = row
    return found


def test_an_own_domain_gives_what_the_papers_bench_gives(tpvqa: Run) -> None:
    words = [*OWN, "--questions", TOYS / "questions.yaml", "--monitors", "tpvqa,belief,tp"]
    words += ["--conditions", "; failure=0.4, actions=20", "--episodes", 2, *QUICK]
    code, out, err = tpvqa("bench", "run", *words, "--out", "one")
    assert code == 0, err
    assert "no calibration of oracle:0.9" in err
    table = json.loads(out)
    assert [(row["task"], row["monitor"], row["condition"]) for row in table] == [
        ("collect", monitor, condition)
        for condition in ("", "failure=0.4,actions=20")
        for monitor in ("tpvqa", "belief", "tp")
    ]
    assert {row["episodes"] for row in table} == {2}
    assert not any(row["errors"] for row in table)
    rows = rows_of("one")
    assert max(r["actions"] for k, r in rows.items() if k[3]) <= 20
    for name in ("summary", "episodes", "answers", "decisions", "limits"):
        for ending in ("csv", "parquet"):
            assert (Path("one") / f"{name}.{ending}").stat().st_size > 200
    report = Path("one/report.html").read_text(encoding="utf-8")
    assert "oracle:0.9, failure=0.4,actions=20" in report

    paper = ["--tasks", "build_tower", "--monitors", "tpvqa,belief,tp", "--curve", 0]
    code, out, err = tpvqa("bench", "paper", *paper, "--episodes", 2, *QUICK, "--out", "paper")
    assert code == 0, err
    published = json.loads(out)
    assert [row["monitor"] for row in published] == ["tpvqa", "belief", "tp"]
    assert [list(row) for row in published] == [list(row) for row in table[:3]]
    assert list(table[1])[-1] == "against_tpvqa"

    code, _, err = tpvqa("bench", "run", *words, "--seed", 1, "--out", "one")
    assert code == 2
    assert "other settings (seed 0 there, 1 here)" in err
    assert rows_of("one") == rows


@pytest.mark.parametrize("condition", [False, True])
def test_a_file_that_says_something_else_since_needs_another_folder(
    tpvqa: Run, condition: bool
) -> None:
    priors = Path("priors.yaml")
    named = ["--conditions", "priors=priors.yaml"] if condition else ["--priors", priors]
    words = ["bench", "run", "build_tower", "--monitors", "belief", "--vlm", "oracle", *named]
    words += ["--workers", 1, "--out", "one"]
    priors.write_text("(on red green): 0.9\n")
    assert tpvqa(*words, "--episodes", 1)[0] == 0
    rows = Path("one", ROWS).read_bytes()
    priors.write_text("(on red green): 0.1\n")
    code, _, err = tpvqa(*words, "--episodes", 2)
    assert code == 2
    assert ("say something else" if condition else "other settings (priors") in err
    assert Path("one", ROWS).read_bytes() == rows
    priors.write_text("(on red green): 0.9\n")
    assert tpvqa(*words, "--episodes", 2)[0] == 0


def test_rows_of_which_nobody_says_how_they_came_about_are_not_gone_on_with(tpvqa: Run) -> None:
    words = ["bench", "run", "build_tower", "--monitors", "blind:1", "--episodes", 1]
    words += ["--workers", 1, "--out", "one"]
    assert tpvqa(*words)[0] == 0
    Path("one/bench.json").unlink()
    code, _, err = tpvqa(*words, "--max-actions", 9)
    assert code == 2
    assert "bench.json is missing" in err
    assert not Path("one/bench.json").exists()


def test_two_workers_and_a_folder_of_problems(tpvqa: Run, tmp_path: Path) -> None:
    folder = own_blocks(tmp_path / "blocks")
    words = ["bench", "run", folder, "--monitor", "tp,tpvqa", "--episodes", 2, "--json"]
    code, out, err = tpvqa(*words, "--workers", 1, "--out", "one")
    assert code == 0, err
    table = json.loads(out)
    tower = "blocks/build_tower.pddl"  # a shipped task has the name alone
    assert [(row["task"], row["vlm"]) for row in table] == [(tower, "oracle")] * 2 + [
        ("row", "oracle")
    ] * 2
    assert "against_tp" in table[1]
    assert tpvqa(*words, "--workers", 2, "--out", "two")[0] == 0
    assert rows_of("two") == rows_of("one")
    with (folder / "world.yaml").open("a") as file:
        file.write("# changed\n")
    code, _, err = tpvqa(*words, "--workers", 1, "--out", "one")
    assert code == 2
    assert "whose files say something else" in err


def own_blocks(folder: Path) -> Path:
    """A copy of the shipped domain with a second problem."""
    from tpvqa.tasks import find_task

    folder.mkdir()
    for file in find_task("build_tower").domain.parent.iterdir():
        if file.suffix in (".pddl", ".yaml"):
            copy(file, folder)
    (folder / "row.pddl").write_text(ROW)
    return folder


LIGHT = """
#const n = 2.
lamp(1..n).
fluent(lit(L)) :- lamp(L).
action(press(L)) :- lamp(L).
causes(press(L), lit(L)) :- lamp(L).
goal(lit(L)) :- lamp(L).
"""


def test_a_logic_program_is_a_task_however_it_is_named(tpvqa: Run, tmp_path: Path) -> None:
    folder = tmp_path / "programs"
    folder.mkdir()
    (folder / "Light.lp").write_text(LIGHT)
    words = ["--monitors", "tp", "--episodes", 1, *QUICK]
    named = ["programs/Light.lp"], ["programs"], ["--problem", "programs/Light.lp"]
    for number, way in enumerate((*named, ["--domain", "programs/Light.lp"])):
        code, out, err = tpvqa("bench", "run", *way, *words, "--out", f"b{number}")
        assert code == 0, err
        assert [(row["task"], row["errors"]) for row in json.loads(out)] == [("light", 0)]
    assert rows_of("b0") == rows_of("b1") == rows_of("b2") == rows_of("b3")
    (tmp_path / "other").mkdir()
    copy(folder / "Light.lp", tmp_path / "other")
    assert list(own_tasks([folder, tmp_path / "other"])) == ["programs/Light.lp", "other/Light.lp"]
    beside = ["--domain", TOYS / "domain.pddl"]
    code, _, err = tpvqa("bench", "run", "programs/Light.lp", *beside, *words)
    assert code == 2
    assert "Light.lp is a logic program, domain and problem in one: leave out --domain" in err


def test_a_worker_without_a_program_has_its_text(tmp_path: Path) -> None:
    file = tmp_path / "light.lp"
    file.write_text(LIGHT)
    own = own_tasks([file])["light"]
    file.unlink()
    away = Stage("light", OwnTask(own.domain, own.problem, None, None, own.origin))
    assert away.task.name == "light"
    assert away.run(Cell("light", "tpvqa", "oracle", "symbolic"), TrialConfig(), 0).completed


def test_a_worker_without_the_files_has_their_text(tmp_path: Path) -> None:
    folder = own_blocks(tmp_path / "blocks")
    own = own_tasks([folder / "row.pddl"])["row"]
    here = Stage("row", own)
    for file in folder.iterdir():
        file.unlink()
    away = Stage("row", OwnTask(own.domain, own.problem, own.questions, own.world, own.origin))
    assert away.task.init == here.task.init
    assert away.rules == here.rules
    row = away.run(Cell("row", "tpvqa", "oracle", "symbolic"), TrialConfig(), 0)
    assert (row.error, row.completed) == ("", True)


@pytest.mark.slow
def test_killed_in_the_middle_it_goes_on(tmp_path: Path) -> None:
    # Eight of tp, then eight of belief: killed among these, each that has ended is kept.
    words = ["bench", "run", *OWN, "--monitors", "tp,belief", "--episodes", 8, *QUICK, "--out"]
    start = [sys.executable, "-c", "from tpvqa.cli import main; main()", *map(str, words)]
    folder = tmp_path / "killed"
    process = subprocess.Popen(
        [*start, str(folder)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    while process.poll() is None and not (
        (folder / ROWS).exists() and (folder / ROWS).read_bytes().count(b"\n") > 8
    ):
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    before = rows_of(folder)
    assert 8 < len(before) < 16
    done = subprocess.run([*start, str(folder)], capture_output=True, text=True, check=True)
    after = rows_of(folder)
    assert before.items() <= after.items()
    assert [each["episodes"] for each in json.loads(done.stdout)] == [8, 8]
    assert len(after) == 16


def test_plug_ins_and_options(install: Install, tpvqa: Run) -> None:
    install("robot", PLUGGED, "sightless = robot:Blind", group="tpvqa.monitors")
    install("eager", PLUGGED, "yes = eager:Yes")
    install("arm", PLUGGED, "arm = arm:Robot", group="tpvqa.worlds")
    words = ["bench", "run", "build_tower", "--vlm", "yes", "--workers", 1, "--episodes", 2]
    words += ["--monitors", "sightless,tpvqa", "--world-file", "w.yaml", "--json"]
    assert "none is named" in tpvqa(*words)[2]
    words = [word for word in words if word not in ("--world-file", "w.yaml")]
    code, out, err = tpvqa(*words, "--option", "eagerness=great", "--failure", 0)
    assert code == 0, err
    assert [row["completed"] for row in json.loads(out)] == [2, 2]
    assert json.loads(Path("bench-run/bench.json").read_text())["option"] == {"eagerness": "great"}
    code, _, err = tpvqa(*words, "--option", "eagernes=great", "--out", "b")
    assert code == 2
    assert "Did you mean 'eagerness'" in err
    code, _, err = tpvqa(*words, "--worlds", "arm", "--out", "b")
    assert code == 2
    assert "not simulated" in err


def test_a_calibration_of_ones_own(tpvqa: Run) -> None:
    Calibration.default("oracle:0.9").save(Path("c.json"))
    words = ["bench", "run", "build_tower", "--episodes", 1, *QUICK, "--calibration", "c.json"]
    code, _, err = tpvqa(*words, "--monitors", "belief")
    assert code == 0, err
    assert "note" not in err
    assert "calibration" in json.loads(Path("bench-run/bench.json").read_text())
    code, _, err = tpvqa(*words, "--monitors", "tp")
    assert code == 2
    assert "No monitor weighs answers" in err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "No task is named"),
        (["build_towr"], "Did you mean 'build_tower'"),
        (["build_tower", "--vlm", "oracel:0.9"], "Did you mean 'oracle'"),
        (["build_tower", "--vlm", "oracle:2"], "oracle"),
        (["build_tower", "--monitors", "tpvq"], "Did you mean 'tpvqa'"),
        (["build_tower", "--monitors", "belief:x=1"], "belief"),
        (["build_tower", "--monitors", ","], "--monitors names nothing"),
        (["build_tower", "--worlds", "symbolik"], "Did you mean 'symbolic'"),
        (["build_tower", "--vlm", "embedded", "--worlds", "symbolic"], "looks at pictures"),
        (["build_tower", "--conditions", "failures=1"], "is not understood"),
        (["build_tower", "--conditions", "failure=2"], "is not understood"),
        (["build_tower", "--conditions", "repeats=0.5"], "is not understood"),
        (["build_tower", "--conditions", "wording=loud"], "is not understood"),
        (["build_tower", "--conditions", "planner=slow"], "no planner 'slow'"),
        (["build_tower", "--conditions", "believed=oracle:0.9"], "--calibration"),
        (["build_tower", "--domain", "d.pddl"], "none is named"),
        (["nowhere/p.pddl"], "cannot be read"),
        ([COLLECT, "--domain", "nowhere.pddl"], "nowhere.pddl"),
        (["--problem", "."], "holds no problem"),
    ],
)
def test_what_is_wrong_is_said_before_anything_runs(
    tpvqa: Run, words: list[str], said: str
) -> None:
    code, _, err = tpvqa("bench", "run", *words, "--episodes", 1, "--out", "b")
    assert code == 2
    assert said in err
    assert "Traceback" not in err
    assert not Path("b").exists()


@pytest.mark.parametrize("out", ["plain", "plain/below"])
def test_a_file_in_the_place_of_the_folder_is_told_as_what_cannot_be_written(
    tpvqa: Run, out: str
) -> None:
    Path("plain").touch()
    code, _, err = tpvqa("bench", "run", *OWN, *QUICK, "--episodes", 1, "--out", out)
    assert code == 6
    assert f"{out}: cannot be written (plain is no folder). Name another folder" in err


@pytest.mark.parametrize("name", ["bench.json", "tasks.json"])
@pytest.mark.parametrize("text", ["[]", "[" * 200_000])
def test_a_damaged_folder_is_told_as_one(tpvqa: Run, name: str, text: str) -> None:
    Path("b").mkdir()
    Path("b", name).write_text(text)
    code, _, err = tpvqa("bench", "run", *OWN, *QUICK, "--episodes", 1, "--out", "b")
    assert code == 2
    assert f"b/{name}: damaged" in err


def test_the_core_alone_has_run_and_says_where_the_others_are(
    tpvqa: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tpvqa.cli.plugged.names", lambda kind: [])
    out = tpvqa("bench", "--help")[1]
    assert "run" in out
    assert "paper" not in out
    code, _, err = tpvqa("bench", "belief")
    assert code == 2
    assert "comes with tpvqa-experiments" in err


def test_a_problem_without_a_plan_is_refused_at_the_start(tpvqa: Run, tmp_path: Path) -> None:
    (tmp_path / "lamp.lp").write_text("fluent(lit). action(a). causes(a, -lit). goal(lit).\n")
    code, out, err = tpvqa("bench", "run", "lamp.lp", *QUICK, "--monitors", "tp")
    assert (code, out) == (2, "")
    assert "lamp: there is no plan from the start: " in err


def test_a_domain_may_stand_before_its_problems(tpvqa: Run, tmp_path: Path) -> None:
    """As with every other command that takes a task."""
    folder = own_blocks(tmp_path / "blocks")
    (folder / "domain.pddl").rename(folder / "columns.pddl")
    pair = [folder / "columns.pddl", folder / "row.pddl"]
    words = ["--monitors", "tp", "--episodes", 1, "--workers", 1, "--json", "--out", "pair"]
    code, out, err = tpvqa("bench", "run", *pair, *words)
    assert code == 0, err
    assert [row["task"] for row in json.loads(out)] == ["row"]


def test_what_is_refused_is_not_advised_on_before(tpvqa: Run) -> None:
    words = [*OWN, "--vlm", "oracle:3", "--monitors", "belief"]
    code, _, err = tpvqa("bench", "run", *words)
    assert code == 2
    assert "calibrate" not in err
    code, _, err = tpvqa("bench", "run", *OWN, *QUICK, "--conditions", "failure=7")
    assert code == 2
    assert "rates of faults from 0 to 1" in err


def test_what_lies_in_the_folder_besides_is_named(tpvqa: Run) -> None:
    words = ["build_tower", "--vlms", "oracle", "--worlds", "symbolic", "--episodes", 2]
    words += ["--workers", 1, "--out", "bench"]
    _, _, err = tpvqa("bench", "run", *words, "--monitors", "tp")
    assert "in no table" not in err
    code, _, err = tpvqa("bench", "run", *words, "--monitors", "blind:2")
    assert code == 0, err
    assert "2 of the finished episodes in bench are in no table now" in err
    code, _, err = tpvqa("bench", "run", *words, "--monitors", "tp,blind:2")
    assert code == 0, err
    assert "in no table" not in err
    words[words.index("--episodes") + 1] = 1
    _, _, err = tpvqa("bench", "run", *words, "--monitors", "tp,blind:2")
    assert "2 of the finished episodes in bench are in no table now" in err
    assert len(rows_of("bench")) == 4
