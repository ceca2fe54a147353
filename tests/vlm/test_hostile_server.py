"""A server that is not to be trusted: what it sends back never costs the key, time or the truth."""

import base64
import gzip
import json
import random
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.vlm.chat_server import Act, ChatServer, Request, completion
from tests.vlm.test_openai_compatible import look, questions
from tpvqa.addresses import checked_address
from tpvqa.errors import AnswerError
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.chat_completions import read_completion
from tpvqa.vlm.openai_compatible import OpenAICompatibleVLM
from tpvqa.vlm.server_text import KEY as TAKEN_OUT
from tpvqa.vlm.server_text import ServerText
from tpvqa.vlm.together import read_together

KEY = "sk-proj-Zk83hTq9_vXw2LmN-04rBcYd7"
QUESTION = "Is the fridge open?"


def always(act: Act) -> Callable[[Request, int], Act]:
    return lambda *_: act


def asked(act: Act | Callable[[Request, int], Act], **options: Any) -> Answer:
    script = act if callable(act) else always(act)
    with ChatServer(lambda *_: "no", script=script) as server:
        vlm = OpenAICompatibleVLM("test", base_url=server.url, retries=0, **options)
        try:
            return vlm.ask(look(), questions(QUESTION))[0]
        finally:
            vlm.close()


ECHOES: dict[str, Callable[[str], str]] = {
    "plain": str,
    "in a sentence": lambda key: f"Your key is '{key}', is it not?",
    "header": lambda key: f"Authorization: Bearer {key}",
    "base64": lambda key: base64.b64encode(key.encode()).decode(),
    "base64 of the header": lambda key: base64.b64encode(f"Bearer {key}".encode()).decode(),
    "base64 of user and key": lambda key: base64.b64encode(f"me:{key}".encode()).decode(),
    "urlsafe": lambda key: base64.urlsafe_b64encode(f"a{key}bc".encode()).decode(),
    "percent": lambda key: quote(key, safe=""),
    "hexadecimal": lambda key: key.encode().hex(),
    "hexadecimal in pairs": lambda key: key.encode().hex(" "),
    "backwards": lambda key: key[::-1],
    "halves": lambda key: f"{key[:16]} and then {key[16:]}",
    "the end": lambda key: f"…{key[-12:]}",
    "upper case": str.upper,
    "spaced": " ".join,
    "a line each": "\n".join,
    "zero width": "\u200b".join,
}


def leaks(text: str) -> bool:
    """Whether a text still tells eight letters of the key."""
    plain = "".join(char for char in text.lower() if char.isalnum())
    secret = "".join(char for char in KEY.lower() if char.isalnum())
    pieces = {secret[at : at + 8] for at in range(len(secret) - 7)}
    pieces |= {piece[::-1] for piece in pieces}
    pieces |= {base64.b64encode(KEY[at : at + 9].encode()).decode().lower() for at in range(9)}
    pieces |= {KEY[at : at + 6].encode().hex() for at in range(len(KEY) - 5)}
    return any(piece in plain for piece in pieces)


@pytest.mark.parametrize("way", ECHOES)
def test_the_key_is_taken_out_of_whatever_says_it(way: str) -> None:
    echo = ECHOES[way](KEY)
    found = ServerText(KEY)(f"before {echo} after")
    assert not leaks(found)
    assert found.startswith("before ")
    assert found.endswith(" after")
    assert TAKEN_OUT in found


@given(st.text(), st.text("abcXYZ019-_", min_size=12, max_size=60))
def test_words_that_are_not_the_key_stay(text: str, key: str) -> None:
    found = ServerText(key)(text)
    assert found.replace("\n", "").isprintable()
    if text.isprintable() and TAKEN_OUT not in found:
        assert found == text
    assert ServerText("")("Is the fridge open?") == ServerText("x")("Is the fridge open?")


def test_what_steers_a_terminal_is_escaped_and_long_words_are_cut() -> None:
    found = ServerText(KEY)("\x1b[2J\x1b]0;title\x07\u202eevil\x9b31m" + "a" * 9000)
    assert found.isprintable()
    assert len(found) < 2100


@pytest.mark.parametrize("way", ["plain", "base64 of the header", "halves"])
def test_an_echoed_key_reaches_no_answer_and_no_error(
    way: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", KEY)

    def echo(request: Request) -> str:
        assert request.authorization == f"Bearer {KEY}"
        return ECHOES[way](request.authorization.removeprefix("Bearer "))

    said: list[Callable[[Request, int], Act]] = [
        lambda request, _: Act(body=completion(echo(request), logprobs=False)),
        lambda request, _: Act(body=echo(request)),
        lambda request, _: Act(body={"error": {"message": echo(request)}}),
        lambda request, _: Act(429, {"error": {"message": echo(request)}}),
        lambda request, _: Act(
            400, {"error": {"code": "content_filter", "message": echo(request)}}
        ),
        lambda request, _: Act(400, {"error": {"message": echo(request)}}),
        lambda request, _: Act(404, {"error": {"message": echo(request), "param": echo(request)}}),
        lambda request, _: Act(402, echo(request)),
        lambda request, _: Act(307, "", {"Location": f"http://{echo(request)[:60]}.example/v1"}),
    ]
    for act in said:
        try:
            found = asked(act).text
        except AnswerError as error:
            found = "".join(traceback.format_exception(error))
        assert not leaks(found)
        assert TAKEN_OUT in found


@pytest.mark.parametrize("address", ["http://localhost:8000/v1", "https://[::1]:8/v1", "HTTP://a/"])
def test_ordinary_addresses_are_taken(address: str) -> None:
    assert checked_address(address) == address


@pytest.mark.parametrize("status", [301, 302, 303, 307, 308])
def test_a_picture_is_not_sent_on_to_another_address(status: int) -> None:
    with ChatServer(lambda *_: 0.99) as other:
        there = f"{other.url}/chat/completions"
        with pytest.raises(AnswerError, match=r"sends requests on to .*--base-url"):
            asked(Act(status, "", {"Location": there}))
    assert not other.requests


def test_a_reply_without_end_is_not_read_to_its_end() -> None:
    body = json.dumps(completion("Yes" + " " * 5_000_000, logprobs=False))
    answer = asked(Act(body=body))
    assert answer.reply is Reply.UNKNOWN
    assert "4 MiB" in answer.text


@pytest.mark.parametrize(
    "said", ["Yes, " * 700_000, "Yes" + " " * 3_000_000, "yes no " * 400_000], ids=["a", "b", "c"]
)
def test_a_reply_of_three_megabytes_is_read_within_the_deadline(said: str) -> None:
    began = time.monotonic()
    answer = asked(Act(body=completion(said, logprobs=False)), deadline=20.0)
    assert answer.reply in (Reply.UNKNOWN, Reply.YES)
    assert len(answer.text) < 2100
    assert time.monotonic() - began < 15


@pytest.mark.parametrize("charset", ["punycode", "zlib", "rot13", "utf-7"])
def test_a_refusal_is_read_as_json_is_written_whatever_the_server_says(charset: str) -> None:
    """Punycode takes minutes for some hundred kilobytes, and meanwhile no deadline passes."""
    words = json.dumps({"error": {"message": "abc-" + "a" * 300_000}})
    act = Act(400, body=words, headers={"Content-Type": f"text/plain; charset={charset}"})
    begun = time.monotonic()
    with pytest.raises(AnswerError, match="refuses to be asked: abc-a"):
        asked(act)
    assert time.monotonic() - begun < 5


def test_a_compressed_reply_is_not_unpacked() -> None:
    bomb = gzip.compress(b" " * 10_000_000)
    answer = asked(Act(body=bomb, headers={"Content-Encoding": "gzip"}))
    assert answer.reply is Reply.UNKNOWN
    assert "compressed" in answer.text


BROKEN = {
    "junk": b"\x00\xffgarbage\r\n\r\n",
    "no length": b"HTTP/1.1 200 OK\r\nContent-Length: -5\r\n\r\n{}",
    "cut off": b"HTTP/1.1 200 OK\r\nContent-Length: 9000\r\n\r\n{}",
    "endless headers": b"HTTP/1.1 200 OK\r\n" + b"X: a\r\n" * 50_000 + b"\r\n",
}


@pytest.mark.parametrize("way", BROKEN)
def test_broken_http_is_an_unknown_answer_of_a_server_that_has_spoken(way: str) -> None:
    broken: list[Act] = []
    with ChatServer(lambda *_: "no", script=lambda *_: broken[0] if broken else None) as server:
        vlm = OpenAICompatibleVLM("test", base_url=server.url, retries=1)
        vlm.check()
        broken.append(Act(raw=BROKEN[way]))
        (answer,) = vlm.ask(look(1), questions(QUESTION))
        assert len(server.requests) == 3  # it was tried again
        broken.clear()
        (after,) = vlm.ask(look(1), questions(QUESTION))
        vlm.close()
    assert answer.reply is Reply.UNKNOWN
    assert answer.text.startswith("garbled reply: ")
    assert after.reply is Reply.NO


@pytest.mark.parametrize("way", BROKEN)
def test_what_answers_with_broken_http_at_first_is_no_server(way: str) -> None:
    with pytest.raises(AnswerError, match=r"answers with broken HTTP .*/v1"):
        asked(Act(raw=BROKEN[way]))


@pytest.mark.parametrize("act", [Act(reset=True), Act(raw=b"")], ids=["reset", "hung up"])
def test_a_server_that_is_lost_after_it_has_spoken_cannot_be_reached(act: Act) -> None:
    lost: list[Act] = []
    with ChatServer(lambda *_: "no", script=lambda *_: lost[0] if lost else None) as server:
        vlm = OpenAICompatibleVLM("test", base_url=server.url, retries=0)
        vlm.check()
        lost.append(act)
        with pytest.raises(AnswerError, match="cannot be reached"):
            vlm.ask(look(1), questions(QUESTION))
        vlm.close()


def test_a_reply_that_drips_is_late() -> None:
    act = Act(body=completion("Yes", logprobs=False), drip=0.1)
    answer = asked(act, deadline=0.6, request_timeout=0.4)
    assert answer.reply is Reply.UNKNOWN
    assert "late" in answer.text


def body(said: object = "Yes", **choice: object) -> dict[str, Any]:
    message = {"role": "assistant", "content": said}
    return {"choices": [{"index": 0, "message": message, "finish_reason": "stop", **choice}]}


def tokens(*told: tuple[str, float], top: tuple[tuple[str, float], ...] = ()) -> dict[str, Any]:
    others = [{"token": token, "logprob": p} for token, p in top]
    rows = [{"token": token, "logprob": p, "top_logprobs": others} for token, p in told]
    return {"logprobs": {"content": rows}}


@pytest.mark.parametrize(
    ("sent", "reply"),
    [
        (body(), Reply.YES),
        (body(finish_reason=None), Reply.YES),
        (body(finish_reason="STOP"), Reply.YES),
        (body("Yes.", finish_reason="length"), Reply.YES),
        (body("Yes", finish_reason="length"), Reply.UNKNOWN),
        (body(finish_reason="content_filter"), Reply.UNKNOWN),
        (body(finish_reason="tool_calls"), Reply.UNKNOWN),
        (body(finish_reason="error"), Reply.UNKNOWN),
        (body(finish_reason="abort"), Reply.UNKNOWN),
        (body(finish_reason="SAFETY"), Reply.UNKNOWN),
        (body(message={"role": "user", "content": "Yes"}), Reply.UNKNOWN),
        (body(message={"content": "Yes", "refusal": "I can't"}), Reply.UNKNOWN),
        (body(message={"content": "Yes", "tool_calls": [{"id": "1"}]}), Reply.UNKNOWN),
        ({**body(), "error": {"message": "overloaded"}}, Reply.UNKNOWN),
        ({"choices": [*body()["choices"], *body("No")["choices"]]}, Reply.UNKNOWN),
        ({"choices": [*body()["choices"], *body("Yes.")["choices"]]}, Reply.YES),
        (body(**tokens(("Yes", -0.01))), Reply.YES),
        (body(**tokens(("No", -0.01))), Reply.UNKNOWN),
        (body(**tokens(("Yes", -3.0), top=(("No", -0.06),))), Reply.UNKNOWN),
        (body(**tokens(("Yes", -0.06), top=(("No", -3.0),))), Reply.YES),
        (body(**tokens(("Yes", -0.693), top=(("No", -0.693),))), Reply.UNKNOWN),
        (body(**tokens(("Yes", -0.001), top=(("No", -0.001), ("No", -12.0)))), Reply.UNKNOWN),
        (body(**tokens(("Yes", -0.001), top=(("No", -0.001), ("No", -0.001)))), Reply.UNKNOWN),
        (body(**tokens(("Yes", -0.1), top=(("Yes", -3.0), ("Yes", -0.1)))), Reply.YES),
        (body(**tokens(("No", -0.1), ("Yes", -0.1))), Reply.UNKNOWN),
        (body(**tokens(("Maybe", -0.1))), Reply.UNKNOWN),
        (body(**tokens(("Not", -0.1), (" sure", -0.1))), Reply.UNKNOWN),
        (body("No, the fridge is closed.", **tokens(("Yes", -0.01))), Reply.UNKNOWN),
        (body("No.", **tokens(("no", -0.01), (".", -0.01))), Reply.NO),
        (body(**tokens(("ye\u017f", -0.01))), Reply.UNKNOWN),
    ],
)
def test_what_the_rest_of_a_reply_says_counts_too(sent: dict[str, Any], reply: Reply) -> None:
    reading = read_completion(json.dumps(sent), QUESTION)
    assert reading.reply is reply
    assert reading.text


NAN, ENDLESS = float("nan"), float("inf")


@pytest.mark.parametrize(
    "logprobs",
    [
        tokens(("Yes", -0.1), top=(("No", NAN),)),
        tokens(("Yes", -0.3), top=(("No", 5.0),)),
        tokens(("Yes", NAN), top=(("No", NAN),)),
        tokens(("Yes", ENDLESS), top=(("No", -0.1),)),
        tokens(("Yes", 0.9), top=(("No", 0.1),)),
        {"logprobs": {"content": [{"token": "Yes", "logprob": "-0.1"}]}},
        {"logprobs": {"content": [{"token": "Yes", "logprob": 10**400}]}},
    ],
)
def test_a_logprob_that_is_none_leaves_the_bare_word(logprobs: dict[str, Any]) -> None:
    reading = read_completion(json.dumps(body(**logprobs)), QUESTION)
    assert (reading.reply, reading.source, reading.p_yes) == (Reply.YES, "word", None)
    logprobs["logprobs"]["content"][0]["token"] = "No"
    assert read_completion(json.dumps(body(**logprobs)), QUESTION).reply is Reply.UNKNOWN


@pytest.mark.parametrize(
    ("top", "most"),
    [
        ((), 0.905),  # yes has .905, and the rest may all be a no's
        ((("yes", -4.0),), 0.981),  # no has at most what the last listed has
        ((("Maybe", -3.0),), 0.953),
        ((("Maybe", -2.4), ("It", -9.0)), 0.9999),
        ((("No", -9999.0),), 1.0),  # OpenAI's for "hardly ever"
    ],
)
def test_p_yes_is_no_surer_than_what_is_listed(
    top: tuple[tuple[str, float], ...], most: float
) -> None:
    top = (("Yes", -0.1), *top) if top else ()
    reading = read_completion(json.dumps(body(**tokens(("Yes", -0.1), top=top))), QUESTION)
    assert reading.reply is Reply.YES
    assert reading.p_yes == pytest.approx(most, abs=1e-3)
    no = tuple((word.replace("Yes", "No"), p) for word, p in top if word != "No")
    if len(no) == len(top):
        opposite = json.dumps(body("No", **tokens(("No", -0.1), top=no)))
        reading = read_completion(opposite.replace('"yes"', '"no"'), QUESTION)
        assert reading.p_yes == pytest.approx(1 - most, abs=1e-3)


@pytest.mark.parametrize(
    ("contrary", "p_yes"), [({"no": NAN}, None), ({"no": 5.0}, None), ({}, 0.905)]
)
def test_together_the_same_holds_for_each_answer(
    contrary: dict[str, float], p_yes: float | None
) -> None:
    rows = [
        {"token": text, "logprob": -0.1, "top_logprobs": top}
        for text, top in (
            ('{"q1": "', []),
            ("yes", [{"token": "no", "logprob": p} for p in contrary.values()]),
            ('"}', []),
        )
    ]
    sent = body('{"q1": "yes"}', logprobs={"content": rows})
    ((reading,),) = read_together(json.dumps(sent), 1)
    assert reading.reply is Reply.YES
    assert reading.source == ("word" if p_yes is None else "logprobs")
    assert reading.p_yes == (None if p_yes is None else pytest.approx(p_yes, abs=1e-3))


def test_together_choices_that_differ_are_no_answer() -> None:
    texts = ('{"q1": "yes", "q2": "no"}', '{"q1": "no", "q2": "no"}')
    sent = {"choices": [choice for text in texts for choice in body(text)["choices"]]}
    ((first, second),) = read_together(json.dumps(sent), 2)
    assert (first.reply, second.reply) == (Reply.UNKNOWN, Reply.NO)
    assert "several answers" in first.text


@pytest.mark.parametrize(
    "message",
    ['"content": "no", "content": "yes"', '"content": "yes", "content": "yes"',
     '"content": "yes", "role": "user", "role": "assistant"'],
)  # fmt: skip
def test_what_is_said_twice_is_no_answer(message: str) -> None:
    reading = read_completion('{"choices": [{"message": {' + message + "}}]}", QUESTION)
    assert reading.reply is Reply.UNKNOWN
    assert "garbled" in reading.text


REPLIES = [
    json.loads(line)
    for line in (Path(__file__).parent / "replies.jsonl").read_text(encoding="utf-8").splitlines()
]
JUNK = [
    "null",
    "[]",
    "{}",
    '"',
    "yes",
    "No",
    "\\u0000",
    "1e999",
    "NaN",
    ",",
    ":",
    "true",
    "-1",
    "\ud800",
]


def mutated(text: str, rng: random.Random) -> str:
    """A text with a few pieces taken out, doubled, exchanged or replaced."""
    for _ in range(rng.randint(1, 4)):
        at, size = rng.randrange(len(text) + 1), rng.randint(0, 8)
        piece = text[at : at + size]
        put = rng.choice(["", piece * 2, rng.choice(JUNK), piece[::-1], chr(rng.randrange(0x3000))])
        text = text[:at] + put + text[at + size :]
    return text


@pytest.mark.parametrize("part", range(5))
def test_mutated_bodies_are_read_without_an_error_or_the_opposite(part: int) -> None:
    """300 each, and a yes never becomes a no, as its word is not in it."""
    rng = random.Random(part)
    for _ in range(300):
        reply = rng.choice(REPLIES)
        told = tokens(("Yes", -0.1)) if rng.random() < 0.3 else {}
        whole = json.dumps(body(reply["text"], **told))
        sent = mutated(whole, rng)
        try:
            data: str | bytes = sent.encode()
        except UnicodeEncodeError:
            data = sent
        reading = read_completion(data, reply["question"])
        assert reading.p_yes is None or 0 <= reading.p_yes <= 1
        opposite = {"yes": Reply.NO, "no": Reply.YES}.get(reply["reply"])
        if reading.reply is opposite:
            assert opposite.value in sent.lower().replace(whole.lower(), "")
        if reading.reply in (Reply.YES, Reply.NO):
            said = json.loads(sent)["choices"][0]["message"]["content"]
            assert reading.reply.value in said.lower()


def test_mutated_bodies_of_a_real_server() -> None:
    rng = random.Random(7)
    sent = [
        mutated(json.dumps(body(rng.choice(REPLIES)["text"])), rng).encode("utf-8", "replace")
        for _ in range(60)
    ]
    rest = iter(sent)
    with ChatServer(lambda *_: "no", script=lambda *_: Act(body=next(rest) or b" ")) as server:
        vlm = OpenAICompatibleVLM("test", base_url=server.url, retries=0)
        for number in range(50):
            (answer,) = vlm.ask(look(number), questions(QUESTION))
            assert answer.reply in (Reply.YES, Reply.NO, Reply.UNKNOWN)
        vlm.close()
