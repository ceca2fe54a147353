"""Reading token probabilities."""

import json
import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.vlm import Reply
from tpvqa.vlm.chat_completions import Dialect, read_completion
from tpvqa.vlm.yes_no import Token, answer_token, mass

LOGARITHMS = st.floats(allow_nan=True, allow_infinity=True)
WAYS_TO_WRITE = [
    "yes",
    "Yes",
    "YES",
    " yes",
    " Yes",
    "ĠYes",
    "▁yes",
    "Yes.",
    '"Yes',
    "**Yes",
    "\nYes",
]


@pytest.mark.parametrize("token", WAYS_TO_WRITE)
def test_every_way_of_writing_yes_counts(token: str) -> None:
    found = mass([(token, math.log(0.7)), ("No", math.log(0.1)), ("Yesterday", math.log(0.2))])
    assert found is not None
    assert found.yes == pytest.approx(0.7)
    assert found.leftover == pytest.approx(0.2)
    assert found.p_yes == pytest.approx(0.7 / 0.8)


@given(
    st.dictionaries(
        st.sampled_from([*WAYS_TO_WRITE, "no", "No", " NO", "maybe", "", "▁"]) | st.text(),
        LOGARITHMS,
    )
)
def test_p_yes_and_leftover_are_probabilities_whatever_the_server_sends(
    top: dict[str, float],
) -> None:
    found = mass(top.items())
    if found is None:  # some of the logarithms are of no probability
        return
    assert 0 <= found.leftover <= 1
    assert 0 <= found.yes + found.no <= 1 + 1e-9
    assert found.p_yes is None or 0 <= found.p_yes <= 1


@given(
    st.floats(0, 1),
    st.floats(0, 1),
    st.lists(st.sampled_from(WAYS_TO_WRITE), unique=True, min_size=1),
)
def test_how_yes_is_spread_over_its_ways_of_writing_does_not_matter(
    yes: float, p: float, ways: list[str]
) -> None:
    no = (1 - yes) * p
    if yes / len(ways) <= 1e-300 or no <= 1e-300:
        return
    spread = [(way, math.log(yes / len(ways))) for way in ways]
    found = mass([*spread, ("no", math.log(no))])
    assert found is not None
    assert found.p_yes == pytest.approx(yes / (yes + no), abs=1e-9)
    assert found.leftover == pytest.approx(1 - yes - no, abs=1e-9)


@given(
    st.lists(
        st.tuples(st.sampled_from([*WAYS_TO_WRITE, "No", "maybe"]), st.floats(-20, 0)),
        unique_by=lambda t: t[0],
    )
)
def test_exchanging_yes_and_no_exchanges_the_probabilities(top: list[tuple[str, float]]) -> None:
    swap = {"yes": "no", "no": "yes"}

    def exchanged(text: str) -> str:
        return re.sub("yes|no", lambda word: swap[word[0].lower()], text, flags=re.IGNORECASE)

    there, back = mass(top), mass([(exchanged(text), p) for text, p in top])
    assert there is not None
    assert back is not None
    assert there.yes == pytest.approx(back.no)
    assert there.no == pytest.approx(back.yes)


def tokens(*texts: str) -> list[Token]:
    return [Token(text, {text: -0.1}) for text in texts]


@pytest.mark.parametrize(
    ("texts", "at"),
    [
        (["Yes"], 0),
        (["**", "Yes", "**"], 1),
        (["Answer", ":", " no"], 2),
        (["<think>", "yes", " yes", "</think>", "\n\n", "No"], 5),
        (["<", "think", ">", "yes"], None),
        (["Y", "es"], None),
        ([], None),
    ],
)  # fmt: skip
def test_the_answer_token_is_the_first_yes_or_no_after_any_reasoning(
    texts: list[str], at: int | None
) -> None:
    found = answer_token(tokens(*texts))
    assert found == (None if at is None else tokens(*texts)[at])


def reply_of(content: str, *texts: str, **more: object) -> Reply:
    told = [{"token": text, "logprob": -0.1, "top_logprobs": []} for text in texts]
    message = {"role": "assistant", "content": content, **more}
    body = {"choices": [{"message": message, "logprobs": {"content": told}}]}
    return read_completion(json.dumps(body)).reply


@pytest.mark.parametrize(
    ("content", "texts"),
    [
        ("No", ["unknown"]),
        ("No", ["I do", " not know"]),
        ("No", ["I can", "not"]),
        ("Yes", ["Eyes closed"]),
        ("Yes", ["Y", "es", "terday"]),
    ],
)
def test_tokens_that_hold_the_word_only_inside_another_say_otherwise(
    content: str, texts: list[str]
) -> None:
    assert reply_of(content, *texts) is Reply.UNKNOWN


@pytest.mark.parametrize(
    ("content", "texts"),
    [
        ("No", ["N", "o"]),
        ("Yes", ["Y", "es"]),
        ("Yes", ["Y", "es", "<|im_end|>"]),
        ("yes", ["ĠY", "ES", "."]),
        ("Yes", ["▁Y", "es"]),
        ("Yes", ["<", "think", ">", "unknown", "</", "think", ">", "Y", "es"]),
        ("No", ["_N", "o_"]),
        ("No", ["N"]),
        ("**Yes**", ["**", "Y", "es", "**"]),
    ],
)
def test_tokens_that_spell_the_word_in_parts_agree(content: str, texts: list[str]) -> None:
    assert reply_of(content, *texts).value == content.strip("*").lower()


@pytest.mark.parametrize("called", [{"tool_calls": [{"id": 1}]}, {"function_call": {"name": "x"}}])
def test_a_word_beside_the_call_of_a_tool_is_no_answer(called: dict[str, object]) -> None:
    assert reply_of("Yes") is Reply.YES
    assert reply_of("Yes", **called) is Reply.UNKNOWN


@given(st.binary() | st.text())
def test_any_body_is_read_without_an_error(body: bytes | str) -> None:
    assert read_completion(body).reply is Reply.UNKNOWN


JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.text(max_size=5) | st.sampled_from(["yes", "No"]),
    lambda inner: st.lists(inner, max_size=3)
    | st.dictionaries(st.sampled_from(["choices", "message", "content", "logprobs", "token",
                                       "logprob", "top_logprobs"]), inner, max_size=4),
    max_leaves=12,
)  # fmt: skip


@given(JSON, JSON)
def test_any_json_in_place_of_the_reply_is_read_without_an_error(
    said: object, logprobs: object
) -> None:
    choice = {"message": {"content": said}, "logprobs": logprobs}
    for body in (
        said,
        {"choices": [choice]},
        {"choices": [{"message": {"content": "Yes"}, "logprobs": logprobs}]},
    ):
        reading = read_completion(json.dumps(body))
        assert reading.p_yes is None or 0 <= reading.p_yes <= 1
        assert (reading.reply is Reply.UNKNOWN) <= (reading.p_yes is None)


@given(
    st.lists(
        st.sampled_from(
            [
                "logprobs",
                "top_logprobs at most 5",
                "max_tokens",
                "temperature",
                "max_completion_tokens",
                "something else",
                "",
            ]
        ),
        max_size=30,
    )
)
def test_refusals_end(complaints: list[str]) -> None:
    dialect, changes = Dialect(), 0
    for complaint in complaints:
        after = dialect.after_refusal(complaint)
        if after is not None:
            assert len(after.parameters()) < len(dialect.parameters()) or after != dialect
            dialect, changes = after, changes + 1
    assert changes <= 5
