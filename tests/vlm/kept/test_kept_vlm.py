"""Recorded answers as whoever asks meets them."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.doubles import worded
from tests.vlm.kept.coin import FRIDGE, PLATE, Coin, keeping, picture, said, seen
from tpvqa.errors import CacheError, PluginError
from tpvqa.observation import Depth, Frame, Observation, SensedFact
from tpvqa.pddl import Atom
from tpvqa.questions import Question
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.capabilities import NeedsPictures, is_noise_model, needs_pictures
from tpvqa.vlm.kept import KeptVLM, Use, kept
from tpvqa.vlm.kept.fingerprint import picture_of


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "answers.db"


class Silent(Coin):
    """Has no answer, the first time."""

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        first, answers = not self.asked, super().ask(observation, questions)
        if not first:
            return answers
        return [Answer(each.question, Reply.UNKNOWN, text="late") for each in answers]


def test_what_is_there_is_given_and_the_rest_asked(path: Path) -> None:
    coin = Coin()
    first = keeping(path, Use.CACHE, coin, trial=b"one").ask(seen(1), [FRIDGE])
    again = keeping(path, Use.CACHE, coin, trial=b"two").ask(seen(1), [PLATE, FRIDGE])
    assert coin.asked == [FRIDGE.text, PLATE.text]
    assert said(again)[1:] == said(first)
    assert again[1].seconds == 0.25
    keeping(path, Use.CACHE, coin).ask(seen(2), [FRIDGE])
    assert len(coin.asked) == 3  # another picture


def test_recording_asks_anew_and_replays_what_was_told_last(path: Path) -> None:
    coin = Coin()
    keeping(path, Use.RECORD, coin).ask(seen(1), [FRIDGE])
    last = keeping(path, Use.RECORD, coin).ask(seen(1), [FRIDGE])
    assert len(coin.asked) == 2
    assert said(keeping(path, Use.REPLAY, None).ask(seen(1), [FRIDGE])) == said(last)


def test_replaying_refuses_what_was_not_seen(path: Path) -> None:
    keeping(path, Use.RECORD, Coin()).ask(seen(1), [FRIDGE])
    replayed = keeping(path, Use.REPLAY, None)
    with pytest.raises(CacheError, match=r"no recorded answer to 'Is there a plate\?'.*look 0"):
        replayed.ask(seen(1), [FRIDGE, PLATE])
    with pytest.raises(CacheError, match="look 5"):
        replayed.ask(seen(2, 5), [FRIDGE])
    with pytest.raises(CacheError, match="seen 2 times"):
        replayed.ask(seen(1, 6), [FRIDGE])


def test_one_look_has_one_answer_whatever_the_vlm_says_next(path: Path) -> None:
    for use in (Use.CACHE, Use.RECORD):
        vlm = keeping(path, use, Coin())
        once = vlm.ask(seen(1), [FRIDGE])
        assert said(vlm.ask(seen(1), [FRIDGE, PLATE, FRIDGE]))[0::2] == said(once) * 2


def test_trials_that_were_told_otherwise_are_each_told_the_same_again(path: Path) -> None:
    coin, told = Coin(), {}
    for trial in (b"one", b"two", b"three"):
        vlm = keeping(path, Use.RECORD, coin, trial)
        told[trial] = [said(vlm.ask(seen(1, look), [FRIDGE])) for look in range(4)]
    for trial in reversed(told):
        vlm = keeping(path, Use.REPLAY, None, trial)
        assert [said(vlm.ask(seen(1, look), [FRIDGE])) for look in range(4)] == told[trial]
    stranger = keeping(path, Use.REPLAY, None, b"four")  # the draws in the order of recording
    assert [said(stranger.ask(seen(1, look), [FRIDGE])) for look in range(4)] == told[b"one"]


def test_the_same_picture_again_is_another_draw(path: Path) -> None:
    coin = Coin()
    vlm = keeping(path, Use.CACHE, coin)
    draws = [said(vlm.ask(seen(1, look), [FRIDGE])) for look in range(3)]
    assert len(coin.asked) == 3
    other = keeping(path, Use.CACHE, coin, b"another")
    assert [said(other.ask(seen(1, look), [FRIDGE])) for look in range(3)] == draws
    assert len(coin.asked) == 3


def test_askings_without_a_trial_add_draws(path: Path) -> None:
    coin = Coin()
    told = [said(keeping(path, Use.RECORD, coin, None).ask(seen(1), [PLATE])) for _ in range(3)]
    vlm = keeping(path, Use.REPLAY, None, None)
    assert [said(vlm.ask(seen(1, look), [PLATE])) for look in range(3)] == told


def test_an_unknown_is_asked_again_but_replayed(path: Path) -> None:
    silent = Silent()
    assert keeping(path, Use.CACHE, silent).ask(seen(1), [FRIDGE])[0].reply is Reply.UNKNOWN
    replayed = keeping(path, Use.REPLAY, None).ask(seen(1), [FRIDGE])[0]
    assert (replayed.reply, replayed.text) == (Reply.UNKNOWN, "late")
    answered = keeping(path, Use.CACHE, silent).ask(seen(1), [FRIDGE])
    assert answered[0].reply in (Reply.YES, Reply.NO)
    for trial in (b"trial", b"another"):
        assert said(keeping(path, Use.REPLAY, None, trial).ask(seen(1), [FRIDGE])) == said(answered)


Steps = list[tuple[int, list[int]]]
QUESTIONS = [worded(f"Is it {number}?") for number in range(4)]


@settings(max_examples=25)
@given(
    st.lists(
        st.tuples(st.integers(0, 2), st.lists(st.integers(0, 3), min_size=1, max_size=4)),
        max_size=8,
    ),
    st.sampled_from([Use.CACHE, Use.RECORD]),
    st.integers(0, 8),
)
def test_whatever_was_asked_is_answered_the_same_again_also_when_gone_on_with(
    steps: Steps, use: Use, cut: int
) -> None:
    """A replay from the start, and one that was put back in the middle, are told what was told."""

    def ask(vlm: KeptVLM, at: range) -> Iterator[object]:
        for look in at:
            number, asked = steps[look]
            yield said(vlm.ask(seen(number, look), [QUESTIONS[each] for each in asked]))

    with TemporaryDirectory() as folder:
        path = Path(folder) / "answers.db"
        recording = keeping(path, use, Coin())
        cut = min(cut, len(steps))
        told = list(ask(recording, range(cut)))
        where = recording.snapshot()  # type: ignore[attr-defined]
        told += ask(recording, range(cut, len(steps)))
        assert list(ask(keeping(path, Use.REPLAY, None), range(len(steps)))) == told
        resumed = keeping(path, Use.REPLAY, None)
        resumed.restore(where)  # type: ignore[attr-defined]
        assert list(ask(resumed, range(cut, len(steps)))) == told[cut:]


class Looking(Coin, NeedsPictures):
    """A VLM that looks, and has parameters."""

    prompt = "short"

    @property
    def parameters(self) -> dict[str, str]:
        return {"prompt": self.prompt}

    def check(self) -> None:
        self.asked.append("check")


def test_it_is_whatever_the_vlm_is(path: Path) -> None:
    looking = Looking()
    vlm = kept("coin", path, Use.CACHE, inner=looking)
    assert needs_pictures(vlm)
    assert not is_noise_model(vlm)
    assert vlm.name == "coin"
    vlm.check()
    assert looking.asked == ["check"]


def test_other_parameters_are_another_vlm(path: Path) -> None:
    looking = Looking()
    kept("coin", path, Use.CACHE, inner=looking).ask(seen(1), [FRIDGE])
    looking.prompt = "long"
    kept("coin", path, Use.CACHE, inner=looking).ask(seen(1), [FRIDGE])
    assert looking.asked == [FRIDGE.text] * 2
    with pytest.raises(CacheError, match=r"different parameters.*prompt short.*prompt long"):
        kept("coin", path, Use.REPLAY, inner=looking)
    with pytest.raises(CacheError, match=r"no recorded answers of 'dice'.*but of: coin"):
        kept("dice", path, Use.REPLAY, inner=looking)


def test_a_vlm_that_breaks_its_word_is_named(path: Path) -> None:
    class Mute(Coin):
        def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
            return []

    with pytest.raises(PluginError, match="coin has to give 1 Answers"):
        keeping(path, Use.CACHE, Mute()).ask(seen(1), [FRIDGE])
    assert not keeping(path, Use.CACHE, Coin()).file.models("other")


def test_what_has_no_picture_is_not_kept(path: Path) -> None:
    with pytest.raises(CacheError, match="has none"):
        keeping(path, Use.CACHE, Coin()).ask(Observation(), [FRIDGE])


def test_a_picture_is_what_is_seen_and_not_when() -> None:
    frame = Frame("a", "front", picture(1))
    one = Observation(0, 1.0, {"front": frame})
    later = replace(frame, id="b", source="camera", stamp=3.0)
    facts = (SensedFact(Atom("felt")),)
    assert picture_of(one) == picture_of(Observation(4, 9.0, {"front": later}, {"x": 1}, facts))
    others = [
        {"left": replace(frame, view="left")},
        {"front": replace(frame, data=picture(2))},
        {"front": replace(frame, media_type="image/png")},
        {"front": replace(frame, depth=Depth(b"near"))},
        {"front": frame, "left": replace(frame, view="left")},
    ]
    found = {picture_of(Observation(frames=frames)) for frames in others}
    assert len(found) == len(others)
    assert picture_of(one) not in found
