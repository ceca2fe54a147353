"""Planners and VLMs of strangers that break, or give what nobody can use, as a user meets them."""

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Run
from tests.conftest import Install

PLANNERS = """
class Planner:
    name = "odd"
    def close(self): pass

class Breaks(Planner):
    def plan(self, *_, **__): raise RuntimeError("planner gone")

class Gives(Planner):
    def plan(self, *_, **__): return ["take bag"]
"""
VLMS = """
from tpvqa.vlm import Answer, Reply

class VLM:
    name = "odd"
    def __init__(self, **of_answers): self.of_answers = of_answers
    def ask(self, observation, questions):
        return [Answer(each, Reply.YES, **self.of_answers) for each in questions]

def words(): return VLM(p_yes="0.9")
def truth(): return VLM(p_yes=True)
def long(): return VLM(text="y" * 17_000_000)
"""
TASK = "eat_apple"


@pytest.mark.parametrize("command", ["plan", "questions"])
@pytest.mark.parametrize(
    ("planner", "said"),
    [("Breaks", "broke: RuntimeError: planner gone"), ("Gives", "has to return a Plan")],
)
def test_a_planner_that_breaks_is_named(
    install: Install, tpvqa: Run, command: str, planner: str, said: str
) -> None:
    install("planners", PLANNERS, f"odd = planners:{planner}", group="tpvqa.planners")
    code, _, err = tpvqa(command, TASK, "--planner", "odd")
    assert code == 2
    assert said in err
    assert "Traceback" not in err


@pytest.mark.parametrize("monitor", ["belief", "tpvqa"])
@pytest.mark.parametrize("vlm", ["words", "truth"])
def test_a_probability_that_is_no_number_is_refused(
    install: Install, tpvqa: Run, monitor: str, vlm: str, tmp_path: Path
) -> None:
    install("vlms", VLMS, f"odd = vlms:{vlm}")
    out = str(tmp_path / "episode")
    code, _, err = tpvqa("run", TASK, "--vlm", "odd", "--monitor", monitor, "--out", out)
    assert code == 2
    assert "has to give p_yes as a number" in err
    assert "Traceback" not in err


def test_words_without_end_are_cut_and_the_log_can_be_read(
    install: Install, tpvqa: Run, tmp_path: Path
) -> None:
    install("vlms", VLMS, "odd = vlms:long")
    out = tmp_path / "episode"
    code, _, err = tpvqa("run", TASK, "--vlm", "odd", "--max-actions", "2", "--out", str(out))
    assert code in (0, 1), err
    assert (out / "episode.jsonl").stat().st_size < 2**20
    texts = [
        answer["text"]
        for line in (out / "episode.jsonl").read_text().splitlines()
        for answer in json.loads(line).get("answers", ())
    ]
    assert texts
    assert all(text.endswith("… (17,000,000 characters)") for text in texts)
    assert tpvqa("show", str(out))[0] == 0


@pytest.mark.parametrize(
    "words",
    [
        ("plan", "loop", "problem.pddl"),
        ("check", "domain.pddl", "loop"),
        ("run", TASK, "--questions", "loop"),
        ("run", TASK, "--vlm", "oracle:0.9", "--calibration", "loop"),
        ("run", TASK, "--vlm", "oracle:0.9", "--experience", "loop"),
        ("resume", "loop"),
        ("show", "loop"),
    ],
)
def test_links_in_a_circle_are_named(
    tpvqa: Run, words: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("loop").symlink_to("loop")
    Path("domain.pddl").write_text("(define (domain d) (:predicates (p)))")
    code, _, err = tpvqa(*words)
    assert code == 2
    assert "cannot be read (it is a link" in err
    assert "Traceback" not in err


@pytest.mark.parametrize("option", ["--seed", "--episode"])
def test_a_number_that_no_log_can_keep_is_refused_before_anything_moves(
    tpvqa: Run, option: str, tmp_path: Path
) -> None:
    out = tmp_path / "episode"
    code, _, err = tpvqa("run", TASK, "--vlm", "oracle:1", option, "9" * 23, "--out", str(out))
    assert code == 2
    assert f"{option} must be at most" in err
    assert not out.exists()
