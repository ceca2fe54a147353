"""The VLM behind a server, over real HTTP."""

import asyncio
import multiprocessing
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from datetime import UTC, datetime, timedelta
from email.utils import format_datetime
from pathlib import Path

import pytest

from tests.doubles import worded
from tests.vlm.chat_server import LEFTOVER, Act, ChatServer, Request, Script, completion, refusal
from tpvqa.errors import AnswerError, MissingExtraError, PluginError
from tpvqa.observation import Frame, Observation
from tpvqa.plugins import Kind, make
from tpvqa.questions import Question
from tpvqa.vlm import VLM, Answer, Reply
from tpvqa.vlm.http_client import seconds_to_wait
from tpvqa.vlm.openai_compatible import OpenAICompatibleVLM

PICTURE = b"\xff\xd8 a picture"
TRUTH = {
    "Is the plate clean?": 0.9,
    "Is the fridge open?": 0.2,
    "Is there a plate in the image?": 0.999,
    "Is the TV turned on?": 0.01,
    "Is the bread on the plate?": 0.6,
    "Is the apple cut in half?": 0.35,
}


@pytest.fixture(autouse=True)
def environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("OPENAI_API_KEY", raising=False)
    monkeypatch.delenv("OPENAI_BASE_URL", raising=False)
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")


def scripted(_pictures: Sequence[bytes], question: str) -> float:
    return TRUTH[question]


def says(words: str) -> Callable[[Sequence[bytes], str], str]:
    return lambda *_: words


def look(number: int = 0, *pictures: bytes) -> Observation:
    frames = {
        f"view{at}": Frame(f"f{number}-{at}", f"view{at}", data)
        for at, data in enumerate(pictures or (PICTURE,))
    }
    return Observation(look=number, time=0.0, frames=frames)


def questions(*texts: str) -> list[Question]:
    return [worded(text) for text in texts]


def ask(server: ChatServer, *texts: str, **options: float) -> list[Answer]:
    vlm = OpenAICompatibleVLM("test", base_url=server.url, **options)  # type: ignore[arg-type]
    try:
        return vlm.ask(look(), questions(*texts))
    finally:
        vlm.close()


def at_first(act: Act, times: int = 1) -> Script:
    return lambda _, before: act if before < times else None


def always(act: Act) -> Script:
    return lambda *_: act


def test_p_yes_comes_from_the_logprobs_of_the_first_answer_token() -> None:
    with ChatServer(scripted) as server:
        answers = ask(server, *TRUTH)
    assert [answer.question.text for answer in answers] == list(TRUTH)
    for answer, p in zip(answers, TRUTH.values(), strict=True):
        assert answer.reply is (Reply.YES if p > 0.5 else Reply.NO)
        assert answer.p_yes == pytest.approx(p)
        assert answer.source == "logprobs"
        assert answer.leftover == pytest.approx(LEFTOVER)


def test_without_logprobs_the_bare_word_is_taken_and_labelled() -> None:
    with ChatServer(scripted, logprobs=False) as server:
        answers = ask(server, *TRUTH)
    assert [a.reply for a in answers] == [
        Reply.YES if p > 0.5 else Reply.NO for p in TRUTH.values()
    ]
    assert {(a.source, a.p_yes, a.leftover) for a in answers} == {("word", None, None)}


def test_the_request_carries_pictures_question_and_no_option_before_the_question() -> None:
    with ChatServer(scripted) as server:
        vlm = OpenAICompatibleVLM("test", base_url=server.url)
        vlm.ask(look(0, b"left eye", b"right eye"), questions("Is the plate clean?"))
        vlm.close()
    (request,) = server.requests
    assert request.pictures == (b"left eye", b"right eye")
    assert request.body["logprobs"] is True
    assert request.body["top_logprobs"] == 20
    assert request.body["temperature"] == 0
    text = request.body["messages"][-1]["content"][-1]["text"]
    before, _, after = text.partition("Is the plate clean?")
    assert "yes" not in before
    assert "no" not in before.split()
    assert after.strip() == "Answer with one word, yes or no."


def test_requests_run_side_by_side_but_no_more_than_allowed() -> None:
    texts = [f"Is it {number}?" for number in range(8)]
    with ChatServer(lambda *_: 0.9, script=always(Act(wait=0.4))) as server:
        ask(server, *texts, concurrency=3)
    assert server.most_at_once == 3


def test_the_same_question_is_asked_once_within_a_look_and_again_at_the_next() -> None:
    with ChatServer(scripted) as server:
        vlm = OpenAICompatibleVLM("test", base_url=server.url)
        twice = vlm.ask(look(0), questions("Is the plate clean?", "Is the plate clean?"))
        vlm.ask(look(0), questions("Is the plate clean?"))
        assert len(server.requests) == 1
        assert twice[0].p_yes == twice[1].p_yes
        vlm.ask(look(1), questions("Is the plate clean?"))
        assert len(server.requests) == 2
        vlm.close()


@pytest.mark.parametrize(
    "act",
    [
        Act(429, {"error": {"message": "slow down"}}, {"Retry-After": "0.05"}),
        Act(500, "oops"),
        Act(503, "<html>busy</html>", {"Content-Type": "text/html"}),
        Act(reset=True),
    ],
    ids=["429", "500", "503 in HTML", "connection reset"],
)
def test_failures_that_pass_are_tried_again(act: Act) -> None:
    with ChatServer(scripted, script=at_first(act)) as server:
        (answer,) = ask(server, "Is the plate clean?")
    assert answer.p_yes == pytest.approx(0.9)
    assert len(server.requests) == 2


def test_failures_that_stay_are_unknown_with_the_reason() -> None:
    with ChatServer(
        scripted, script=lambda r, _: Act(500, "oops") if "clean" in r.question else None
    ) as server:
        broken, fine = ask(server, "Is the plate clean?", "Is the fridge open?", retries=1)
    assert broken.reply is Reply.UNKNOWN
    assert broken.p_yes is None
    assert "500" in broken.text
    assert "oops" in broken.text
    assert fine.reply is Reply.NO


def test_a_failure_is_not_remembered_within_the_look() -> None:
    with ChatServer(scripted, script=at_first(Act(500, "oops"))) as server:
        vlm = OpenAICompatibleVLM("test", base_url=server.url, retries=0)
        first = vlm.ask(look(), questions("Is the plate clean?"))
        second = vlm.ask(look(), questions("Is the plate clean?"))
        vlm.close()
    assert [first[0].reply, second[0].reply] == [Reply.UNKNOWN, Reply.YES]


def test_what_is_late_is_unknown_and_the_rest_is_answered() -> None:
    slow: Script = lambda r, _: Act(wait=60.0) if "clean" in r.question else None  # noqa: E731
    with ChatServer(scripted, script=slow) as server:
        started = time.monotonic()
        late, fine = ask(server, "Is the plate clean?", "Is the fridge open?", deadline=2.0)
        seconds = time.monotonic() - started
    assert late.reply is Reply.UNKNOWN
    assert "late" in late.text
    assert fine.reply is Reply.NO
    assert seconds < 30


def test_a_pause_longer_than_the_deadline_is_not_begun_and_the_reason_is_kept() -> None:
    act = Act(429, {"error": {"message": "slow down"}}, {"Retry-After": "5000"})
    with ChatServer(scripted, script=always(act)) as server:
        started = time.monotonic()
        (answer,) = ask(server, "Is the plate clean?", deadline=30.0)
        seconds = time.monotonic() - started
    assert answer.reply is Reply.UNKNOWN
    assert answer.text.startswith("HTTP status 429: slow down; asking again in 5000 s")
    assert len(server.requests) == 1
    assert seconds < 15


def test_retry_after_may_be_a_date() -> None:
    now = datetime(2026, 1, 1, tzinfo=UTC)
    assert seconds_to_wait(format_datetime(now + timedelta(seconds=30)), now) == 30
    assert seconds_to_wait("Thu, 01 Jan 2026 00:00:30 -0000", now) == 30
    assert seconds_to_wait(format_datetime(now - timedelta(seconds=30)), now) == 0
    assert seconds_to_wait("7.5") == 7.5
    far = f"Thu, 01 Jan {'9' * 30} 00:00:00 GMT"
    assert {seconds_to_wait(none) for none in ("soon", "", "-5", "nan", "\xb2", far)} == {None}


@pytest.mark.parametrize(("seconds", "requests"), [(-60, 2), (5000, 1)])
def test_a_date_is_waited_for_within_the_deadline(seconds: float, requests: int) -> None:
    then = format_datetime(datetime.now(UTC) + timedelta(seconds=seconds), usegmt=True)
    act = Act(429, {"error": {"message": "slow down"}}, {"Retry-After": then})
    with ChatServer(scripted, script=at_first(act)) as server:
        (answer,) = ask(server, "Is the plate clean?", deadline=30.0)
    assert len(server.requests) == requests
    assert (answer.reply is Reply.YES) == (requests == 2)
    assert requests == 2 or "later than the 30 s" in answer.text


def test_what_failed_before_the_deadline_is_said() -> None:
    script: Script = lambda _, before: Act(wait=60.0) if before else Act(500, "oops")  # noqa: E731
    with ChatServer(scripted, script=script) as server:
        (answer,) = ask(server, "Is the plate clean?", deadline=3.0)
    assert answer.text.startswith("late: nothing within 3 s; before that HTTP status 500: oops")


def test_a_hanging_request_is_tried_again() -> None:
    with ChatServer(scripted, script=at_first(Act(wait=60.0))) as server:
        (answer,) = ask(server, "Is the plate clean?", request_timeout=1.5)
    assert answer.reply is Reply.YES


@pytest.mark.parametrize(
    "words",
    [
        "Yes and no",
        "yes or no",
        "",
        "   ",
        "Maybe",
        "I cannot answer that.",
        "The plate is clean.",
        "Yes, but I can't tell for sure.",
        "Nope",
        "yesterday",
        "J̷̛a̶",
        "<think>It says yes",
    ],
)
def test_what_is_not_clearly_yes_or_no_is_unknown(words: str) -> None:
    with ChatServer(says(words)) as server:
        (answer,) = ask(server, "Is the plate clean?")
    assert answer.reply is Reply.UNKNOWN
    assert answer.p_yes is None
    assert answer.agrees is None


@pytest.mark.parametrize(
    "body",
    [
        '{"choices": [',
        "",
        "null",
        "[]",
        "{}",
        '{"choices": []}',
        '{"choices": [{"message": {"content": 7}}]}',
        '{"choices": [{"message": null}]}',
        '{"choices": "yes"}',
        b"\xff\xfe\x00yes",
        "[" * 5000,
    ],
)
def test_a_garbled_body_is_unknown(body: str | bytes) -> None:
    with ChatServer(scripted, script=always(Act(body=body))) as server:
        (answer,) = ask(server, "Is the plate clean?")
    assert answer.reply is Reply.UNKNOWN
    assert answer.text


def test_a_refusal_that_cannot_be_decoded_is_unknown() -> None:
    act = Act(400, body="[" * 100_000)
    with ChatServer(scripted, script=always(act)) as server:
        (answer,) = ask(server, "Is the plate clean?")
    assert answer.reply is Reply.UNKNOWN
    assert answer.p_yes is None


@pytest.mark.parametrize(
    "logprobs",
    [
        "yes",
        {"content": None},
        {"content": []},
        {"content": [{"token": "Yes"}]},
        {"content": [{"token": "Ye", "logprob": -0.1, "top_logprobs": []}]},
    ],
)
def test_broken_logprobs_do_not_cost_a_clear_word(logprobs: object) -> None:
    body = completion("Yes", logprobs=False)
    body["choices"][0]["logprobs"] = logprobs
    with ChatServer(scripted, script=always(Act(body=body))) as server:
        (answer,) = ask(server, "Is the plate clean?")
    assert (answer.reply, answer.source, answer.p_yes) == (Reply.YES, "word", None)


def test_a_first_token_that_mostly_wants_something_else_is_unknown() -> None:
    body = completion("Yes", logprobs=False)
    top = [{"token": "Yes", "logprob": -1.6}, {"token": "The", "logprob": -1.7}]
    body["choices"][0]["logprobs"] = {"content": [{**top[0], "top_logprobs": top}]}
    with ChatServer(scripted, script=always(Act(body=body))) as server:
        (answer,) = ask(server, "Is the plate clean?")
    assert answer.reply is Reply.UNKNOWN
    assert answer.leftover == pytest.approx(1 - 0.2019, abs=1e-3)


def picky(request: Request, _before: int) -> Act | None:
    """Complains as OpenAI's reasoning models do, of one parameter at a time."""
    body = request.body
    if "max_tokens" in body:
        return refusal(
            400,
            "Unsupported parameter: 'max_tokens' is not supported with this model. "
            "Use 'max_completion_tokens' instead.",
            param="max_tokens",
            code="unsupported_parameter",
        )
    if "logprobs" in body:
        return refusal(403, "You are not allowed to request logprobs from this model")
    if "temperature" in body:
        return refusal(400, "Only the default is supported", param="temperature")
    if body.get("max_completion_tokens", 0) < 100:
        empty = completion("", logprobs=False)
        empty["choices"][0]["finish_reason"] = "length"
        return Act(body=empty)
    return None


def test_a_reasoning_model_is_asked_as_it_wants_and_only_found_out_once() -> None:
    with ChatServer(scripted, script=picky) as server:
        vlm = OpenAICompatibleVLM("test", base_url=server.url)
        (first,) = vlm.ask(look(0), questions("Is the plate clean?"))
        found_out = len(server.requests)
        vlm.ask(look(1), questions("Is the plate clean?", "Is the fridge open?"))
        vlm.close()
    assert (first.reply, first.source) == (Reply.YES, "word")
    assert len(server.requests) == found_out + 2


@pytest.mark.parametrize(
    "complaint",
    [
        "top_logprobs must be less than or equal to 5",
        "Cannot request more than 5 logprobs.",
        "20 is greater than the maximum of 5 - 'logprobs'",
    ],
)
def test_fewer_alternatives_are_asked_for_where_the_server_limits_them(complaint: str) -> None:
    def limited(request: Request, _before: int) -> Act | None:
        if request.body.get("top_logprobs", 0) > 5:
            return refusal(400, complaint)
        return None

    with ChatServer(scripted, script=limited) as server:
        (answer,) = ask(server, "Is the plate clean?")
    assert answer.source == "logprobs"
    assert server.requests[-1].body["top_logprobs"] == 5


def test_a_refusal_without_a_reason_leads_to_the_bare_request() -> None:
    with ChatServer(
        scripted, script=lambda r, _: Act(422, "no") if "temperature" in r.body else None
    ) as server:
        (answer,) = ask(server, "Is the plate clean?")
    assert answer.reply is Reply.YES
    assert set(server.requests[-1].body) == {"model", "messages"}


def test_a_filtered_picture_is_unknown() -> None:
    act = refusal(400, "The picture was filtered", code="content_filter")
    with ChatServer(scripted, script=always(act)) as server:
        (answer,) = ask(server, "Is the plate clean?")
    assert answer.reply is Reply.UNKNOWN
    assert "filtered" in answer.text


@pytest.mark.parametrize(
    ("act", "remedy"),
    [
        (Act(401, {"error": {"message": "Incorrect API key sk-12345"}}), "OPENAI_API_KEY"),
        (Act(404, {"error": {"message": "The model `test` does not exist"}}), "does not exist"),
        (refusal(404, "It has 'a'.", param="model", code="gone"), "has 'a', model, gone, invalid"),
        (Act(400, {"error": {"message": "image input is not supported"}}), "take pictures"),
        (Act(500, {"error": {"message": "image input is not supported"}}), "take pictures"),
        (
            Act(429, {"error": {"message": "You exceeded", "code": "insufficient_quota"}}),
            "credit",
        ),
        (Act(200, "<!doctype html>", {"Content-Type": "text/html"}), "web page"),
    ],
    ids=[
        "key",
        "model",
        "model, with its code",
        "blind",
        "blind, as llama.cpp says it",
        "quota",
        "web page",
    ],
)
def test_what_no_retry_mends_is_an_error_with_its_remedy(act: Act, remedy: str) -> None:
    with ChatServer(scripted, script=always(act)) as server:
        with pytest.raises(AnswerError, match=remedy) as caught:
            ask(server, "Is the plate clean?", "Is the fridge open?")
        assert server.url in str(caught.value)
        assert "sk-12345" not in str(caught.value)


def test_nothing_at_the_address_is_an_error_with_the_address() -> None:
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        url = f"http://127.0.0.1:{unused.getsockname()[1]}/v1"
        vlm = OpenAICompatibleVLM("test", base_url=url, retries=1)
        with pytest.raises(AnswerError, match="cannot be reached") as caught:
            vlm.ask(look(), questions("Is the plate clean?"))
        vlm.close()
    assert url in str(caught.value)


def test_a_wrong_path_is_an_error() -> None:
    with ChatServer(scripted) as server:
        vlm = OpenAICompatibleVLM("test", base_url=server.url.removesuffix("/v1"))
        with pytest.raises(AnswerError, match="/v1"):
            vlm.ask(look(), questions("Is the plate clean?"))
        vlm.close()


def test_an_address_without_a_scheme_is_an_error() -> None:
    with pytest.raises(AnswerError, match="http://"):
        OpenAICompatibleVLM("test", base_url="localhost:8000/v1")


def test_openai_itself_needs_a_key() -> None:
    with pytest.raises(AnswerError, match="OPENAI_API_KEY"):
        OpenAICompatibleVLM("test").ask(look(), questions("Is the plate clean?"))


def test_the_key_comes_from_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", " secret\n")
    with ChatServer(scripted) as server:
        ask(server, "Is the plate clean?")
    assert server.requests[0].authorization == "Bearer secret"


def test_a_world_without_pictures_is_an_error() -> None:
    with pytest.raises(AnswerError, match="pictures"):
        OpenAICompatibleVLM("test", base_url="http://127.0.0.1:1/v1").ask(
            Observation(look=0, time=0.0), questions("Is the plate clean?")
        )


def test_it_can_be_asked_where_an_event_loop_runs_already() -> None:
    async def inside() -> list[Answer]:
        return ask(server, "Is the plate clean?")

    with ChatServer(scripted) as server:
        assert asyncio.run(inside())[0].reply is Reply.YES


def test_it_can_be_used_again_after_closing() -> None:
    with ChatServer(scripted) as server:
        vlm = OpenAICompatibleVLM("test", base_url=server.url)
        for number in range(2):
            assert vlm.ask(look(number), questions("Is the plate clean?"))[0].reply is Reply.YES
            vlm.close()
            vlm.close()


def test_a_forked_child_connects_anew() -> None:
    with ChatServer(scripted) as server:
        vlm = OpenAICompatibleVLM("test", base_url=server.url)
        assert vlm.ask(look(0), questions("Is the plate clean?"))[0].reply is Reply.YES

        def child() -> None:
            assert vlm.ask(look(1), questions("Is the fridge open?"))[0].reply is Reply.NO
            vlm.close()

        process = multiprocessing.get_context("fork").Process(target=child, daemon=True)
        process.start()
        process.join(30)
        assert process.exitcode == 0
        assert vlm.ask(look(2), questions("Is the plate clean?"))[0].reply is Reply.YES
        vlm.close()


NEVER_CLOSE = """
import sys
from tests.vlm.test_openai_compatible import look, questions
from tpvqa.vlm.openai_compatible import OpenAICompatibleVLM
vlm = OpenAICompatibleVLM("test", base_url=sys.argv[1])
print(vlm.ask(look(), questions("Is the plate clean?"))[0].reply)
"""


def test_a_process_that_never_closes_it_ends_all_the_same() -> None:
    with ChatServer(scripted) as server:
        done = subprocess.run(
            [sys.executable, "-c", NEVER_CLOSE, server.url],
            cwd=Path(__file__).parents[2],
            capture_output=True,
            text=True,
            timeout=60,
        )
    assert (done.stdout, done.stderr, done.returncode) == ("yes\n", "", 0)


def test_it_is_made_from_a_specification_whose_model_has_colons() -> None:
    vlm = make(Kind.VLM, "openai:llama3.2-vision:11b", base_url="http://127.0.0.1:1/v1")
    assert isinstance(vlm, VLM)
    assert vlm.name == "openai:llama3.2-vision:11b"
    with pytest.raises(PluginError, match="openai:MODEL"):
        make(Kind.VLM, "openai")


def test_without_the_package_it_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda _name: None)
    with pytest.raises(MissingExtraError, match=r"pip install -e 'packages/tpvqa\[openai\]'"):
        OpenAICompatibleVLM("test", base_url="http://127.0.0.1:1/v1")


ASK_SLOWLY = """
import sys
from tests.vlm.test_openai_compatible import look, questions
from tpvqa.vlm.openai_compatible import OpenAICompatibleVLM
vlm = OpenAICompatibleVLM("test", base_url=sys.argv[1])
try:
    vlm.ask(look(), questions("Is the plate clean?"))
except KeyboardInterrupt:
    vlm.close()
    print("interrupted")
"""


def test_an_interrupt_ends_waiting_at_once() -> None:
    with ChatServer(scripted, script=always(Act(wait=60.0))) as server:
        asking = subprocess.Popen(
            [sys.executable, "-c", ASK_SLOWLY, server.url],
            cwd=Path(__file__).parents[2],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        while not server.requests:
            assert asking.poll() is None
            time.sleep(0.01)
        asking.send_signal(signal.SIGINT)
        # The server would answer after 60 seconds.
        out, err = asking.communicate(timeout=40)
    assert (out, err) == ("interrupted\n", "")
