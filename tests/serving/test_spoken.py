"""An answer as words with probabilities, and read again by tpvqa's own client."""

import json
import math
from dataclasses import replace
from random import Random

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from tests.doubles import worded
from tests.serving.running import body
from tpvqa.serving.spoken import Spoken, spoken
from tpvqa.serving.wire import Reply as WireReply
from tpvqa.serving.wire import read_request
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.chat_completions import read_completion
from tpvqa.vlm.reading import Reading

QUESTION = worded("Is the fridge open?")
SHARES = st.floats(0, 1)


def over_the_wire(answer: Answer, **more: object) -> Reading:
    asking = read_request(json.dumps(body(QUESTION.text, b"", **more)).encode())
    reply = WireReply(asking, len(QUESTION.text.split()), spoken(answer), Random(1))
    return read_completion(json.dumps(reply.body), QUESTION.text)


def read_with_logprobs(answer: Answer) -> Reading:
    return over_the_wire(answer, logprobs=True, top_logprobs=20)


@given(p_yes=SHARES, unseen=st.none() | st.floats(0, 0.5))
def test_yes_and_no_come_back_with_their_probability(p_yes: float, unseen: float | None) -> None:
    assume(abs(p_yes - 0.5) > 1e-9)
    reply = Reply.YES if p_yes > 0.5 else Reply.NO
    answer = Answer(QUESTION, reply, p_yes=p_yes, p_cannot_see=unseen)
    found = read_with_logprobs(answer)
    assert (found.reply, found.source) == (reply, "logprobs")
    assert found.p_yes == pytest.approx(p_yes, abs=1e-6)
    assert found.leftover == pytest.approx(min(unseen or 0.0, 0.49), abs=1e-6)
    bare = over_the_wire(answer)
    assert (bare.reply, bare.p_yes, bare.source) == (reply, None, "word")


@given(
    reply=st.sampled_from([Reply.UNKNOWN, Reply.CANNOT_SEE]),
    p_yes=st.none() | SHARES,
    unseen=st.none() | SHARES,
    text=st.text(max_size=40),
)
def test_an_abstention_is_never_read_as_yes_or_no(
    reply: Reply, p_yes: float | None, unseen: float | None, text: str
) -> None:
    answer = Answer(QUESTION, reply, p_yes=p_yes, p_cannot_see=unseen, text=text)
    for found in (read_with_logprobs(answer), over_the_wire(answer)):
        assert (found.reply, found.p_yes) == (Reply.UNKNOWN, None)
    odds = spoken(answer).odds
    assert odds is not None
    assert odds.get("yes", 0) + odds.get("no", 0) <= 0.5
    assert sum(odds.values()) == pytest.approx(1)


@given(p_yes=SHARES, unseen=SHARES)
def test_a_vlm_that_contradicts_itself_is_not_read_as_the_other_word(
    p_yes: float, unseen: float
) -> None:
    reply = Reply.NO if p_yes > 0.5 else Reply.YES
    found = read_with_logprobs(Answer(QUESTION, reply, p_yes=p_yes, p_cannot_see=unseen))
    assert found.reply in (Reply.UNKNOWN, reply)


@pytest.mark.parametrize("share", ["p_yes", "p_cannot_see", "leftover"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -0.1, 1.1])
def test_a_probability_that_is_none_says_nothing(share: str, value: float) -> None:
    answer = Answer(QUESTION, Reply.YES, p_yes=0.9)
    found = read_with_logprobs(replace(answer, **{share: value}))  # type: ignore[arg-type]
    assert (found.reply, found.p_yes) == (Reply.UNKNOWN, None)


def test_the_reason_of_an_abstention_reaches_the_log() -> None:
    found = read_with_logprobs(Answer(QUESTION, Reply.UNKNOWN, text="no word for weather"))
    assert found.text == "refused: no word for weather"


def test_a_vlm_without_probabilities_gives_none() -> None:
    said = spoken(Answer(QUESTION, Reply.YES))
    assert (said.word, said.logprobs("yes", 5)) == ("yes", None)
    assert said.sampled(1.0, Random(1)) == "yes"


def test_words_are_drawn_as_often_as_they_are_probable_at_temperature_1() -> None:
    said = Spoken("yes", {"yes": 0.6, "no": 0.3, "cannot see": 0.1})
    random = Random(5)
    drawn = [said.sampled(1.0, random) for _ in range(4000)]
    for word, p in (said.odds or {}).items():
        spread = 4 * math.sqrt(p * (1 - p) / len(drawn))
        assert drawn.count(word) / len(drawn) == pytest.approx(p, abs=spread)
    for none in (0.0, 1e-320, 1e-300, 1e-9):
        assert {said.sampled(none, random) for _ in range(20)} == {"yes"}
    cold = [said.sampled(0.2, random) for _ in range(400)]
    assert cold.count("yes") > 360
