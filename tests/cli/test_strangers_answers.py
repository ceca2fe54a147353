"""What a VLM of a stranger gives to those who ask it without a trial, as a user meets it."""

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Run
from tests.conftest import Install

SORTING = Path(__file__).parents[2] / "examples" / "projects" / "sorting"
SET = [
    *("--pictures", SORTING / "pictures", "--domain", SORTING / "domain.pddl"),
    *("--problem", SORTING / "problem.pddl", "--questions", SORTING / "questions.yaml"),
]
PICTURE = next((SORTING / "pictures").rglob("*.jpg"))
VLMS = """
import math
import numpy
from tpvqa.questions import FactQuestion, Way
from tpvqa.pddl import Atom
from tpvqa.vlm import Answer, Reply

QUESTION = FactQuestion("Is it?", Way.EFFECT, Atom("a"))

def raises(error):
    raise error

def yes(questions, **more):
    return [Answer(each, Reply.YES, **more) for each in questions]

class VLM:
    name = "odd"
    def __init__(self, give): self.give = give
    def ask(self, observation, questions): return self.give(questions)

def few(): return VLM(lambda asked: yes(asked)[:-1])
def other(): return VLM(lambda asked: yes([QUESTION] * len(asked)))
def nan(): return VLM(lambda asked: yes(asked, p_yes=math.nan))
def big(): return VLM(lambda asked: yes(asked, p_yes=2))
def late(): return VLM(lambda asked: yes(asked, seconds=math.inf))
def words(): return VLM(lambda asked: yes(asked, text=5))
def source(): return VLM(lambda asked: yes(asked, source=object()))
def texts(): return VLM(lambda asked: ["yes"] * len(asked))
def none(): return VLM(lambda asked: None)
def reply(): return VLM(lambda asked: [Answer(each, "yes") for each in asked])
def text(): return VLM(lambda asked: [Answer(each.text, Reply.YES) for each in asked])
def breaks(): return VLM(lambda asked: raises(ValueError("out of order")))
def leaves(): return VLM(lambda asked: raises(SystemExit(0)))
def closes(): return VLM(lambda asked: raises(GeneratorExit()))
def plain(): return VLM(lambda asked: yes(asked, p_yes=numpy.float32(.9)))
def turned(): return VLM(lambda asked: yes(asked)[::-1])
"""
SAID = {
    "few": "Answers to",
    "other": "each question in its place",
    "nan": "p_yes as a number between 0 and 1, not nan",
    "big": "p_yes as a number between 0 and 1, not 2",
    "late": "seconds as a number of 0 or more, not inf",
    "words": "text as a text, not 5",
    "source": "source as a text",
    "texts": "(str)",
    "none": "has to return list, not None",
    "reply": "has to give a Reply, and gave 'yes'",
    "text": "each question in its place",
    "breaks": "broke: ValueError: out of order",
    "leaves": "broke: SystemExit: 0",
    "closes": "broke: GeneratorExit (",
}


@pytest.mark.parametrize("command", ["ask", "calibrate", "compare", "serve-vlm", "run"])
@pytest.mark.parametrize("fault", SAID)
def test_what_is_no_answer_is_refused_whoever_asks(
    install: Install, tpvqa: Run, command: str, fault: str, tmp_path: Path
) -> None:
    install("vlms", VLMS, f"odd = vlms:{fault}")
    out = tmp_path / "out"
    words = {
        "ask": ["ask", PICTURE, "Is it red?", "--vlm", "odd", "--json"],
        "calibrate": ["calibrate", *SET, "--vlm", "odd", "--out", out],
        "compare": ["vlm", "compare", "odd", "oracle:0.9", *SET, "--out", out],
        "serve-vlm": ["serve-vlm", "--vlm", "odd", "--port", 0],
        "run": ["run", "eat_apple", "--vlm", "odd", "--out", out],
    }[command]
    code, stdout, err = tpvqa(*words)
    assert code == 2
    assert SAID[fault] in err
    assert "Traceback" not in err
    if command != "run":
        assert stdout == ""
        assert not out.exists()


@pytest.mark.parametrize("command", ["ask", "calibrate"])
def test_answers_in_another_order_are_not_taken_for_those_asked_for(
    install: Install, tpvqa: Run, command: str
) -> None:
    install("vlms", VLMS, "odd = vlms:turned")
    words = {
        "ask": ["ask", PICTURE, "Is it red?", "Is it blue?", "--vlm", "odd"],
        "calibrate": ["calibrate", *SET, "--vlm", "odd", "--out", "calibration.json"],
    }[command]
    code, _, err = tpvqa(*words)
    assert code == 2
    assert "has to answer each question in its place" in err
    assert not Path("calibration.json").exists()


def test_a_number_of_numpy_is_a_number(install: Install, tpvqa: Run) -> None:
    install("vlms", VLMS, "odd = vlms:plain")
    code, out, _ = tpvqa("ask", PICTURE, "Is it red?", "--vlm", "odd", "--json")
    assert code == 0
    assert json.loads(out)["answers"][0]["p_yes"] == pytest.approx(0.9)
