"""Pictures unlike those that the embedded network was taught with, as a user meets them."""

import json
import shutil
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from benchmarks.unlike_pictures import KINDS, frame, made, questions
from tests.doubles import worded
from tpvqa.errors import AnswerError
from tpvqa.observation import Frame, Observation
from tpvqa.vlm import Reply
from tpvqa.vlm.pictures import observe_file
from tpvqa_household.embedded import EmbeddedVLM
from tpvqa_household.embedded.likeness import Divide, Likeness
from tpvqa_household.embedded.limits import UNLIKE, Asked, Limits, Odds, Seen
from tpvqa_household.embedded.weights import DESCRIPTION, FROZEN, LIMITS, SHIPPED, Weights
from tpvqa_household.images.manifest import load_pictures

KITCHEN = Path(__file__).with_name("embedded_reference") / "0.png"


@pytest.fixture(scope="module")
def vlm() -> EmbeddedVLM:
    return EmbeddedVLM()


def look(*frames: Frame) -> Observation:
    return Observation(0, 0.0, {f"{i}": each for i, each in enumerate(frames)})


@pytest.mark.parametrize("kind", KINDS)
def test_of_what_is_no_kitchen_nothing_is_said(vlm: EmbeddedVLM, kind: str) -> None:
    """Of eight pictures of a kind one may slip through: a drawing now and then does."""
    pictures = [frame(image) for image in made(kind, 8)]
    assert sum(not vlm.knows(each) for each in pictures) >= 7
    answers = [
        answer
        for each in pictures
        if not vlm.knows(each)
        for answer in vlm.ask(look(each), [*questions(), worded("Is the plate clean?")])
    ]
    assert {answer.reply for answer in answers} == {Reply.UNKNOWN}
    assert {answer.p_yes for answer in answers} == {None}
    assert {answer.text for answer in answers} == {UNLIKE}


def test_the_shipped_pictures_are_known(vlm: EmbeddedVLM) -> None:
    pictures = load_pictures()
    some = pictures.manifest.pictures[::4]
    assert all(vlm.knows(Frame(p.file, "front", pictures.read(p))) for p in some)


def test_a_kitchen_beside_an_unlike_picture_is_answered_as_if_alone(vlm: EmbeddedVLM) -> None:
    kitchen = observe_file(KITCHEN)
    (seen,) = kitchen.frames.values()
    alone = vlm.ask(kitchen, questions())
    both = vlm.ask(look(frame(made("noise", 1)[0]), seen), questions())
    assert [answer.reply for answer in both] == [answer.reply for answer in alone]
    for one, other in zip(both, alone, strict=True):
        assert one.p_yes == pytest.approx(other.p_yes, abs=1e-9)


def test_what_it_leans_to_is_told_for_measuring_alone(vlm: EmbeddedVLM) -> None:
    noise = frame(made("noise", 1)[0])
    asked = [worded("Is there a TV in the image?"), worded("Is there a unicorn in the image?")]
    leaning, nothing = vlm.leanings(noise, asked)
    assert leaning is not None
    assert 0 < leaning < 1
    assert nothing is None
    (seen,) = (kitchen := observe_file(KITCHEN)).frames.values()
    (answer,) = vlm.ask(kitchen, asked[:1])
    assert vlm.leanings(seen, asked[:1]) == [pytest.approx(answer.p_yes, abs=1e-6)]


def heads(*z: float, natural: bool = True) -> Odds:
    """Three heads: a fridge, a TV, and an open fridge."""
    one = np.ones(1, np.float32)
    nowhere = Likeness(one, one, one[:, None], one, rest=1.0, edge=1.0)
    limits = Limits(
        known=nowhere,
        photographic=Divide(one, 0.0),
        natural=nowhere,
        features=np.zeros((3, 1), np.float32),
        classes=np.zeros((3, 1), np.float32),
        bias=np.zeros(3, np.float32),
        needs=np.array([-1, -1, 0]),
        questions={
            "fridge": Asked(0, False),
            "tv": Asked(1, False),
            "open": Asked(2, False),
            "closed": Asked(2, True),
        },
        sure=2.0,
    )
    return Odds(limits, np.array(z), natural)


def test_a_head_answers_only_what_it_is_sure_of() -> None:
    odds = heads(3.0, -1.9, -4.0)
    assert odds.surely("fridge") == 3.0
    assert isinstance(odds.surely("tv"), str)
    assert odds.of("tv") == -1.9
    assert (odds.surely("open"), odds.surely("closed")) == (-4.0, 4.0)
    assert odds.surely("is plate clean") == UNLIKE
    assert odds.of("is plate clean") is None


def test_the_state_of_a_thing_is_told_only_where_the_thing_surely_is() -> None:
    assert isinstance(heads(1.9, 0.0, 9.0).surely("open"), str)
    assert isinstance(heads(-5.0, 0.0, 9.0).surely("closed"), str)


def test_of_what_is_no_photograph_the_heads_say_nothing() -> None:
    assert heads(9.0, 9.0, 9.0, natural=False).surely("fridge") == UNLIKE


def test_a_real_photograph_is_answered_by_the_frozen_branch(
    vlm: EmbeddedVLM, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No photograph ships: a picture is taken for unlike here, and what follows is real."""
    rng = np.random.default_rng(0)
    photograph = np.asarray(Image.open(KITCHEN).convert("RGB")).astype(int)
    pixels = np.clip(photograph + rng.integers(-2, 3, photograph.shape), 0, 255).astype(np.uint8)
    monkeypatch.setattr(Limits, "knows", lambda self, maps: False)
    limits = Limits.read(Weights.read())
    assert limits is not None
    fresh = EmbeddedVLM()
    answers = fresh.ask(look(frame(Image.fromarray(pixels))), questions())
    leanings = fresh.leanings(frame(Image.fromarray(pixels)), questions())
    for answer, leaning in zip(answers, leanings, strict=True):
        assert leaning is not None
        if answer.reply is Reply.UNKNOWN:
            assert UNLIKE in answer.text
        else:
            assert (answer.reply is Reply.YES) == (leaning > 0.5)
            assert answer.p_yes == pytest.approx(leaning, abs=1e-6)
            assert max(leaning, 1 - leaning) > 0.9 - 1e-6


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 5), st.integers(3, 8))
def test_the_distance_is_mahalanobis_where_all_directions_are_kept(
    seed: int, features: int, pictures: int
) -> None:
    from scipy.spatial.distance import mahalanobis

    from tpvqa_household.training.likeness_fit import fitted

    rng = np.random.default_rng(seed)
    mixed = rng.normal(size=(40, features)) @ rng.normal(size=(features, features))
    kind = (mixed + 0.1 * rng.normal(size=mixed.shape) + rng.normal(size=features)).astype(
        np.float32
    )
    likeness = fitted(kind, directions=features)
    others = (rng.normal(size=(pictures, features)) * 3).astype(np.float32)
    inverse = np.linalg.inv(np.atleast_2d(np.cov(kind.T)))
    expected = [mahalanobis(x, kind.mean(0), inverse) ** 2 for x in others]
    np.testing.assert_allclose(likeness.distance(others), expected, rtol=0.02, atol=1e-3)


def test_a_network_without_limits_answers_as_before(tmp_path: Path, vlm: EmbeddedVLM) -> None:
    bare = tmp_path / "bare"
    shutil.copytree(SHIPPED, bare)
    data = json.loads((bare / DESCRIPTION).read_text(encoding="utf-8"))
    for name in (FROZEN, LIMITS):
        (bare / name).unlink()
        del data["sha256"][name]
    del data["limits"]
    (bare / DESCRIPTION).write_text(json.dumps(data), encoding="utf-8")
    without, noise = EmbeddedVLM(folder=bare), look(frame(made("noise", 1)[0]))
    (answer,) = without.ask(noise, [worded("Is there a TV in the image?")])
    assert answer.p_yes is not None
    kitchen = observe_file(KITCHEN)
    told = [[a.p_yes for a in each.ask(kitchen, questions())] for each in (without, vlm)]
    assert told[0] == told[1]


def test_damaged_limits_are_told(tmp_path: Path) -> None:
    damaged = tmp_path / "damaged"
    shutil.copytree(SHIPPED, damaged)
    data = json.loads((damaged / DESCRIPTION).read_text(encoding="utf-8"))
    buffer = BytesIO()
    np.savez(buffer, known=np.zeros(3))
    (damaged / LIMITS).write_bytes(buffer.getvalue())
    del data["sha256"][LIMITS]
    (damaged / DESCRIPTION).write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(AnswerError, match="limits"):
        EmbeddedVLM(folder=damaged).ask(observe_file(KITCHEN), questions())


def test_the_branch_gives_what_the_heads_take(vlm: EmbeddedVLM) -> None:
    from tpvqa_household.embedded.sessions import Sessions

    limits = Limits.read(vlm.weights)
    assert limits is not None
    seen = Sessions(vlm.weights, threads=1).see(np.zeros((100, 50, 3), np.uint8))
    assert isinstance(seen, Seen)
    assert seen.features.shape == limits.features.shape[1:]
    assert seen.classes.shape == limits.classes.shape[1:]
    assert seen.texture.shape == limits.natural.mean.shape
