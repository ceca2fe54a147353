"""The tokens of a reply whose fence or white space the server took away, as llama.cpp does."""

import json

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
