"""Ways of asking a server: together, by samples, before and after, with a prompt, on a budget."""

import json
from collections.abc import Mapping
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from tests.doubles import worded
from tests.vlm.chat_server import Act, ChatServer, Request, completion, refusal
from tpvqa.errors import AnswerError, BudgetError, PromptError
from tpvqa.observation import Frame, Observation
from tpvqa.questions import Way
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.openai_compatible import OpenAICompatibleVLM
from tpvqa.vlm.prompt import load_prompt, shipped_text

TEXTS = ("Is it open?", "Is it clean?", "Is it on?")


@pytest.fixture(autouse=True)
def environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("OPENAI_API_KEY", raising=False)
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")


def picture(size: tuple[int, int] = (64, 48)) -> bytes:
    file = BytesIO()
    Image.linear_gradient("L").resize(size).convert("RGB").save(file, "PNG")
    return file.getvalue()


def look(number: int = 0, data: bytes = b"a picture") -> Observation:
    return Observation(number, 0.0, {"front": Frame(f"f{number}", "front", data, "image/png")})


def ask(server: ChatServer, *texts: str, **options: Any) -> list[Answer]:
    vlm = OpenAICompatibleVLM("test", base_url=server.url, **options)
    try:
        return vlm.ask(look(), [worded(text) for text in texts])
    finally:
        vlm.close()


def said(words: str, **changes: Any) -> Mapping[str, Any]:
    body = completion(words, logprobs=False)
    body["choices"][0] |= changes
    return body


def test_all_questions_go_in_one_request_with_a_schema() -> None:
    reply = json.dumps({"q1": "yes", "q2": "no", "q3": "unknown"})
    with ChatServer(lambda *_: reply) as server:
        answers = ask(server, *TEXTS, together=True)
    (request,) = server.requests
    assert request.body["response_format"]["json_schema"]["schema"]["required"] == [
        "q1",
        "q2",
        "q3",
    ]
    assert all(text in request.body["messages"][-1]["content"][-1]["text"] for text in TEXTS)
    assert [each.reply for each in answers] == [Reply.YES, Reply.NO, Reply.UNKNOWN]


@pytest.mark.parametrize(
    "reply",
    [
        '{"q1": "yes", "q1": "no", "q3": "no"}',
        '{"q1": 1, "q2": ["no"], "q3": "no"}',
        '{"q1": "yes no", "q2": null, "q3": "No"}',
        '{"q1": ' + '{"a": ' * 900 + "1" + "}" * 900 + ', "q2": 1e999, "q3": "no"}',
        '{"q1": ' + "9" * 5000 + ', "q2": NaN, "q3": "no"}',
    ],
)
def test_an_answer_missing_doubled_or_malformed_is_unknown_by_itself(reply: str) -> None:
    with ChatServer(lambda *_: reply) as server:
        answers = ask(server, *TEXTS, together=True)
    assert [each.reply for each in answers] == [Reply.UNKNOWN, Reply.UNKNOWN, Reply.NO]
    assert all(each.text for each in answers)


@pytest.mark.parametrize("reply", ["[]", "yes", "", '{"q1": "yes"', "null", "[" * 9999])
def test_without_an_object_all_is_unknown(reply: str) -> None:
    with ChatServer(lambda *_: reply) as server:
        assert {each.reply for each in ask(server, *TEXTS, together=True)} == {Reply.UNKNOWN}


def test_a_server_that_refuses_a_schema_is_asked_in_words() -> None:
    def picky(request: Request, _: int) -> Act | None:
        refused = "response_format" in request.body
        return refusal(400, "response_format is not supported") if refused else None

    with ChatServer(lambda *_: '{"q1": "yes", "q2": "no"}', script=picky) as server:
        answers = ask(server, *TEXTS[:2], together=True)
    assert [each.reply for each in answers] == [Reply.YES, Reply.NO]
    assert len(server.requests) == 3


def test_p_yes_of_each_answer_comes_from_its_own_token() -> None:
    def token(text: str, **others: float) -> dict[str, Any]:
        top = [{"token": word, "logprob": at} for word, at in {text: -0.1, **others}.items()]
        return {**top[0], "top_logprobs": top}

    parts = ['{"q1": "', "yes", '", "q2": "', "no", '"}']
    content = [token(part) for part in parts]
    content[1], content[3] = token("yes", no=-2.4), token("no", yes=-1.2)
    content[3]["logprob"] = content[3]["top_logprobs"][0]["logprob"] = -0.36
    body = said("".join(parts), logprobs={"content": content})
    with ChatServer(lambda *_: "", script=lambda *_: Act(body=body)) as server:
        answers = ask(server, *TEXTS[:2], together=True)
    assert [each.source for each in answers] == ["logprobs", "logprobs"]
    assert [each.p_yes for each in answers] == pytest.approx([0.909, 0.302], abs=0.01)


@pytest.mark.parametrize("gives_n", [True, False])
def test_samples_give_p_yes_where_there_are_no_logprobs(gives_n: bool) -> None:
    words = iter(["yes", "yes", "no", "yes", "yes"])  # the first is the likeliest reply

    def script(request: Request, _: int) -> Act:
        count = request.body.get("n", 1) if gives_n else 1
        body = dict(completion("", logprobs=False))
        body["choices"] = [said(next(words))["choices"][0] for _ in range(count)]
        return Act(body=body)

    with ChatServer(lambda *_: "", script=script) as server:
        (answer,) = ask(server, TEXTS[0], samples=4)
    assert (answer.reply, answer.source) == (Reply.YES, "samples")
    assert answer.p_yes == pytest.approx(3.5 / 5)
    assert len(server.requests) == (2 if gives_n else 5)


def test_effects_are_shown_before_and_after_and_other_questions_are_not() -> None:
    seen = replace(look(2, b"after"), before=look(1, b"before"))
    effect, other = (
        replace(worded(text), way=way)  # type: ignore[arg-type]
        for text, way in zip(TEXTS, (Way.EFFECT, Way.PRECONDITION), strict=False)
    )
    with ChatServer(lambda *_: 0.9) as server:
        vlm = OpenAICompatibleVLM("test", base_url=server.url, before_after=True)
        vlm.ask(seen, [effect, other])
        vlm.close()
    shown = {request.question: request.pictures for request in server.requests}
    assert shown == {TEXTS[0]: (b"before", b"after"), TEXTS[1]: (b"after",)}


def test_pictures_are_made_smaller_once_to_the_size_that_is_stated() -> None:
    with ChatServer(lambda *_: 0.9) as server:
        vlm = OpenAICompatibleVLM("test", base_url=server.url, picture_size=100)
        vlm.ask(look(0, picture((400, 200))), [worded(TEXTS[0])])
        vlm.ask(look(1, small := picture((100, 50))), [worded(TEXTS[0])])
        vlm.close()
    large, same = (Image.open(BytesIO(each.pictures[0])) for each in server.requests)
    assert (large.size, large.format) == ((100, 50), "JPEG")
    assert server.requests[1].pictures == (small,)
    assert same.size == (100, 50)


@pytest.mark.parametrize("longest", [1024, 30])
def test_a_picture_of_a_phone_is_sent_upright_whatever_its_size(longest: int) -> None:
    exif, file = Image.Exif(), BytesIO()
    exif[0x0112] = 6
    Image.open(BytesIO(picture((60, 40)))).save(file, "JPEG", exif=exif)
    with ChatServer(lambda *_: 0.9) as server:
        vlm = OpenAICompatibleVLM("test", base_url=server.url, picture_size=longest)
        vlm.ask(look(0, file.getvalue()), [worded(TEXTS[0])])
        vlm.close()
    sent = Image.open(BytesIO(server.requests[0].pictures[0]))
    assert sent.size == ((40, 60) if longest > 60 else (20, 30))
    assert not sent.getexif()


def test_a_prompt_of_ones_own_with_an_example(tmp_path: Path) -> None:
    (tmp_path / "open.png").write_bytes(picture())
    file = tmp_path / "prompt.yaml"
    file.write_text(
        'question: "Look. {question} One word!"\n'
        "examples:\n  - {pictures: open.png, question: 'Is it shut?', answer: 'no'}\n"
    )
    with ChatServer(lambda *_: 0.9) as server:
        ask(server, TEXTS[0], prompt=str(file))
    roles = [each["role"] for each in server.requests[0].body["messages"]]
    assert roles == ["user", "assistant", "user"]
    text = server.requests[0].body["messages"][-1]["content"][-1]["text"]
    assert text == f"Look. {TEXTS[0]} One word!"


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("question: no slot", r":1: question: has to hold \{question\}"),
        ("questoin: x", "not known here"),
        ("examples:\n  - {pictures: gone.png, question: 'Is it?', answer: 'no'}", ":2:.*gone.png"),
        ("examples:\n  - {pictures: p.png, question: 'Is it?', answer: maybe}", "yes or no"),
        ("", "tpvqa prompt"),
    ],
)
def test_a_bad_prompt_is_refused_with_its_place(tmp_path: Path, text: str, why: str) -> None:
    (tmp_path / "prompt.yaml").write_text(text)
    (tmp_path / "p.png").write_bytes(picture())
    with pytest.raises(PromptError, match=why):
        load_prompt(tmp_path / "prompt.yaml")


def test_the_shipped_prompt_can_be_copied(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(shipped_text())
    shipped = OpenAICompatibleVLM("test").parameters
    mine = OpenAICompatibleVLM("test", prompt=str(tmp_path / "mine.yaml")).parameters
    assert mine == shipped


@pytest.mark.parametrize(
    ("limit", "made"),
    [
        ({"max_requests": 4}, 4),
        ({"max_tokens_spent": 7}, 3),  # two tokens a request
        ({"max_cost": 5e-6, "price_prompt": 1.0, "price_completion": 1.0}, 2),
    ],
)
def test_a_budget_stops_before_the_request_that_would_exceed_it(
    limit: Mapping[str, Any], made: int
) -> None:
    with ChatServer(lambda *_: 0.9) as server:
        vlm = OpenAICompatibleVLM("test", base_url=server.url, **limit)
        with pytest.raises(BudgetError, match="--max-"):  # noqa: PT012  which of them is told below
            for number in range(9):
                vlm.ask(look(number), [worded(TEXTS[0])])
        vlm.close()
    assert len(server.requests) == made == vlm.usage.requests
    again = OpenAICompatibleVLM("test", base_url=server.url, **limit)
    again.restore(vlm.snapshot())
    assert again.usage == vlm.usage


def test_tokens_that_nobody_counts_cannot_be_limited() -> None:
    body = {key: value for key, value in said("yes").items() if key != "usage"}
    with ChatServer(lambda *_: "", script=lambda *_: Act(body=body)) as server:
        vlm = OpenAICompatibleVLM("test", base_url=server.url, max_tokens_spent=100)
        vlm.check()
        with pytest.raises(AnswerError, match="--max-requests"):
            vlm.ask(look(), [worded(TEXTS[0])])
        vlm.close()
