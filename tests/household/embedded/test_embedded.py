"""The embedded network as a user meets it, with the weights that ship."""

import json
import os
import shutil
import statistics
import subprocess
import sys
import time
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.doubles import worded
from tpvqa.errors import AnswerError
from tpvqa.observation import Frame, Observation
from tpvqa.plugins import Kind, make
from tpvqa.questions import Question
from tpvqa.vlm import VLM, Reply
from tpvqa.vlm.pictures import observe_file
from tpvqa_household.embedded import EmbeddedVLM
from tpvqa_household.embedded.vlm import combine
from tpvqa_household.embedded.weights import DESCRIPTION, HEAD, SHIPPED

REFERENCE = Path(__file__).with_name("embedded_reference")


def picture(pixels: np.ndarray, name: str = "picture") -> Frame:
    buffer = BytesIO()
    Image.fromarray(pixels).save(buffer, "PNG")
    return Frame(name, "front", buffer.getvalue(), "image/png")


def look(*frames: Frame) -> Observation:
    return Observation(0, 0.0, {f"{i}": frame for i, frame in enumerate(frames)})


@pytest.fixture(scope="module")
def vlm() -> EmbeddedVLM:
    return EmbeddedVLM()


@pytest.fixture(scope="module")
def cases() -> tuple[list[Question], list[tuple[Observation, np.ndarray]]]:
    data = json.loads((REFERENCE / "reference.json").read_text(encoding="utf-8"))
    questions: list[Question] = [worded(text) for text in data["questions"]]
    pictures = [
        (observe_file(REFERENCE / case["picture"]), np.array(case["chances"]))
        for case in data["cases"]
    ]
    return questions, pictures


def test_answers_are_those_of_the_training_framework(
    vlm: EmbeddedVLM, cases: tuple[list[Question], list[tuple[Observation, np.ndarray]]]
) -> None:
    questions, pictures = cases
    for observation, expected in pictures:
        answers = vlm.ask(observation, questions)
        unseen = np.array([answer.p_cannot_see for answer in answers], float)
        p_yes = np.array([answer.p_yes for answer in answers], float)
        np.testing.assert_allclose(unseen, expected[:, 2], atol=1e-3)
        np.testing.assert_allclose(p_yes * (1 - unseen), expected[:, 0], atol=1e-3)


def test_it_sees(
    vlm: EmbeddedVLM, cases: tuple[list[Question], list[tuple[Observation, np.ndarray]]]
) -> None:
    """Most answers to a kitchen are sure."""
    questions, pictures = cases
    sure = [
        max(answer.p_cannot_see or 0, abs((answer.p_yes or 0.5) - 0.5) * 2)
        for observation, _ in pictures
        for answer in vlm.ask(observation, questions)
    ]
    assert statistics.median(sure) > 0.8


def test_it_is_a_vlm_and_can_be_asked_for_by_name() -> None:
    made = make(Kind.VLM, "embedded")
    assert isinstance(made, VLM)
    assert made.name == "embedded"


def test_answers_keep_the_order_of_the_questions(
    vlm: EmbeddedVLM, cases: tuple[list[Question], list[tuple[Observation, np.ndarray]]]
) -> None:
    questions, ((observation, _), *_) = cases
    forwards = vlm.ask(observation, questions)
    backwards = vlm.ask(observation, questions[::-1])[::-1]
    assert [a.question for a in forwards] == questions
    for one, two in zip(forwards, backwards, strict=True):
        assert one.reply == two.reply
        assert one.p_yes == pytest.approx(two.p_yes, abs=1e-6)


def test_a_question_without_words_is_unknown_and_not_guessed(vlm: EmbeddedVLM) -> None:
    kitchen = observe_file(REFERENCE / "0.png")
    asked = [
        worded("Is there a milk carton in the image?"),
        worded("Is the plate clean?"),
        worded("Is the fridge clean?"),
    ]
    answers = vlm.ask(kitchen, asked)
    assert [answer.reply is Reply.UNKNOWN for answer in answers] == [True, False, True]
    assert answers[0].p_yes is None
    assert "milk" in answers[0].text


def test_no_picture_is_unknown_and_no_question_is_no_answer(vlm: EmbeddedVLM) -> None:
    (answer,) = vlm.ask(Observation(0, 0.0), [worded("Is the plate clean?")])
    assert answer.reply is Reply.UNKNOWN
    assert vlm.ask(look(picture(np.zeros((8, 8, 3), np.uint8))), []) == []


@pytest.mark.parametrize("shape", [(1, 1, 3), (480, 640, 3), (900, 30, 3)])
def test_pictures_of_any_shape_are_taken(vlm: EmbeddedVLM, shape: tuple[int, int, int]) -> None:
    pixels = np.random.default_rng(0).integers(0, 256, shape, dtype=np.uint8)
    (answer,) = vlm.ask(look(picture(pixels)), [worded("Is the TV turned on?")])
    assert answer.reply in Reply


def test_a_frame_that_shows_it_outweighs_one_that_does_not() -> None:
    seen, unseen = [4.0, -4.0, -2.0], [-1.0, 1.0, 6.0]
    p_yes, p_unseen = combine(np.array([[seen], [unseen]], np.float32))
    assert p_yes[0] > 0.95
    assert p_unseen[0] < 0.05
    alone, _ = combine(np.array([[seen]], np.float32))
    chances = np.exp(seen) / np.exp(seen).sum()
    assert alone[0] == pytest.approx(chances[0] / (chances[0] + chances[1]))


def test_a_broken_picture_is_a_clear_error(vlm: EmbeddedVLM) -> None:
    broken = Frame("broken", "front", b"no picture", "image/png")
    with pytest.raises(AnswerError, match="broken"):
        vlm.ask(look(broken), [worded("Is the plate clean?")])


def test_missing_and_damaged_weights_are_clear_errors(tmp_path: Path) -> None:
    question = [worded("Is the plate clean?")]
    grey = look(picture(np.full((64, 64, 3), 128, np.uint8)))
    with pytest.raises(AnswerError, match=r"missing.*Install tpvqa-household again"):
        EmbeddedVLM(folder=tmp_path / "none").ask(grey, question)
    damaged = tmp_path / "damaged"
    shutil.copytree(SHIPPED, damaged)
    (damaged / HEAD).write_bytes((damaged / HEAD).read_bytes()[:-1])
    with pytest.raises(AnswerError, match="hash"):
        EmbeddedVLM(folder=damaged).ask(grey, question)
    (damaged / DESCRIPTION).write_text("[]", encoding="utf-8")
    with pytest.raises(AnswerError, match="does not describe"):
        EmbeddedVLM(folder=damaged).ask(grey, question)


def test_the_weights_are_small() -> None:
    assert sum(file.stat().st_size for file in SHIPPED.iterdir()) < 25_000_000


@pytest.mark.slow
def test_a_picture_with_all_questions_of_a_step_is_quick(vlm: EmbeddedVLM) -> None:
    """15 ms on two free cores; ten times that here, as tests share their machine."""
    rng = np.random.default_rng(0)
    asked = [
        worded(text)
        for text in ("Is the plate clean?", "Is the fridge open?", "Is the TV turned on?")
    ]
    seconds = []
    for _ in range(20):
        seen = look(picture(rng.integers(0, 256, (224, 224, 3), dtype=np.uint8)))
        began = time.perf_counter()
        vlm.ask(seen, asked)
        seconds.append(time.perf_counter() - began)
    assert min(seconds) < 0.15


def test_nothing_is_kept_or_sent_about_the_user(tmp_path: Path) -> None:
    """Left alone, onnxruntime 1.32 numbers the device in the user's folder, and sends reports."""
    here = {"HOME": str(tmp_path), "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    words = ["ask", str(REFERENCE / "0.png"), "Is the fridge open?"]
    done = subprocess.run([sys.executable, "-m", "tpvqa", *words], env=here, check=False)
    assert done.returncode == 0
    assert not list(tmp_path.rglob("*onnx*"))
