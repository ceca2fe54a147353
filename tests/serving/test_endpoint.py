"""The endpoint over real HTTP: what it says, what it refuses, what it takes together."""

import http.client
import json
import os
import socket
import threading
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any
from urllib.parse import urlsplit

import pytest

from tests.serving.running import INSTRUCTION, Known, body, call, complete, picture, running
from tpvqa.errors import AnswerError, PluginError, TpvqaError
from tpvqa.observation import Observation
from tpvqa.questions import Question
from tpvqa.serving.app import Limits
from tpvqa.serving.door import TOKEN, is_loopback, token_for
from tpvqa.serving.server import Serving
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.capabilities import SideBySide

TABLE: dict[str, float | Reply] = {
    "Is the fridge open?": 0.9,
    "Is the plate clean?": 0.25,
    "Is it dark?": Reply.CANNOT_SEE,
}
FRIDGE = body(f"Is the fridge open? {INSTRUCTION}", picture())
KEY = "a-token-of-enough-letters"


def eventually(holds: Any, seconds: float = 10) -> None:
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.01)


def test_a_completion_has_the_shape_of_openais() -> None:
    with running(Known(TABLE)) as serving:
        said = complete(serving, {**FRIDGE, "logprobs": True, "top_logprobs": 2, "n": 2})
    assert said.status == 200
    assert said.headers["content-type"] == "application/json"
    reply = said.json
    assert (reply["object"], reply["model"]) == ("chat.completion", "known")
    assert [choice["index"] for choice in reply["choices"]] == [0, 1]
    for choice in reply["choices"]:
        assert choice["message"] == {"role": "assistant", "content": "yes", "refusal": None}
        assert choice["finish_reason"] == "stop"
        (token,) = choice["logprobs"]["content"]
        assert [each["token"] for each in token["top_logprobs"]] == ["yes", "no"]
    assert reply["usage"]["completion_tokens"] == 2


def test_models_and_health() -> None:
    with running(Known(TABLE), model="mine") as serving:
        models = call(serving, "GET", "/v1/models").json
        assert [each["id"] for each in models["data"]] == ["mine"]
        assert call(serving, "GET", "/v1/models/mine").json["object"] == "model"
        assert call(serving, "GET", "/v1/models/other").error["code"] == "model_not_found"
        health = call(serving, "GET", "/health")
        assert health.json == {"status": "ok", "model": "mine", "waiting": 0}
        wrong = complete(serving, {**FRIDGE, "model": "gpt-4o"})
        assert (wrong.status, wrong.error["code"]) == (404, "model_not_found")
        assert "'mine'" in wrong.error["message"]


def test_questions_that_are_not_known_are_answered_with_unknown() -> None:
    with running(Known(TABLE)) as serving:
        for question, word in (("Is it raining?", "unknown"), ("Is it dark?", "cannot see")):
            said = complete(serving, body(question, picture(), logprobs=True, top_logprobs=20))
            assert said.word == word
            assert said.json["choices"][0]["message"]["refusal"] == "so says the table"


def test_a_black_picture_shows_nothing() -> None:
    black = bytes.fromhex(  # a PNG of 1 × 1
        "89504e470d0a1a0a0000000d49484452000000010000000108000000003a7e9b55"
        "0000000a49444154789c6360000000020001e221bc330000000049454e44ae426082"
    )
    vlm = Known(TABLE)
    with running(vlm) as serving:
        said = complete(serving, body("Is the fridge open?", black))
    assert said.word == "cannot see"
    assert "black" in said.json["choices"][0]["message"]["refusal"]
    assert vlm.calls == []


def _message(*parts: dict[str, Any]) -> dict[str, Any]:
    return {"model": "known", "messages": [{"role": "user", "content": list(parts)}]}


TEXT = {"type": "text", "text": "Is the fridge open?"}


def _picture_at(url: str) -> dict[str, Any]:
    return _message({"type": "image_url", "image_url": {"url": url}}, TEXT)


FRIDGE_URL = FRIDGE["messages"][0]["content"][0]["image_url"]["url"]
REFUSED: dict[str, tuple[Any, str]] = {
    "no JSON": (b"{", "JSON"),
    "no body": (b"", "JSON"),
    "not text": (b"\xff\xfe\x00", "JSON"),
    "no model": ({"messages": FRIDGE["messages"]}, "model"),
    "no messages": ({"model": "known", "messages": []}, "messages"),
    "nested": (b"[" * 100_000, "JSON"),
    "last is the model's": (
        {**FRIDGE, "messages": [{"role": "assistant", "content": "yes"}]},
        "user",
    ),
    "a picture elsewhere": (_picture_at("https://example.com/a.jpg"), "Nothing is fetched"),
    "a file": (_picture_at("file:///etc/passwd"), "Nothing is fetched"),
    "a path": (_picture_at("/etc/passwd"), "Base64"),
    "not Base64": (_picture_at("data:image/jpeg;base64,%%%"), "clean Base64"),
    "no picture": (_picture_at("data:image/jpeg;base64,aGVsbG8="), "not a JPEG, PNG or WebP"),
    "no pictures": (_message(TEXT), "no picture"),
    "no text": (body("", picture()), "asks nothing"),
    "a long text": (body("Is it? " * 2000, picture()), "characters"),
    "many pictures": (body("Is the fridge open?", *map(picture, range(9))), "8 are taken"),
    "sound": (_message({"type": "input_audio"}), "input_audio"),
    "top_logprobs alone": ({**FRIDGE, "top_logprobs": 5}, "logprobs"),
    "too many logprobs": ({**FRIDGE, "logprobs": True, "top_logprobs": 21}, "20"),
    "too many choices": ({**FRIDGE, "n": 17}, "16"),
    "no tokens": ({**FRIDGE, "max_tokens": 0}, "max_tokens"),
    "too hot": ({**FRIDGE, "temperature": 3}, "temperature"),
    "a yes for a number": ({**FRIDGE, "n": True}, "n: true and false are no numbers"),
    "a no for a seed": ({**FRIDGE, "seed": False}, "seed"),
    "a name twice": (
        json.dumps(FRIDGE).replace('"model"', '"model": "other", "model"').encode(),
        "'model' is given twice",
    ),
    "a drawing": (
        _picture_at(FRIDGE_URL.replace("image/jpeg", "image/svg+xml")),
        "is said to be image/svg+xml",
    ),
    "JSON of no form": ({**FRIDGE, "response_format": {"type": "json_object"}}, "response_format"),
}


def test_what_is_no_request_is_refused_with_a_reason_and_the_server_goes_on() -> None:
    vlm = Known(TABLE)
    with running(vlm) as serving:
        for name, (sent, reason) in REFUSED.items():
            said = complete(serving, sent)
            assert said.status == 400, name
            assert said.error["type"] == "invalid_request_error", name
            assert reason in f"{said.error['message']} {said.error['param']}", name
        assert vlm.calls == []
        assert complete(serving, FRIDGE).word == "yes"


def test_other_places_and_methods_are_refused_in_the_same_form() -> None:
    with running(Known(TABLE)) as serving:
        assert call(serving, "GET", "/v1/completions").error["code"] == "not_found"
        assert call(serving, "GET", "/v1/chat/completions").status == 405
        assert call(serving, "POST", "/v1/embeddings", {}).error["code"] == "not_found"
        assert call(serving, "GET", "/docs").status == 404


def test_what_a_client_says_beside_the_question_is_let_pass() -> None:
    with running(Known(TABLE)) as serving:
        earlier = [
            {"role": "system", "content": "You are a robot's eyes."},
            {"role": "user", "content": "Is the plate clean?"},
            {"role": "assistant", "content": None, "tool_calls": []},
        ]
        sent = {**FRIDGE, "messages": earlier + FRIDGE["messages"], "user": "me", "stop": ["."]}
        more = {"max_completion_tokens": 1, "temperature": 0, "seed": 3, "top_p": 1}
        assert complete(serving, {**sent, **more}).word == "yes"


def test_samples_are_drawn_by_a_seed() -> None:
    with running(Known({"Is it so?": 0.5})) as serving:
        sent = body("Is it so?", picture(), n=16, temperature=1.0, seed=7)

        def words(asked: dict[str, Any]) -> list[str]:
            choices = complete(serving, asked).json["choices"]
            return [choice["message"]["content"] for choice in choices]

        first = words(sent)
        assert set(first) == {"yes", "no"}
        assert words(sent) == first
        assert words({**sent, "seed": 8}) != first


def test_a_request_that_is_too_large_hears_so() -> None:
    with running(Known(TABLE), limits=Limits(body=20_000)) as serving:
        said = complete(serving, b" " * 30_000)
        assert (said.status, said.error["code"]) == (413, "request_too_large")
        place = urlsplit(serving.address)
        connection = http.client.HTTPConnection(place.hostname or "", place.port, timeout=20)
        parts = (b" " * 1_000 for _ in range(30))
        kind = {"Content-Type": "application/json"}
        connection.request("POST", "/v1/chat/completions", parts, kind, encode_chunked=True)
        assert connection.getresponse().status == 413
        connection.close()
        assert complete(serving, FRIDGE).word == "yes"


def test_a_request_that_says_how_large_it_is_hears_so_at_once() -> None:
    with running(Known(TABLE), limits=Limits(body=20_000, sending=2)) as serving:
        place = urlsplit(serving.address)
        with socket.create_connection((place.hostname or "", place.port or 0), 1) as slow:
            slow.sendall(
                b"POST /v1/chat/completions HTTP/1.1\r\nHost: localhost\r\n"
                b"Content-Type: application/json\r\nContent-Length: 20001\r\n\r\n{"
            )
            assert slow.recv(1000).split()[1] == b"413"  # nothing more has been sent
            slow.sendall(b" " * 20_000)
        assert complete(serving, FRIDGE).word == "yes"


@pytest.mark.parametrize("token", [None, "a-token-for-the-tests"])
def test_a_body_that_is_packed_is_refused(token: str | None) -> None:
    known = {} if token is None else {"Authorization": f"Bearer {token}"}
    with running(Known(TABLE), token=token) as serving:
        packed = complete(serving, b"packed", **known, **{"Content-Encoding": "gzip"})
        assert (packed.status, packed.error["code"]) == (415, "unsupported_coding")
        plain = complete(serving, FRIDGE, **known, **{"Content-Encoding": "identity"})
        assert plain.word == "yes"


def test_a_request_that_does_not_come_in_is_ended() -> None:
    with running(Known(TABLE), limits=Limits(sending=0.2)) as serving:
        place = urlsplit(serving.address)
        with socket.create_connection((place.hostname or "", place.port or 0), 10) as slow:
            slow.sendall(
                b"POST /v1/chat/completions HTTP/1.1\r\nHost: localhost\r\n"
                b"Content-Type: application/json\r\nContent-Length: 1000\r\n\r\n{"
            )
            assert b"408" in slow.recv(4096).partition(b"\r\n")[0]
        assert complete(serving, FRIDGE).word == "yes"


def test_memory_of_requests_is_bounded() -> None:
    vlm = Known(TABLE)
    size = len(json.dumps(FRIDGE))
    limits = Limits(bodies=size + size // 2)
    with running(vlm, limits=limits) as serving, ThreadPoolExecutor() as pool:
        vlm.free.clear()
        first = pool.submit(complete, serving, FRIDGE)
        assert vlm.asked.wait(10)
        second = complete(serving, FRIDGE)
        assert (second.status, second.headers["retry-after"]) == (503, "1")
        vlm.free.set()
        assert first.result().word == "yes"
        assert complete(serving, FRIDGE).word == "yes"


def test_what_waits_is_taken_together() -> None:
    """While one picture is looked at, all that comes in about a second one is one call."""
    vlm = Known(TABLE)
    with running(vlm) as serving, ThreadPoolExecutor(20) as pool:
        vlm.free.clear()
        first = pool.submit(complete, serving, FRIDGE)
        assert vlm.asked.wait(10)
        texts = [*TABLE, *TABLE, "Is it raining?"]
        rest = [pool.submit(complete, serving, body(text, picture(1))) for text in texts]
        as_png = pool.submit(complete, serving, body("Is it dark?", picture(1, "PNG")))
        eventually(lambda: call(serving, "GET", "/health").json["waiting"] == len(texts) + 2)
        vlm.free.set()
        words = [each.result().word for each in rest]
        assert first.result().word == "yes"
        assert as_png.result().word == "cannot see"
    assert words == ["yes", "no", "cannot see"] * 2 + ["unknown"]
    calls = {pictures: set(asked) for pictures, asked in vlm.calls}
    assert len(vlm.calls) == len(calls) == 3
    assert calls[picture(1),] == set(texts)
    assert len(max(vlm.calls, key=lambda each: len(each[1]))[1]) == len(set(texts))


def test_too_many_are_told_to_come_back() -> None:
    vlm = Known(TABLE)
    with running(vlm, limits=Limits(waiting=2)) as serving, ThreadPoolExecutor() as pool:
        vlm.free.clear()
        waiting = [pool.submit(complete, serving, FRIDGE) for _ in range(2)]
        eventually(lambda: call(serving, "GET", "/health").json["waiting"] == 2)
        third = complete(serving, FRIDGE)
        assert (third.status, third.error["type"]) == (429, "rate_limit_error")
        assert int(third.headers["retry-after"]) >= 1
        vlm.free.set()
        assert [each.result().word for each in waiting] == ["yes", "yes"]


def test_who_has_no_more_time_is_told_and_who_went_away_is_forgotten() -> None:
    vlm = Known(TABLE)
    with running(vlm, limits=Limits(patience=0.3)) as serving, ThreadPoolExecutor() as pool:
        vlm.free.clear()
        first = pool.submit(complete, serving, FRIDGE)
        assert vlm.asked.wait(10)
        with pytest.raises(TimeoutError):
            call(
                serving,
                "POST",
                "/v1/chat/completions",
                body("Is it dark?", picture(1)),
                timeout=0.1,
            )
        late = first.result()
        assert (late.status, late.error["code"]) == (503, "late")
        assert int(late.headers["retry-after"]) >= 1
        eventually(lambda: serving.counts.given_up == 2)
        vlm.free.set()
        assert complete(serving, FRIDGE).word == "yes"
    assert [asked for _, asked in vlm.calls] == [("Is the fridge open?",)] * 2


def _told(error: Exception) -> Exception:
    """As a plug-in raises it that says itself what went wrong below it."""
    error.__cause__ = OSError("secret")
    return error


@pytest.mark.parametrize(
    ("error", "code", "said"),
    [
        (AnswerError("The key is refused."), "vlm_failed", "The key is refused."),
        (_told(PluginError("My server is off.")), "vlm_failed", "My server is off."),
        (ZeroDivisionError("secret"), "vlm_broke", "ZeroDivisionError"),
    ],
)
def test_a_vlm_that_breaks_is_an_error_of_the_request(
    error: Exception, code: str, said: str, capfd: pytest.CaptureFixture[str]
) -> None:
    vlm = Known(TABLE)
    with running(vlm) as serving:
        vlm.breaks = error
        broken = complete(serving, FRIDGE)
        assert (broken.status, broken.error["code"]) == (500, code)
        assert said in broken.error["message"]
        assert "secret" not in broken.text
        vlm.breaks = None
        assert complete(serving, FRIDGE).word == "yes"
    assert ("ZeroDivisionError: secret" in capfd.readouterr().err) == (code == "vlm_broke")


class Shuffled(Known):
    """Answers as many questions as were asked, in another order."""

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        return super().ask(observation, questions)[::-1]


def test_answers_in_another_order_are_nobodys_answers() -> None:
    vlm = Shuffled(TABLE)
    with running(vlm) as serving, ThreadPoolExecutor() as pool:
        vlm.free.clear()
        first = pool.submit(complete, serving, FRIDGE)
        assert vlm.asked.wait(10)
        rest = [pool.submit(complete, serving, body(text, picture())) for text in TABLE]
        eventually(lambda: call(serving, "GET", "/health").json["waiting"] == 4)
        vlm.free.set()
        assert first.result().word == "yes"
        for each in rest:
            assert (each.result().status, each.result().error["code"]) == (500, "vlm_failed")


def test_a_token_is_asked_for_and_never_told(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(TOKEN, KEY)
    token = token_for("127.0.0.1")
    with running(Known(TABLE), token=token) as serving:
        for given in ("", f"Bearer {KEY}x", f"Bearer {KEY[:-1]}", KEY, f"Basic {KEY}", "Bearer é"):
            refused = complete(serving, FRIDGE, Authorization=given)
            assert (refused.status, refused.error["code"]) == (401, "invalid_api_key")
            assert refused.headers["www-authenticate"] == "Bearer"
            assert (
                call(serving, "GET", "/v1/models", headers={"Authorization": given}).status == 401
            )
            assert KEY not in refused.text
        assert complete(serving, FRIDGE, Authorization=f"Bearer {KEY}").word == "yes"
        elsewhere = {"Authorization": f"Bearer {KEY}", "Host": "robot.example"}
        assert complete(serving, FRIDGE, **elsewhere).word == "yes"
        assert call(serving, "GET", "/health").status == 200
    said = capfd.readouterr()
    assert KEY not in said.out + said.err


def test_without_a_token_the_server_is_called_by_a_name_of_loopback() -> None:
    """So a page in the browser cannot reach it under the page's own name."""
    with running(Known(TABLE)) as serving:
        for host in ("evil.example", "evil.example:80", "127.0.0.1.evil.example", "[::1", ""):
            for path in ("/health", "/v1/models"):
                refused = call(serving, "GET", path, headers={"Host": host})
                assert refused.status in (400, 403), host
        for host in ("localhost:1", "127.0.0.1", "[::1]:8000"):
            assert call(serving, "GET", "/health", headers={"Host": host}).status == 200


def test_other_hosts_need_a_token(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    monkeypatch.delenv(TOKEN, raising=False)
    assert [is_loopback(host) for host in ("127.0.0.1", "127.9.9.9", "::1", "localhost")] == [
        True
    ] * 4
    for host in ("0.0.0.0", "::", "192.168.0.7", "robot.example", ""):
        assert not is_loopback(host)
        with pytest.raises(TpvqaError, match=TOKEN):
            token_for(host)
        with pytest.raises(TpvqaError, match="token"):
            Serving(Known(TABLE), host=host, port=0)
    for weak in ("short", "with blanks in it all", "ünïcode-ünïcode-ünïcode"):
        file = tmp_path / "token"
        file.write_text(weak)
        with pytest.raises(TpvqaError, match="at least 16"):
            token_for("127.0.0.1", file)
        monkeypatch.setenv(TOKEN, weak)
        with pytest.raises(TpvqaError, match="at least 16") as refused:
            token_for("0.0.0.0")
        assert weak not in str(refused.value)
    (tmp_path / "token").write_text(f"{KEY}\n")
    assert token_for("0.0.0.0", tmp_path / "token") == KEY
    with pytest.raises(TpvqaError, match="no such token file"):
        token_for("0.0.0.0", tmp_path / "none")


def test_a_port_that_is_taken_and_a_host_that_is_not_known() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(TpvqaError, match=f"Port {port}.*--port"):
            Serving(Known(TABLE), port=port)
    with pytest.raises(TpvqaError, match="not known"):
        Serving(Known(TABLE), host="no-such-host.invalid", token=KEY)


def test_at_the_end_what_waits_is_answered() -> None:
    vlm = Known(TABLE)
    with ThreadPoolExecutor() as pool, running(vlm) as serving:
        vlm.free.clear()
        waiting = [
            pool.submit(complete, serving, body("Is the plate clean?", picture(n)))
            for n in range(5)
        ]
        eventually(lambda: call(serving, "GET", "/health").json["waiting"] == 5)
        serving.stop()
        eventually(lambda: call(serving, "GET", "/health").status == 503)
        new = complete(serving, FRIDGE)
        assert (new.status, new.error["code"]) == (503, "ending")
        assert int(new.headers["retry-after"]) >= 1
        vlm.free.set()
        assert [each.result().word for each in waiting] == ["no"] * 5
    assert vlm.closed
    with pytest.raises((ConnectionError, OSError)):
        complete(serving, FRIDGE)


def test_at_the_end_who_cannot_be_answered_is_told() -> None:
    vlm = Known(TABLE)
    began = time.monotonic()
    with ThreadPoolExecutor() as pool:
        with running(vlm, limits=Limits(ending=0.2)) as serving:
            vlm.free.clear()
            waiting = [
                pool.submit(complete, serving, body("Is the plate clean?", picture(n)))
                for n in range(3)
            ]
            eventually(lambda: call(serving, "GET", "/health").json["waiting"] == 3)
            serving.stop()
            told = [each.result() for each in waiting]
        assert [(each.status, each.error["code"]) for each in told] == [(503, "ending")] * 3
        assert time.monotonic() - began < 8
        vlm.free.set()


class Counting(Known):
    """Counts its calls that are under way at once, in all and about one picture."""

    def __init__(self) -> None:
        super().__init__(TABLE)
        self._lock = threading.Lock()
        self._under_way: list[bytes] = []
        self.most = self.most_of_one = 0

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        (frame,) = observation.frames.values()
        with self._lock:
            self._under_way.append(frame.data)
            self.most = max(self.most, len(self._under_way))
            self.most_of_one = max(self.most_of_one, self._under_way.count(frame.data))
        time.sleep(0.03)
        with self._lock:
            self._under_way.remove(frame.data)
        return super().ask(observation, questions)


class SideBySideCounting(Counting, SideBySide):
    pass


@pytest.mark.parametrize(("vlm", "at_once"), [(Counting(), 1), (SideBySideCounting(), 2)])
def test_several_threads_ask_a_vlm_that_allows_it_and_never_about_one_picture(
    vlm: Counting, at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    asked = [body(text, picture(n)) for n in range(3) for text in TABLE for _ in range(2)]
    with running(vlm) as serving, ThreadPoolExecutor(len(asked)) as pool:
        words = [each.result().word for each in [pool.submit(complete, serving, a) for a in asked]]
    assert words == ["yes", "yes", "no", "no", "cannot see", "cannot see"] * 3
    assert (vlm.most, vlm.most_of_one) == (at_once, 1)
    assert len(vlm.calls) < len(asked)
