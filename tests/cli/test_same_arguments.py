"""`plan`, `questions`, `run` and `bench run` are told what to work on in the same way."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import Run
from tpvqa.assembly import Trial
from tpvqa.config import TaskConfig, TrialConfig

TOYS = Path(__file__).parents[1] / "fixtures" / "toys"
RUN = ("--vlm", "oracle", "--monitor", "tp", "--seed", 1, "--failure", 0)


@pytest.fixture
def toys(tmp_path: Path) -> Path:
    """A domain of one's own with its questions beside it, and a problem elsewhere."""
    folder = tmp_path / "toys"
    shutil.copytree(TOYS, folder)
    (tmp_path / "elsewhere").mkdir()
    (folder / "collect.pddl").rename(tmp_path / "elsewhere" / "collect.pddl")
    return folder


def named(toys: Path) -> dict[str, tuple[object, ...]]:
    domain, problem = toys / "domain.pddl", toys.parent / "elsewhere" / "collect.pddl"
    return {
        "positional": (domain, problem),
        "options": ("--domain", domain, "--problem", problem),
    }


@pytest.mark.parametrize("way", ["positional", "options"])
def test_a_task_of_ones_own(tpvqa: Run, toys: Path, way: str) -> None:
    words = named(toys)[way]
    assert tpvqa("plan", *words)[0] == 0
    code, out, err = tpvqa("questions", *words)
    assert code == 0
    assert "place the toy_eggplant into the blue container" in out
    assert f"note: {toys}/questions.yaml is used; name another with --questions" in err
    code, _, err = tpvqa("run", *words, *RUN, "--out", "episode")
    assert code == 0
    assert err.count("questions.yaml is used") == 1
    shown = tpvqa("config", *words)[1]
    assert f"questions: {toys}/questions.yaml  # beside the domain" in shown


def test_what_lies_beside_is_one_rule_for_the_bench_too(tpvqa: Run, toys: Path) -> None:
    domain, problem = named(toys)["positional"]
    words = ("--domain", domain, "--problem", problem, "--monitors", "tp", "--vlm", "oracle")
    code, _, err = tpvqa("bench", "run", *words, "--episodes", 1, "--workers", 1)
    assert code == 0
    assert f"note: {toys}/questions.yaml is used; name another with --questions" in err


def test_what_is_named_goes_before_what_lies_beside(tpvqa: Run, toys: Path) -> None:
    words = named(toys)["options"]
    other = toys / "other.yaml"
    other.write_text('predicates: {on: "Does the {x} lie there?"}\n')
    code, out, err = tpvqa("questions", *words, "--questions", other)
    assert code == 0
    assert "lie there?" in out
    assert "questions.yaml is used" not in err
    (toys / "trial.yaml").write_text(
        f"task: {{domain: domain.pddl, problem: {words[3]}, questions: null}}\n"
    )
    code, _, err = tpvqa("run", "--config", toys / "trial.yaml", *RUN, "--out", "other")
    assert code == 0
    assert "questions.yaml is used" not in err
    assert "put into words by their names in the PDDL; `tpvqa questions` lists them" in err
    assert err.count("note:") == 1


@pytest.mark.parametrize("option", ["--domain", "--problem", None])
def test_a_logic_program_is_domain_and_problem(
    tpvqa: Run, tmp_path: Path, option: str | None
) -> None:
    (tmp_path / "lamp.lp").write_text("action(press). causes(press, lit). goal(lit).\n")
    named = ("lamp.lp",) if option is None else (option, "lamp.lp")
    assert "press()" in tpvqa("plan", *named)[1]
    assert tpvqa("questions", *named)[0] == 0
    assert "lamp.lp" not in tpvqa("check", *named, "--json")[2]
    code, out, err = tpvqa("run", *named, *RUN, "--out", "episode")
    assert (code, "press" in out) == (0, True), err
    assert tpvqa("show", "episode")[0] == 0
    shown = tpvqa("config", *named)[1]
    assert len(re.findall(r"^  (?:domain|problem): .*/lamp.lp  # ", shown, re.MULTILINE)) == 2
    (tmp_path / "trial.yaml").write_text("task: {domain: lamp.lp}\n")
    code, _, err = tpvqa("run", "--config", "trial.yaml", *RUN, "--out", "again")
    assert code == 0, err
    with Trial(TrialConfig(task=TaskConfig(domain="lamp.lp"))) as trial:
        assert trial.task.name == "lamp"
    trials = ("--trials", 2, "--workers", 1)
    code, _, err = tpvqa("risk", *named, "--vlm", "oracle:0.9", "--monitor", "belief", *trials)
    assert code == 0, err


def test_a_logic_program_has_nothing_beside_it(tpvqa: Run, toys: Path) -> None:
    domain, program = toys / "domain.pddl", toys / "lamp.lp"
    program.write_text("action(press). causes(press, lit). goal(lit).\n")
    for words in ((domain, program), ("--domain", program, "--problem", domain)):
        code, _, err = tpvqa("plan", *words)
        assert code == 2
        assert "a logic program is domain and problem in one; name no" in err


@pytest.mark.parametrize("command", ["plan", "questions", "run"])
@pytest.mark.parametrize(
    ("words", "says"),
    [
        ((), "Name a shipped task, or give both --domain and --problem"),
        (("--domain", "d.pddl"), "Name a shipped task, or give both --domain and --problem"),
        (("d.pddl",), "name both, the domain first"),
        (("build_tower", "--domain", "d.pddl"), "not both"),
        (("d.pddl", "p.pddl", "--problem", "p.pddl"), "given twice"),
    ],
)
def test_what_names_no_task(tpvqa: Run, command: str, words: tuple[str, ...], says: str) -> None:
    code, out, err = tpvqa(command, *words)
    assert (code, out) == (2, "")
    assert says in err


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("run", "build_tower", "--failure", 2), "--failure must be at most 1, got 2"),
        (
            ("run", "build_tower", "--monitor", "belief:qestion=1", "--vlm", "oracle"),
            "there is no cost 'qestion'. Did you mean 'question'?",
        ),
        (
            ("run", "build_tower", "--monitor", "belief:foo=1", "--vlm", "oracle"),
            "failure_rate, disturbance_rate, spontaneous_rate, redone_rate, notices, "
            "false_alarms, risk, words=SHARE",
        ),
        (
            ("bench", "run", "build_tower", "--conditions", "failrue=1", "--vlm", "oracle"),
            "Did you mean 'failure'?",
        ),
    ],
)
def test_what_was_meant(tpvqa: Run, words: tuple[object, ...], says: str) -> None:
    code, _, err = tpvqa(*words)
    assert code == 2
    assert says in err
    assert "?/?" not in err
    assert "0/?" not in err


BAD = b"caf\xe9"


@pytest.mark.parametrize(
    "words",
    [
        (b"plan", BAD + b".pddl", b"p.pddl"),
        (b"questions", b"build_tower", b"--questions", BAD),
        (b"bench", b"run", b"build_tower", b"--out", BAD),
        (b"show", BAD),
    ],
)
def test_a_path_that_is_not_utf_8(tmp_path: Path, words: tuple[bytes, ...]) -> None:
    command = [sys.executable.encode(), b"-m", b"tpvqa", *words]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, check=False)
    assert done.returncode == 2
    assert rb"caf\xe9" in done.stderr
    assert b"is not UTF-8 text" in done.stderr
    assert b"Traceback" not in done.stderr


def test_where_paths_are_not_utf_8_or_too_long(
    tpvqa: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    code, _, err = tpvqa("bench", "run", "x" * 5000 + ".pddl")
    assert code == 2
    assert err.startswith("error: the path 'xxx")
    assert len(err) < 200
    folder = tmp_path / BAD.decode(errors="surrogateescape")
    folder.mkdir()
    monkeypatch.chdir(folder)
    code, _, err = tpvqa("run", "build_tower")
    assert code == 2
    assert "The folder that you are in, '" in err
    folder.rmdir()
    code, _, err = tpvqa("run", "build_tower")
    assert code == 2
    assert "is gone" in err


def test_a_terminal_without_the_letters(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tpvqa", "run", "build_tower", *map(str, RUN), "--out", "é"]
    environment = {"PYTHONIOENCODING": "ascii", "LANG": "C", "PATH": "/usr/bin"}
    done = subprocess.run(
        command, cwd=tmp_path, capture_output=True, env=environment, check=False, text=True
    )
    assert done.returncode == 0, done.stderr
    assert "\\xe9" in done.stdout
    started = json.loads((tmp_path / "é" / "episode.jsonl").read_text().splitlines()[0])
    assert started["kind"] == "started"
