"""A server in this process, with a VLM whose answers are known and which can be held up."""

import base64
import http.client
import json
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import BytesIO
from typing import Any
from urllib.parse import urlsplit

import numpy as np
from PIL import Image

from tpvqa.observation import Observation
from tpvqa.questions import Question
from tpvqa.serving.server import Serving
from tpvqa.vlm import VLM, Answer, Reply
from tpvqa.vlm.capabilities import NeedsPictures

INSTRUCTION = "Answer with one word, yes or no."


class Known(NeedsPictures):
    """Answers from a table; *unknown* to all else.

    Args:
        table: P(yes) of each question, or an answer's reply without probabilities.
    """

    name = "known"

    def __init__(self, table: Mapping[str, float | Reply]):
        self._table = table
        self.calls: list[tuple[tuple[bytes, ...], tuple[str, ...]]] = []
        self.free = threading.Event()
        self.free.set()
        self.asked = threading.Event()
        self.closed = 0
        self.breaks: Exception | None = None

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        pictures = tuple(frame.data for frame in observation.frames.values())
        self.calls.append((pictures, tuple(question.text for question in questions)))
        self.asked.set()
        assert self.free.wait(20)
        if self.breaks is not None:
            raise self.breaks
        return [self._answer(question) for question in questions]

    def _answer(self, question: Question) -> Answer:
        known = self._table.get(question.text, Reply.UNKNOWN)
        if isinstance(known, Reply):
            return Answer(question, known, text="so says the table")
        reply = Reply.YES if known > 0.5 else Reply.NO
        return Answer(question, reply, p_yes=known, source="network")

    def close(self) -> None:
        self.closed += 1


@contextmanager
def running(vlm: VLM, **options: Any) -> Iterator[Serving]:
    """A server for the time of a test; it has to end by itself when it is told to."""
    with Serving(vlm, port=0, **options) as serving:
        ready = threading.Event()
        thread = threading.Thread(target=serving.run, args=(ready.set,), daemon=True)
        thread.start()
        assert ready.wait(10)
        try:
            yield serving
        finally:
            serving.stop()
            thread.join(20)
            assert not thread.is_alive()


def picture(number: int = 0, kind: str = "JPEG") -> bytes:
    """A small picture, another one for every number."""
    pixels = np.zeros((24, 24, 3), np.uint8)
    pixels[: 3 + number % 16, : 4 + number // 16 % 16] = (200, 100, 50)
    file = BytesIO()
    Image.fromarray(pixels).save(file, kind)
    return file.getvalue()


def body(text: str, *pictures: bytes, **more: Any) -> dict[str, Any]:
    """A request with pictures."""
    urls = [f"data:image/jpeg;base64,{base64.b64encode(each).decode()}" for each in pictures]
    content = [{"type": "image_url", "image_url": {"url": url}} for url in urls]
    message = {"role": "user", "content": [*content, {"type": "text", "text": text}]}
    return {"model": "known", "messages": [message], **more}


class Said:
    """A reply over HTTP."""

    def __init__(self, response: http.client.HTTPResponse):
        self.status, self.headers = response.status, dict(response.headers)
        self.text = response.read().decode()

    @property
    def json(self) -> Any:
        return json.loads(self.text)

    @property
    def word(self) -> str:
        assert self.status == 200, self.text
        return str(self.json["choices"][0]["message"]["content"])

    @property
    def error(self) -> dict[str, Any]:
        found: dict[str, Any] = self.json["error"]
        assert self.status >= 400
        assert set(found) == {"message", "type", "param", "code"}
        return found


def call(
    serving: Serving,
    method: str,
    path: str,
    sent: Any = None,
    headers: Mapping[str, str] | None = None,
    timeout: float = 20,
) -> Said:
    """One request with Python's own client; a body is said to be JSON."""
    place = urlsplit(serving.address)
    connection = http.client.HTTPConnection(place.hostname or "", place.port, timeout=timeout)
    data = sent if sent is None or isinstance(sent, bytes) else json.dumps(sent).encode()
    try:
        kind = {} if data is None else {"Content-Type": "application/json"}
        connection.request(method, path, data, {**kind, **(headers or {})})
        return Said(connection.getresponse())
    finally:
        connection.close()


def complete(serving: Serving, sent: Any, **headers: str) -> Said:
    """Ask for a completion."""
    return call(serving, "POST", "/v1/chat/completions", sent, headers)
