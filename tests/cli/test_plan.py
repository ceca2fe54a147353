"""`tpvqa plan` and `tpvqa tasks` as a user types them."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.cli.conftest import Run
from tests.pddl.feature_domains import EXHAUSTED
from tests.planning.test_processes import HARD_DOMAIN, alive, children, eventually, hard_problem


class Done(NamedTuple):
    """What came of a command."""

    returncode: int
    stdout: str
    stderr: str


Typed = Callable[..., Done]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with spaces in its name, which has to stay as it is."""
    folder = tmp_path / "my own folder"
    folder.mkdir()
    return folder


@pytest.fixture
def typed(tpvqa: Run, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Typed:
    """Run a command in that folder."""
    monkeypatch.chdir(folder)
    return lambda *words: Done(*tpvqa(*words))


def test_a_shipped_task(folder: Path) -> None:
    words = [sys.executable, "-m", "tpvqa", "plan", "clean_dishes"]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0
    lines = done.stdout.splitlines()
    assert lines[0].strip() == "1. find(plate, tv)"
    assert lines[-1].startswith("cost 4, fast-downward, ")
    assert os.listdir(folder) == []


def test_json(typed: Typed) -> None:
    done = typed("plan", "eat_apple", "--json", "--optimal")
    assert done.returncode == 0
    result = json.loads(done.stdout)
    assert set(result) == {"plan", "cost", "planner", "seconds"}
    assert result["plan"][1] == {"name": "open", "arguments": ["fridge"]}
    assert result["cost"] == 7
    assert result["planner"] == "fast-downward:optimal"
    assert 0 < result["seconds"] < 60


def test_the_planner_by_name(typed: Typed) -> None:
    done = typed("plan", "clean_dishes", "--planner", "fast-downward:lama")
    assert done.returncode == 0
    assert done.stdout.splitlines()[-1].startswith("cost 4, fast-downward:lama, ")
    for words, says in (
        (["--planner", "fast-downward:lamma"], "Did you mean 'lama'? Write fast-downward,"),
        (["--planner", "fast-forward"], "Did you mean 'fast-downward'?"),
        (["--planner", "fast-downward:lama", "--optimal"], "--optimal is short for"),
    ):
        done = typed("plan", "clean_dishes", *words)
        assert (done.returncode, done.stdout) == (2, "")
        assert says in done.stderr


def test_own_files_and_another_state(typed: Typed, folder: Path) -> None:
    (folder / "my domain.pddl").write_text(EXHAUSTED.domain)
    (folder / "my problem.pddl").write_text(EXHAUSTED.problem)
    files = ("my domain.pddl", "my problem.pddl")
    done = typed("plan", *files)
    assert done.returncode == 3
    assert "There is no plan: " in done.stderr
    assert done.stdout == ""
    (folder / "state.txt").write_text("(fresh m)\n(fresh d)\n")
    done = typed("plan", *files, "--from-state", "state.txt", "--json")
    assert done.returncode == 0
    assert {step["name"] for step in json.loads(done.stdout)["plan"]} == {"light"}
    (folder / "state.txt").write_text("(fresh m)\n(fresh z)\n")
    done = typed("plan", *files, "--from-state", "state.txt")
    assert done.returncode == 2
    assert done.stderr.startswith("error: state.txt:2: (fresh z): there is no object 'z'")


@pytest.mark.parametrize("limit", ["inf", "1e300", "10000000"])
@pytest.mark.parametrize("command", ["plan", "questions"])
def test_no_time_limit(typed: Typed, command: str, limit: str) -> None:
    done = typed(command, "clean_dishes", "--timeout", limit)
    assert (done.returncode, done.stderr) == (0, "")


def test_unsolvable_as_json(typed: Typed, folder: Path) -> None:
    (folder / "state.json").write_text('["(near tv)", "(free left)"]')
    done = typed("plan", "eat_apple", "--from-state", "state.json", "--json")
    assert done.returncode == 3
    result = json.loads(done.stdout)
    assert (result["plan"], result["result"]) == (None, "unsolvable")
    assert result["reason"]


def test_a_goal_that_holds(typed: Typed, folder: Path) -> None:
    (folder / "state.txt").write_text("(halved apple)")
    done = typed("plan", "eat_apple", "--from-state", "state.txt")
    assert done.returncode == 0
    assert "already holds" in done.stdout


@pytest.mark.parametrize("extra", [(), ("--json",)])
def test_the_time_limit(typed: Typed, folder: Path, extra: tuple[str, ...]) -> None:
    (folder / "domain.pddl").write_text(HARD_DOMAIN)
    (folder / "problem.pddl").write_text(hard_problem())
    words = ("plan", "domain.pddl", "problem.pddl", "--optimal", "--timeout", "4", *extra)
    done = typed(*words)
    assert done.returncode == 4
    if extra:
        assert json.loads(done.stdout)["result"] == "timed out"
        assert json.loads(done.stdout)["limit"] == 4
    else:
        assert "Timed out after 4 s" in done.stderr


def test_a_crash(folder: Path) -> None:
    """Where the search keeps dying, the exit code says so."""
    (folder / "domain.pddl").write_text(HARD_DOMAIN)
    (folder / "problem.pddl").write_text(hard_problem())
    words = [sys.executable, "-m", "tpvqa", "plan", "domain.pddl", "problem.pddl", "--optimal"]
    process = subprocess.Popen(words, cwd=folder, stderr=subprocess.PIPE, text=True)
    end = time.monotonic() + 240
    while process.poll() is None and time.monotonic() < end:
        for worker in children(process.pid):
            for search in children(worker):
                os.kill(search, signal.SIGSEGV)
        time.sleep(0.05)
    assert process.returncode == 5
    assert process.stderr is not None
    assert "The planner crashed" in process.stderr.read()
    process.stderr.close()


def test_ctrl_c_while_the_command_is_loaded_is_no_traceback(tmp_path: Path) -> None:
    (tmp_path / "typer.py").write_text("raise KeyboardInterrupt\n")
    words = [sys.executable, "-m", "tpvqa", "--version"]
    found = {**os.environ, "PYTHONPATH": str(tmp_path)}
    done = subprocess.run(words, env=found, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, "interrupted\n")


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_leaves_nothing_behind(how: signal.Signals, folder: Path) -> None:
    (folder / "domain.pddl").write_text(HARD_DOMAIN)
    (folder / "problem.pddl").write_text(hard_problem())
    before = sorted(os.listdir(folder))
    words = [sys.executable, "-m", "tpvqa", "plan", "domain.pddl", "problem.pddl", "--optimal"]
    process = subprocess.Popen(words, cwd=folder, stderr=subprocess.PIPE, text=True)
    assert eventually(lambda: any(children(child) for child in children(process.pid)))
    (worker,) = children(process.pid)
    searches = children(worker)
    process.send_signal(how)
    _, message = process.communicate(timeout=120)
    assert process.returncode == 130, message
    assert message == "interrupted\n"
    assert eventually(lambda: not any(map(alive, [worker, *searches])))
    assert sorted(os.listdir(folder)) == before


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("eat_aple",), "Did you mean 'eat_apple'"),
        (("gone.pddl", "gone.pddl"), "gone.pddl: cannot be read: there is no such domain file"),
        (("gone.pddl",), "is a domain or a problem alone; name both"),
        (("eat_apple", "--timeout", "soon"), "timeout"),
        (("eat_apple", "--timeout", "nan"), "timeout"),
        (("eat_apple", "--timeout", "-1"), "timeout"),
        (("eat_apple", "--timeout", "-inf"), "timeout"),
        (("eat_apple", "--from-state", "ill.txt"), "ill.txt:1: (near left): left is a hand"),
        (
            ("eat_apple", "--from-state", "gone"),
            "gone: cannot be read: there is no such state file",
        ),
    ],
)
def test_bad_input(typed: Typed, folder: Path, words: tuple[str, ...], message: str) -> None:
    (folder / "ill.txt").write_text("(near left)")
    done = typed("plan", *words)
    assert done.returncode == 2
    assert message in done.stderr
    assert "Traceback" not in done.stderr


def test_help_names_the_exit_codes(typed: Typed) -> None:
    text = " ".join(typed("plan", "--help").stdout.split())
    assert "Exit codes: 0 a plan was found, 2 bad input, or a task that is not for" in text


def test_tasks(typed: Typed) -> None:
    done = typed("tasks")
    assert done.returncode == 0
    assert "serve_breakfast  (household)" in done.stdout
    assert "on(bread, plate), turned_on(tv)" in done.stdout
    assert "(on(blue_container, goal_area), on(toy_eggplant, blue_container)) or (" in done.stdout
    listed = json.loads(typed("tasks", "--json").stdout)
    names = [entry["name"] for entry in listed]
    assert names == ["build_tower", "clean_dishes", "collect_toys", "eat_apple", "serve_breakfast"]
    assert listed[3]["goal"] == ["halved(apple)"]
    assert listed[3]["objects"]["apple"] == "fruit"
    assert Path(listed[3]["problem"]).is_file()


def test_a_task_that_is_not_for_a_planner_is_no_crash(typed: Typed) -> None:
    yard = Path(__file__).parents[2] / "examples" / "timed" / "yard"
    done = typed("plan", yard / "domain.pddl", yard / "problem.pddl")
    assert done.returncode == 2
    assert "This task cannot be planned with fast-downward: actions last here" in done.stderr
    assert "crashed" not in done.stderr


def test_no_name_of_a_planner_and_half_an_atom(typed: Typed, folder: Path) -> None:
    done = typed("plan", "clean_dishes", "--planner", "")
    assert done.returncode == 2
    assert "--planner must not be empty" in done.stderr
    (folder / "state").write_text("(free left")
    done = typed("plan", "clean_dishes", "--from-state", "state")
    assert done.returncode == 2
    assert "a ')' is missing" in done.stderr


def test_a_plan_under_a_limit_of_memory() -> None:
    command = ["bash", "-c", 'ulimit -v 1500000; exec "$0" -m tpvqa plan eat_apple', sys.executable]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "cut_in_half(apple, knife, left, right)" in done.stdout
