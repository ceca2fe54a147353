"""OpenAI's own Python package as a client that nobody here wrote."""

import base64
import math
from typing import Any

import openai
import pytest
from openai import OpenAI

from tests.serving.running import INSTRUCTION, Known, picture, running
from tpvqa.serving.app import Limits
from tpvqa.serving.server import Serving

TABLE = {"Is the fridge open?": 0.9, "Is the plate clean?": 0.25}
KEY = "a-token-of-enough-letters"


@pytest.fixture(autouse=True)
def _directly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")


def client(serving: Serving, key: str = "none") -> OpenAI:
    return OpenAI(base_url=serving.address, api_key=key, max_retries=0, timeout=20)


def asked(text: str, *pictures: bytes) -> Any:
    urls = [f"data:image/jpeg;base64,{base64.b64encode(each).decode()}" for each in pictures]
    content: list[Any] = [{"type": "image_url", "image_url": {"url": url}} for url in urls]
    content.append({"type": "text", "text": f"{text} {INSTRUCTION}"})
    return {"model": "known", "messages": [{"role": "user", "content": content}]}


def test_a_completion_with_probabilities() -> None:
    with running(Known(TABLE)) as serving, client(serving) as openais:
        reply = openais.chat.completions.create(
            **asked("Is the plate clean?", picture(), picture(1)), logprobs=True, top_logprobs=5
        )
        (choice,) = reply.choices
        assert (choice.message.content, choice.finish_reason) == ("no", "stop")
        assert choice.logprobs is not None
        assert choice.logprobs.content is not None
        listed = choice.logprobs.content[0].top_logprobs
        odds = {each.token: math.exp(each.logprob) for each in listed}
        assert odds["yes"] / (odds["yes"] + odds["no"]) == pytest.approx(0.25, abs=1e-6)
        assert [model.id for model in openais.models.list()] == ["known"]
        assert openais.models.retrieve("known").object == "model"


def test_an_abstention_is_a_word_with_a_reason() -> None:
    with running(Known(TABLE)) as serving, client(serving) as openais:
        reply = openais.chat.completions.create(**asked("Is it raining?", picture()))
    message = reply.choices[0].message
    assert (message.content, message.refusal) == ("unknown", "so says the table")
    assert reply.choices[0].logprobs is None


def test_several_choices_as_a_stream() -> None:
    with running(Known(TABLE)) as serving, client(serving) as openais:
        events = list(
            openais.chat.completions.create(
                **asked("Is the fridge open?", picture()),
                n=2,
                logprobs=True,
                top_logprobs=2,
                stream=True,
                stream_options={"include_usage": True},
            )
        )
    said = ["", ""]
    ended = []
    for event in events:
        for choice in event.choices:
            said[choice.index] += choice.delta.content or ""
            if choice.delta.content:
                assert choice.logprobs is not None
                assert choice.logprobs.content is not None
                assert choice.logprobs.content[0].token == "yes"
            if choice.finish_reason:
                ended.append((choice.index, choice.finish_reason))
    assert (said, ended) == (["yes", "yes"], [(0, "stop"), (1, "stop")])
    assert events[-1].usage is not None
    assert events[-1].usage.completion_tokens == 2


def test_errors_are_what_the_package_takes_them_for() -> None:
    vlm = Known(TABLE)
    limits = Limits(waiting=1)
    with running(vlm, token=KEY, limits=limits) as serving, client(serving, KEY) as openais:
        create = openais.chat.completions.create
        sent = asked("Is the fridge open?")
        url = {"url": "http://127.0.0.1:9/a.jpg"}
        sent["messages"][0]["content"].insert(0, {"type": "image_url", "image_url": url})
        with pytest.raises(openai.BadRequestError) as remote:
            create(**sent)
        assert (remote.value.code, remote.value.param) == ("remote_image_url", "messages")
        with pytest.raises(openai.NotFoundError):
            create(**{**asked("Is the fridge open?", picture()), "model": "gpt-4o"})
        with client(serving, "wrong") as wrong, pytest.raises(openai.AuthenticationError):
            wrong.models.list()
        vlm.breaks = ValueError()
        with pytest.raises(openai.InternalServerError):
            create(**asked("Is the fridge open?", picture()))
