"""Trials in labelled pictures of a user's own domain, and what a VLM's answers about them teach."""

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Run
from tests.conftest import Install
from tests.lamps import DOMAIN, PICTURES, PROBLEM, QUESTIONS, edit, make_set, without
from tpvqa.episodes import read_episode

OWN = ("--domain", DOMAIN, "--problem", PROBLEM, "--questions", QUESTIONS)
EYE = '''
from tpvqa.vlm import Answer, Reply

class Eye:
    """Tells by the brightness of a half whether that lamp is lit, and is wrong of the close-up."""

    name = "eye"

    def ask(self, observation, questions):
        (frame,) = observation.frames.values()
        return [self.answer(frame, each) for each in questions]

    def answer(self, frame, question):
        half = frame.pixels[:, :4] if "left" in question.text else frame.pixels[:, 4:]
        lit = half.mean() > 100 and frame.source != "close.png"
        return Answer(question, Reply.YES if lit else Reply.NO)
'''


@pytest.fixture
def lamps(tmp_path: Path) -> Path:
    return make_set(tmp_path / "lamps")


@pytest.fixture
def eye(install: Install, lamps: Path) -> None:
    """A VLM that looks, and only at pictures that show both lamps."""
    install("eyes", EYE, "eye = eyes:Eye")
    edit(lamps, without("wall.png"))


@pytest.mark.usefixtures("eye")
@pytest.mark.parametrize("monitor", ["belief", "tpvqa"])
def test_a_trial(tpvqa: Run, lamps: Path, monitor: str) -> None:
    words = ("--world", f"pictures:{lamps}", "--vlm", "eye", "--monitor", monitor)
    code, out, err = tpvqa("run", *OWN, *words, "--seed", 6, "--out", "here")
    assert code == 0, err
    assert "goal reached" in out
    seen = [
        frame.source for e in read_episode("here") if e.kind == "observed" for frame in e.frames
    ]
    assert seen
    assert set(seen) <= set(PICTURES)
    assert tpvqa("report", "here")[0] == 0


def test_the_folder_can_be_an_option(tpvqa: Run, lamps: Path) -> None:
    words = ("--world", "pictures", "--pictures", "lamps", "--vlm", "oracle", "--json")
    assert tpvqa("run", *OWN, *words)[0] == 0
    edit(lamps, lambda manifest: manifest.update(domain="toys"))
    code, _, err = tpvqa("run", *OWN, *words)
    assert code == 2
    assert "of the domain 'toys'" in err


@pytest.mark.usefixtures("eye")
def test_calibrating(tpvqa: Run, lamps: Path) -> None:
    asked = ("calibrate", "--pictures", lamps, "--vlm", "eye", "--json", "--force")
    code, out, err = tpvqa(*asked, *OWN)
    assert code == 0, err
    found = json.loads(out)
    assert (found["vlm"], found["rows"]) == ("eye", 22)  # 11 facts, asked both ways
    assert found["lines"][-1]["accuracy"] == pytest.approx(20 / 22)
    code, _, err = tpvqa(*asked)
    assert code == 2
    assert "is asked about in a shipped task of 'lamps'" in err
    assert "--domain" in err
