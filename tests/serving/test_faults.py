"""Between client and server all goes wrong: no answer comes of that which the VLM did not give."""

import socket
from urllib.parse import urlsplit

import pytest

from tests.doubles import worded
from tests.serving.faulty_proxy import Fault, FaultyProxy
from tests.serving.running import Known, body, call, complete, picture, running
from tpvqa.errors import AnswerError
from tpvqa.observation import Frame, Observation
from tpvqa.serving.app import Limits
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.openai_compatible import OpenAICompatibleVLM

TABLE = {"Is the fridge open?": 0.9, "Is the plate clean?": 0.25, "Is it so?": 0.6}
RIGHT = {text: Reply.YES if p > 0.5 else Reply.NO for text, p in TABLE.items()}
PATIENCE = 1.5  # a loaded machine takes half a second for nothing
"""Seconds that the client has for one request."""
ASKED_AGAIN = {
    Fault.DROPPED,
    Fault.RESET,
    Fault.DELAYED,
    Fault.TRUNCATED,
    Fault.TOO_LONG,
    Fault.BUSY,
    Fault.BROKEN,
    Fault.NO_HTTP,
    Fault.DRIP,
}
NOT_THERE = {
    Fault.DROPPED: "cannot be reached",
    Fault.RESET: "cannot be reached",
    Fault.TRUNCATED: "answers with broken HTTP",
    Fault.NO_HTTP: "answers with broken HTTP",
}
"""What is taken for no server, where nothing else ever comes, and what is said of it."""


@pytest.fixture(autouse=True)
def _directly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    monkeypatch.delenv("OPENAI_API_KEY", raising=False)


def ask(url: str, retries: int) -> list[Answer]:
    vlm = OpenAICompatibleVLM(
        "known", base_url=url, retries=retries, request_timeout=PATIENCE, deadline=8, concurrency=3
    )
    frame = Frame("a", "front", picture())
    try:
        return vlm.ask(Observation(0, 0.0, {"front": frame}), [worded(text) for text in TABLE])
    finally:
        vlm.close()


def see_nothing_invented(answers: list[Answer]) -> None:
    for answer in answers:
        text = answer.question.text
        assert answer.reply in (RIGHT[text], Reply.UNKNOWN)
        if answer.reply is Reply.UNKNOWN:
            assert (answer.p_yes, bool(answer.text)) == (None, True)
        else:
            assert answer.p_yes == pytest.approx(TABLE[text], abs=1e-6)


@pytest.mark.parametrize("fault", [each for each in Fault if each is not Fault.NONE])
def test_after_one_fault_the_answers_are_right_or_unknown(fault: Fault) -> None:
    with running(Known(TABLE)) as serving:
        chosen = lambda number: fault if number == 1 else Fault.NONE  # noqa: E731
        with FaultyProxy(serving.address, chosen, delay=2 * PATIENCE) as proxy:
            answers = ask(proxy.url, retries=2)
    see_nothing_invented(answers)
    unknown = [answer for answer in answers if answer.reply is Reply.UNKNOWN]
    assert len(unknown) == (0 if fault in ASKED_AGAIN else 1), [each.text for each in unknown]
    assert len(proxy.met) == len(TABLE) + (fault in ASKED_AGAIN)


@pytest.mark.parametrize("fault", [each for each in Fault if each is not Fault.NONE])
def test_where_nothing_else_comes_the_answers_are_unknown_or_an_error(fault: Fault) -> None:
    with (
        running(Known(TABLE)) as serving,
        FaultyProxy(serving.address, lambda _: fault, delay=2 * PATIENCE) as proxy,
    ):
        if fault in NOT_THERE:
            with pytest.raises(AnswerError, match=NOT_THERE[fault]):
                ask(proxy.url, retries=0)
            return
        answers = ask(proxy.url, retries=0)
    assert {answer.reply for answer in answers} == {Reply.UNKNOWN}
    see_nothing_invented(answers)


def test_a_server_that_has_no_room_is_asked_again() -> None:
    """429 of the server itself, with what it says of when to come back."""
    with running(Known(TABLE), limits=Limits(waiting=1)) as serving:
        vlm = OpenAICompatibleVLM("known", base_url=serving.address, concurrency=3, retries=3)
        frame = Frame("a", "front", picture())
        answers = vlm.ask(Observation(0, 0.0, {"front": frame}), [worded(text) for text in TABLE])
        vlm.close()
    assert [answer.reply for answer in answers] == list(RIGHT.values())


def test_a_served_vlm_may_be_another_server() -> None:
    """P(yes) comes through two of them, and what the first does not know stays unknown."""
    with running(Known(TABLE)) as first:
        passing_on = OpenAICompatibleVLM("known", base_url=first.address)
        with running(passing_on, model="known") as second:
            see_nothing_invented(found := ask(second.address, retries=0))
            unknown = complete(second, body("Is it raining?", picture(), logprobs=True))
    assert [answer.reply for answer in found] == list(RIGHT.values())
    assert unknown.word == "unknown"
    assert "so says the table" in unknown.json["choices"][0]["message"]["refusal"]


@pytest.mark.parametrize(
    ("kind", "length"),
    [("application/json", 5000), ("text/plain", 5000), ("application/json", 2**40)],
    ids=["wanted", "of another kind", "too large"],
)
def test_a_client_that_goes_while_it_sends_leaves_no_trace(
    kind: str, length: int, capfd: pytest.CaptureFixture[str]
) -> None:
    with running(Known(TABLE)) as serving:
        place = urlsplit(serving.address)
        with socket.create_connection((place.hostname or "", place.port or 0), 10) as going:
            going.sendall(
                f"POST /v1/chat/completions HTTP/1.1\r\nHost: {place.netloc}\r\n"
                f"Content-Type: {kind}\r\nContent-Length: {length}\r\n\r\n".encode()
                + b"{" * 100
            )
            assert call(serving, "GET", "/health").status == 200  # by now the body is waited for
        assert complete(serving, body("Is it so?", picture())).word == "yes"
    assert capfd.readouterr().err == ""
