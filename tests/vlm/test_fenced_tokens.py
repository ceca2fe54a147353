"""The tokens of a reply whose fence or white space the server took away, as llama.cpp does."""

import json
import time

import pytest

from tpvqa.vlm.together import read_together


@pytest.mark.parametrize(
    ("pieces", "source"),
    [
        (["```json", '{"q1"', "\n :", '"', "no", '" }', " ```"], "logprobs"),
        (["```json", '{"q1"', "\n :", '"', "no", '"}', " ```"], "word"),
        (["\n", '{"q1"', "\n :", '"', "no", '" }', "\n", ""], "logprobs"),
        (["But: ```json", '{"q1"', "\n :", '"', "no", '" }', " ```"], "word"),
    ],
    ids=["fence", "another text", "white space", "more than a fence"],
)
def test_fence_and_white_space_alone_may_be_left_out(pieces: list[str], source: str) -> None:
    shown = {"no": -0.1, "yes": -2.4}
    tokens = [
        {
            "token": piece,
            "logprob": -0.1,
            "top_logprobs": [
                {"token": word, "logprob": value}
                for word, value in (shown if piece == "no" else {piece: -0.1}).items()
            ],
        }
        for piece in pieces
    ]
    message = {"role": "assistant", "content": '{"q1"\n :"no" }'}
    choice = {"message": message, "finish_reason": "stop", "logprobs": {"content": tokens}}
    ((reading,),) = read_together(json.dumps({"choices": [choice]}), 1)
    assert reading.text == "no"
    assert reading.source == source


@pytest.mark.parametrize(
    "pieces",
    [
        ["```" + " " * 200_000 + "x"],
        ["```" + " \n" * 50_000, "```" * 20_000, "x"],
        [""] * 100_000,
        ['{"q1"', ":", '"', "no", '"}', *[" "] * 100_000],
    ],
    ids=["a fence with no end", "many fences", "empty tokens", "white space"],
)
def test_what_tokens_say_is_read_quickly(pieces: list[str]) -> None:
    tokens = [{"token": piece, "logprob": -0.1} for piece in pieces]
    answers = {f"q{number}": "no" for number in range(1, 65)}
    message = {"role": "assistant", "content": json.dumps(answers)}
    choice = {"message": message, "finish_reason": "stop", "logprobs": {"content": tokens}}
    body = json.dumps({"choices": [choice]})
    began = time.process_time()
    ((*readings,),) = read_together(body, 64)
    assert time.process_time() - began < 5
    assert {(reading.text, reading.source) for reading in readings} == {("no", "word")}


def test_no_more_replies_are_read_than_were_asked_for() -> None:
    choices = [
        {"message": {"role": "assistant", "content": json.dumps({"q1": word})}}
        for word in ("yes", "no", "no")
    ]
    body = json.dumps({"choices": choices})
    found = read_together(body, 1, choices=2)
    assert [[reading.text for reading in readings] for readings in found] == [["yes"], ["no"]]
