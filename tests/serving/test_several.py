"""Several questions in one request: what tpvqa's client and others get, and what is refused."""

import json
import math
from collections.abc import Sequence
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.doubles import worded
from tests.serving.faulty_proxy import Fault, FaultyProxy
from tests.serving.running import Known, body, complete, picture, running
from tpvqa.observation import Frame, Observation
from tpvqa.serving.several import MOST_QUESTIONS, questions_in
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.chat_completions import Inquiry, answers_schema, messages
from tpvqa.vlm.openai_compatible import OpenAICompatibleVLM
from tpvqa.vlm.prompt import shipped_prompt

TABLE: dict[str, float | Reply] = {
    "Is the fridge open?": 0.9,
    "Is the plate clean?": 0.25,
    "Is it dark?": Reply.CANNOT_SEE,
    "Is it raining?": Reply.UNKNOWN,
}
WORDS = ["yes", "no", "unknown"]


@pytest.fixture(autouse=True)
def _directly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    monkeypatch.delenv("OPENAI_API_KEY", raising=False)


def asked(text: str, keys: Sequence[str], words: Sequence[str] = WORDS, **more: Any) -> Any:
    """A request for an object with these keys."""
    properties = {key: {"type": "string", "enum": list(words)} for key in keys}
    schema = {"type": "object", "properties": properties, "required": list(keys)}
    wanted = {"type": "json_schema", "json_schema": {"name": "answers", "schema": schema}}
    return body(text, picture(), response_format=wanted, **more)


def client(url: str, **more: Any) -> OpenAICompatibleVLM:
    return OpenAICompatibleVLM("known", base_url=url, together=True, **more)


def ask(vlm: OpenAICompatibleVLM, texts: Sequence[str], views: int = 1) -> list[Answer]:
    names = [f"view{number}" for number in range(views)]
    frames = {name: Frame(name, name, picture(at)) for at, name in enumerate(names)}
    return vlm.ask(Observation(0, 0.0, frames), [worded(text) for text in texts])


@pytest.mark.parametrize("views", [1, 3])
def test_a_step_asked_together_has_the_answers_of_each_question_alone(views: int) -> None:
    served = Known(TABLE)
    with running(served) as serving:
        vlm = client(serving.address)
        together = ask(vlm, list(TABLE), views)
        calls, usage = len(served.calls), vlm.usage.requests
        vlm.close()
        vlm = OpenAICompatibleVLM("known", base_url=serving.address)
        alone = ask(vlm, list(TABLE), views)
        vlm.close()
    assert (calls, usage) == (1, 1)
    assert [answer.reply for answer in together] == [answer.reply for answer in alone]
    assert [answer.reply.value for answer in together] == ["yes", "no", "unknown", "unknown"]
    for one, other in zip(together, alone, strict=True):
        assert one.p_yes == pytest.approx(other.p_yes, abs=1e-6)


def test_the_object_is_what_its_tokens_say() -> None:
    with running(Known(TABLE)) as serving:
        text = "fridge: Is the fridge open?\nwet: Is it raining?\nfridge, wet: yes, no or unknown."
        text = text.replace("fridge, wet:", "In JSON, each")
        said = complete(serving, asked(text, ["fridge", "wet"], logprobs=True, top_logprobs=5))
    choice = said.json["choices"][0]
    assert json.loads(said.word) == {"fridge": "yes", "wet": "unknown"}
    assert choice["message"]["refusal"] is None
    tokens = choice["logprobs"]["content"]
    assert "".join(token["token"] for token in tokens) == said.word
    assert said.json["usage"]["completion_tokens"] == len(tokens)
    odds = {each["token"]: math.exp(each["logprob"]) for each in tokens[1]["top_logprobs"]}
    assert odds == pytest.approx({"yes": 0.9, "no": 0.1})


def test_cannot_see_is_said_where_the_form_has_it() -> None:
    with running(Known(TABLE)) as serving:
        words = [*WORDS, "cannot see"]
        said = complete(serving, asked("dark: Is it dark?", ["dark"], words))
    assert json.loads(said.word) == {"dark": "cannot see"}


def test_samples_of_several_are_drawn_each_by_itself() -> None:
    with running(Known({"Is it so?": 0.5, "Is it?": 0.5})) as serving:
        sent = asked("a: Is it so?\nb: Is it?", ["a", "b"], n=16, temperature=1.0, seed=7)
        said = complete(serving, sent).json["choices"]
    drawn = {tuple(json.loads(one["message"]["content"]).values()) for one in said}
    assert drawn == {("yes", "yes"), ("yes", "no"), ("no", "yes"), ("no", "no")}


def test_what_else_is_said_is_put_before_each_question() -> None:
    """So a VLM that knows certain questions says that it does not know these."""
    sent = messages(
        Inquiry(tuple(TABLE), (Frame("a", "a", b""),), (Frame("b", "b", b""),), together=True),
        shipped_prompt(),
    )
    keys = dict.fromkeys(["q1", "q2", "q3", "q4"], frozenset[str]())
    found = questions_in(str(sent[0]["content"][-1]["text"]), keys)
    for question, text in zip(found, TABLE, strict=True):
        assert question.startswith("Of these pictures the first 1 show")
        assert question.endswith(f"The question is about now. {text}")


REFUSED = {
    "two words": (asked("a: Is it so?", ["a"], ["yes", "no"]), "unknown"),
    "a number": (
        body(
            "a: How many?",
            picture(),
            response_format={
                "type": "json_schema",
                "json_schema": {
                    "schema": {"type": "object", "properties": {"a": {"type": "integer"}}}
                },
            },
        ),
        "enum",
    ),
    "no schema": (
        body("a: Is it?", picture(), response_format={"type": "json_schema"}),
        "json_schema",
    ),
    "no key": (asked("a: Is it?", ["a", "b"]), "no question behind b:"),
    "a key twice": (asked("a: Is it?\na: Is it not?", ["a"]), "a: stands twice"),
    "an empty question": (asked("a:\nb: Is it?", ["a", "b"]), "no question behind a:"),
    "a strange key": (asked("a.*: Is it?", ["a.*"]), "key"),
    "too many": (
        asked("", [f"q{at}" for at in range(MOST_QUESTIONS + 1)]),
        f"{MOST_QUESTIONS} items",
    ),
}


def test_forms_that_cannot_be_kept_to_are_refused() -> None:
    vlm = Known(TABLE)
    with running(vlm) as serving:
        for name, (sent, reason) in REFUSED.items():
            said = complete(serving, sent)
            assert said.status == 400, name
            assert reason in said.error["message"], (name, said.error["message"])
        assert vlm.calls == []


@pytest.mark.parametrize("fault", [each for each in Fault if each is not Fault.NONE])
def test_after_one_fault_answers_are_right_or_unknown(fault: Fault) -> None:
    with running(Known(TABLE)) as serving:
        chosen = lambda number: fault if number == 1 else Fault.NONE  # noqa: E731
        with FaultyProxy(serving.address, chosen, delay=1.0) as proxy:
            vlm = client(proxy.url, retries=2, request_timeout=0.5, deadline=8)
            answers = ask(vlm, list(TABLE))
            vlm.close()
    for answer in answers:
        known = TABLE[answer.question.text]
        right = Reply.YES if known == 0.9 else Reply.NO
        assert answer.reply in ({right, Reply.UNKNOWN} if known in (0.9, 0.25) else {Reply.UNKNOWN})


@given(
    st.lists(
        st.text(st.sampled_from("abc ?.:q1"), min_size=1).map(lambda text: f"x{text}?"),
        min_size=1,
        max_size=5,
    )
)
def test_each_question_comes_through_as_alone(texts: list[str]) -> None:
    """Whatever a question says, but for the keys: its own words, in its own place."""
    clean = [text.replace(":", "").replace("  ", " ") for text in texts]
    frame = Frame("a", "a", b"")
    (sent,) = messages(Inquiry(tuple(clean), (frame,), together=True), shipped_prompt())
    keys = list(answers_schema(len(clean))["json_schema"]["schema"]["properties"])
    found = questions_in(str(sent["content"][-1]["text"]), dict.fromkeys(keys, frozenset()))
    assert [each.split() for each in found] == [each.split() for each in clean]
