"""The images API over real HTTP, with the faults that real servers have."""

import base64
import time
from collections.abc import Iterator
from io import BytesIO
from itertools import pairwise

import pytest
from PIL import Image

from tests.household.images.sources.images_server import Act, ImagesServer, Script, picture, refusal
from tpvqa.errors import GeneratorError, PictureRefused
from tpvqa_household.images.sources.generator import Original
from tpvqa_household.images.sources.openai_images import OpenAIImages

ORIGINAL = Original(picture(200), "the same kitchen in other light")


@pytest.fixture(autouse=True)
def key(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", "sk-secret")
    monkeypatch.delenv("OPENAI_BASE_URL", raising=False)


@pytest.fixture
def server() -> Iterator[ImagesServer]:
    with ImagesServer() as running:
        yield running


def first(*acts: Act) -> Script:
    """The first requests are met so, the following with pictures."""
    return lambda before: acts[before] if before < len(acts) else None


def garbled(text: str) -> Act:
    return Act(body={"data": [{"b64_json": text}]})


def test_a_picture_from_a_prompt(server: ImagesServer) -> None:
    images = OpenAIImages("gpt-image-1", base_url=server.url, size="1024x1024")
    assert images.generate("a red apple", seed=1).data == picture(0)
    (request,) = server.requests
    assert request.path == "generations"
    wanted = {"model": "gpt-image-1", "prompt": "a red apple", "n": 1, "size": "1024x1024"}
    assert request.form == wanted
    assert request.headers["authorization"] == "Bearer sk-secret"


def test_dall_e_2_varies_without_words_and_others_edit_with_a_prompt(server: ImagesServer) -> None:
    OpenAIImages("dall-e-2", base_url=server.url).vary(ORIGINAL, seed=1)
    OpenAIImages("gpt-image-1", base_url=server.url).vary(ORIGINAL, seed=1)
    variation, edit = server.requests
    assert (variation.path, edit.path) == ("variations", "edits")
    assert "prompt" not in variation.form
    assert variation.form["response_format"] == "b64_json"
    assert edit.form["prompt"] == ORIGINAL.prompt
    assert "response_format" not in edit.form
    with Image.open(BytesIO(edit.form["image"])) as sent:
        assert sent.format == "PNG"
        assert sent.size == (512, 512)


def test_a_reply_may_say_where_the_picture_lies(server: ImagesServer) -> None:
    server.by_url, server.lost = True, 1
    images = OpenAIImages("some", base_url=server.url)
    assert images.generate("a plate", seed=1).data == picture(0)
    assert len(server.requests) == 1, "what was made is fetched again, not made again"
    assert len(server.fetched) == 2
    assert "authorization" not in server.fetched[0].headers


def test_a_busy_server_is_given_the_time_that_it_asks_for() -> None:
    script = first(refusal(429, "slow down", Retry_After="0.4"), Act(500, "oops"))
    with ImagesServer(script=script) as server:
        images = OpenAIImages("some", base_url=server.url)
        assert images.generate("a plate", seed=1).data == picture(2)
        one, two, three = server.requests
        assert two.at - one.at >= 0.4
        assert images.requests == 3
        keys = {request.headers["idempotency-key"] for request in (one, two, three)}
        assert len(keys) == 1, "a server that knows the header makes the picture once"
        images.generate("a plate", seed=2)
        assert server.requests[-1].headers["idempotency-key"] not in keys


def test_a_wait_beyond_the_deadline_is_not_begun() -> None:
    with ImagesServer(script=lambda _: refusal(429, "later", Retry_After="3600")) as server:
        started = time.monotonic()
        with pytest.raises(GeneratorError, match=r"later.*3600.0 s would be later than"):
            OpenAIImages("some", base_url=server.url).generate("a plate", seed=1)
        assert time.monotonic() - started < 5


@pytest.mark.parametrize(
    "fault",
    [
        garbled("####"),
        garbled(base64.b64encode(b"no picture").decode()),
        garbled(base64.b64encode(picture(1, side=256)[:-80]).decode()),
        Act(body={"data": []}),
        Act(body="<html>"),
    ],
    ids=["base64", "no picture", "half a picture", "none", "not JSON"],
)
def test_garbled_replies_are_asked_for_again(fault: Act) -> None:
    with ImagesServer(script=first(fault)) as server:
        images = OpenAIImages("some", base_url=server.url)
        assert images.generate("a plate", seed=1).data == picture(1)
        one, two = (request.headers["idempotency-key"] for request in server.requests)
        assert one != two, "otherwise a server could give the same again"
    with ImagesServer(script=lambda _: fault) as server:
        images = OpenAIImages("some", base_url=server.url, retries=1)
        with pytest.raises(GeneratorError, match="2 times"):
            images.generate("a plate", seed=1)
        assert len(server.requests) == 2


def test_a_slow_server_is_not_waited_for_for_ever() -> None:
    with ImagesServer(script=first(Act(wait=1.5))) as server:
        images = OpenAIImages("some", base_url=server.url, request_timeout=0.4)
        assert images.generate("a plate", seed=1).data == picture(1)


def test_a_server_that_says_a_little_for_ever_is_late() -> None:
    with ImagesServer(script=first(Act(endless=b" "))) as server:
        images = OpenAIImages("some", base_url=server.url, request_timeout=0.5)
        assert images.generate("a plate", seed=1).data == picture(1)


def test_a_picture_that_comes_for_ever_is_late(server: ImagesServer) -> None:
    server.by_url, server.endless_picture = True, b"x"
    images = OpenAIImages("some", base_url=server.url, request_timeout=0.5, retries=1)
    with pytest.raises(GeneratorError, match=r"not whole within 0\.5 s, 2 times"):
        images.generate("a plate", seed=1)


@pytest.mark.parametrize("by_url", [False, True])
def test_no_more_is_read_than_a_picture_may_have(by_url: bool) -> None:
    endless = b"A" * 2**24
    script = first() if by_url else lambda _: Act(endless=endless)
    with ImagesServer(script=script, by_url=by_url) as server:
        server.endless_picture = endless
        images = OpenAIImages("some", base_url=server.url, retries=0)
        with pytest.raises(GeneratorError, match="more than 64 MiB"):
            images.generate("a plate", seed=1)


def test_a_reply_that_is_compressed_is_not_unpacked() -> None:
    script = first(Act(body="{}", headers={"Content-Encoding": "gzip"}))
    with ImagesServer(script=script) as server:
        images = OpenAIImages("some", base_url=server.url)
        assert images.generate("a plate", seed=1).data == picture(1)


def test_a_complaint_nested_too_deeply_is_told_as_it_came() -> None:
    deep = Act(400, "[" * 100_000)
    with (
        ImagesServer(script=lambda _: deep) as server,
        pytest.raises(GeneratorError, match=r"refuses to be asked.*\[\[\["),
    ):
        OpenAIImages("some", base_url=server.url).generate("a plate", seed=1)


@pytest.mark.parametrize(
    ("act", "said"),
    [
        (refusal(401, "wrong key"), "refuses the key"),
        (refusal(404, "no such model"), "no model 'some'"),
        (refusal(429, "pay first", code="insufficient_quota"), "no credit"),
        (refusal(400, "unknown size"), "unknown size"),
    ],
)
def test_what_no_repetition_helps_ends_at_once(act: Act, said: str) -> None:
    with ImagesServer(script=lambda _: act) as server:
        with pytest.raises(GeneratorError, match=said) as raised:
            OpenAIImages("some", base_url=server.url).generate("a plate", seed=1)
        assert not isinstance(raised.value, PictureRefused)
        assert "sk-secret" not in str(raised.value)
        assert len(server.requests) == 1


def test_a_refused_picture_is_told_from_a_refused_key() -> None:
    act = refusal(400, "a knife", code="content_policy_violation")
    with ImagesServer(script=lambda _: act) as server, pytest.raises(PictureRefused, match="knife"):
        OpenAIImages("some", base_url=server.url).generate("a knife", seed=1)


def test_requests_keep_their_distance(server: ImagesServer) -> None:
    images = OpenAIImages("some", base_url=server.url, per_minute=150)
    for seed in range(3):
        images.generate("a plate", seed=seed)
    times = [request.at for request in server.requests]
    assert min(b - a for a, b in pairwise(times)) > 0.35


def test_nothing_answers() -> None:
    with pytest.raises(GeneratorError, match="no connection"):
        OpenAIImages("some", base_url="http://127.0.0.1:9/v1", retries=0).generate("x", seed=1)


def test_openai_needs_a_key(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("OPENAI_API_KEY")
    with pytest.raises(GeneratorError, match="OPENAI_API_KEY"):
        OpenAIImages("dall-e-2").generate("a plate", seed=1)
    monkeypatch.setenv("OPENAI_API_KEY", "sk-\x1bsecret")
    with pytest.raises(GeneratorError, match="OPENAI_API_KEY has characters"):
        OpenAIImages("dall-e-2").generate("a plate", seed=1)
    with pytest.raises(GeneratorError, match="http://"):
        OpenAIImages("dall-e-2", base_url="localhost:8000")
