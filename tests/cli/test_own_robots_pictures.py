"""What a robot of one's own gives as pictures: no VLM answers of what it was not shown."""

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Run
from tests.conftest import Install

PARTS = """
from io import BytesIO

import numpy as np
from PIL import Image

from tpvqa.observation import Frame, Observation
from tpvqa.vlm import Answer, Reply
from tpvqa.worlds import Execution, Report

def photo(kind):
    file = BytesIO()
    ramp = np.linspace(0, 255, 64 * 64 * 3).reshape(64, 64, 3)
    Image.fromarray(ramp.astype(np.uint8)).save(file, kind)
    return file.getvalue()

class Bot:
    frames = {}
    def views(self): return ["front"]
    def observe(self, view=None): return Observation(frames=self.frames)
    def execute(self, action, *, deadline=None, cancel=None): return Execution(Report.DONE, 1.0)
    def close(self): pass

class Without(Bot): pass
class Empty(Bot): frames = {"front": Frame("a", "front", b"", "image/png")}
class Behind(Bot): frames = {"back": Frame("a", "back", photo("PNG"), "image/png")}
class Turned(Bot): frames = {"front": Frame("a", "back", photo("PNG"), "image/png")}
class Called(Bot): frames = {"front": Frame("a", "front", photo("PNG"), "image/jpeg")}

class Nothing(Bot):
    def observe(self, view=None): return None

class Eye:
    name = "eye"
    def ask(self, observation, questions):
        for frame in observation.frames.values():
            print("shown", frame.media_type)
        return [Answer(each, Reply.YES, p_yes=0.9) for each in questions]
"""


@pytest.fixture
def ran(install: Install, tpvqa: Run, tmp_path: Path) -> Run:
    """Runs a few actions of a trial with a robot of these."""

    def run(robot: str, *more: str) -> tuple[int, str, str]:
        install("parts", PARTS, "eye = parts:Eye")
        install("bodies", PARTS, f"bot = bodies:{robot}", group="tpvqa.worlds")
        words = ("--world", "bot", "--vlm", "eye", "--max-actions", "3", *more)
        return tpvqa("run", "eat_apple", *words, "--out", str(tmp_path / "episode"))

    return run


def answers(episode: Path) -> list[tuple[str, str]]:
    events = map(json.loads, (episode / "episode.jsonl").read_text().splitlines())
    return [(each["reply"], each["text"]) for event in events for each in event.get("answers", ())]


@pytest.mark.parametrize("monitor", ["belief", "tpvqa"])
@pytest.mark.parametrize(
    ("robot", "said"),
    [
        ("Without", "the look holds no picture"),
        ("Empty", "the picture is empty: it has 0 bytes"),
    ],
)
def test_where_there_is_no_picture_nothing_is_answered(
    ran: Run, robot: str, said: str, monitor: str, tmp_path: Path
) -> None:
    code, out, err = ran(robot, "--monitor", monitor)
    assert code == 1, err
    assert said in out
    told = answers(tmp_path / "episode")
    assert told
    assert set(told) == {("cannot see", said)}


@pytest.mark.parametrize("robot", ["Behind", "Turned"])
def test_a_frame_of_a_view_that_is_not_listed_is_refused(ran: Run, robot: str) -> None:
    code, _, err = ran(robot)
    assert code == 2
    assert "bodies.Bot.observe returned" in err.replace(robot, "Bot")
    assert "the view 'back', which views() does not list: it lists front. List it there" in err
    assert "Mend it; the episode can be gone on with" in err


def test_a_png_is_one_whatever_it_is_called(ran: Run, tmp_path: Path) -> None:
    code, out, err = ran("Called", "--monitor", "tpvqa")
    assert code in (0, 1), err
    assert "shown image/png" in out
    assert "shown image/jpeg" not in out
    assert {each.suffix for each in (tmp_path / "episode/frames").iterdir()} == {".png"}


def test_none_in_place_of_a_look_is_named_with_what_to_do(ran: Run) -> None:
    code, _, err = ran("Nothing")
    assert code == 2
    assert (
        "observe has to return Observation, not None. Mend it; the episode can be gone on with"
        in err
    )
