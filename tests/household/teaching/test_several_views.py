"""A look of several pictures, as the taught network answers it."""

import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.household.teaching.lamps import draw
from tpvqa.errors import AnswerError
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Atom
from tpvqa.questions import FactQuestion, Way
from tpvqa.vlm import Reply
from tpvqa_household.embedded.taught.vlm import TaughtVLM
from tpvqa_household.images.manifest import load_pictures

LEFT = FactQuestion("Is the left lamp lit?", Way.PRECONDITION, Atom("lit", ("left",)))


def frame(view: str, picture: Image.Image) -> Frame:
    file = io.BytesIO()
    picture.save(file, "PNG")
    return Frame(view, view, file.getvalue(), "image/png")


def look(*frames: Frame) -> Observation:
    return Observation(0, 0.0, {each.view: each for each in frames})


@pytest.fixture
def vlm(taught: Path) -> TaughtVLM:
    return TaughtVLM(taught)


def test_log_odds_are_averaged_over_the_pictures_that_are_known(vlm: TaughtVLM) -> None:
    rng = np.random.default_rng(8)
    lit = frame("a", draw(rng, left=True, right=False))
    dark = frame("b", draw(rng, left=False, right=True))
    pictures = load_pictures()
    kitchen = Image.open(pictures.folder / pictures.manifest.pictures[0].file)
    strange = frame("c", kitchen.convert("RGB"))
    p = [(vlm.leanings(each, [LEFT])[0] or 0.0) for each in (lit, dark)]
    assert p[0] > 0.5 > p[1]
    (both,) = vlm.ask(look(lit, dark), [LEFT])
    odds = np.mean([np.log(each / (1 - each)) for each in p])
    assert both.p_yes == pytest.approx(1 / (1 + np.exp(-odds)))
    (with_strange,) = vlm.ask(look(lit, strange), [LEFT])
    assert with_strange.p_yes == pytest.approx(p[0])
    assert with_strange.reply is Reply.YES
    assert [vlm.knows(each) for each in (lit, dark, strange)] == [True, True, False]
    (nothing,) = vlm.ask(look(), [LEFT])
    assert nothing.reply is Reply.UNKNOWN
    assert "no picture" in nothing.text


def test_a_damaged_picture_is_told(vlm: TaughtVLM) -> None:
    with pytest.raises(AnswerError, match="cannot be read"):
        vlm.ask(look(Frame("x", "x", b"\x89PNG torn", "image/png")), [LEFT])
