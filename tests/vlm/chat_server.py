"""A small server that speaks the chat completions API over real HTTP, on this machine.

What it answers comes from any callable of pictures and question, so a scripted table, a person or
a network can stand behind it; how it behaves (slow, failing, garbled) is a script of its own.
"""

import base64
import json
import math
import socket
import struct
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from types import TracebackType
from typing import Any

Answerer = Callable[[Sequence[bytes], str], "float | str"]
"""Pictures and question → P(yes), or the words to say."""

LEFTOVER = 0.04  # of the first token's probability, for neither yes nor no


@dataclass(frozen=True)
class Request:
    """What a client asked."""

    question: str
    pictures: tuple[bytes, ...]
    body: Mapping[str, Any]
    authorization: str


@dataclass(frozen=True)
class Act:
    """How one request is met instead of, or before, an ordinary answer.

    Attributes:
        status: The HTTP status; with 200 and no body, the ordinary answer follows.
        body: The raw body; a mapping is sent as JSON.
        headers: Further headers.
        wait: Seconds before anything is sent.
        reset: Cut the connection without a reply.
        drip: Seconds between one byte of the body and the next.
        raw: What is sent, status line, headers and all; then the connection is closed.
    """

    status: int = 200
    body: str | bytes | Mapping[str, Any] | None = None
    headers: Mapping[str, str] = field(default_factory=dict)
    wait: float = 0.0
    reset: bool = False
    drip: float = 0.0
    raw: bytes | None = None


Script = Callable[[Request, int], Act | None]
"""A request and how often its question was asked before → what to do; None to answer."""


def refusal(status: int, message: str, *, param: str = "", code: str = "") -> Act:
    """An error in the shape that OpenAI's servers give it."""
    error = {"message": message, "type": "invalid_request_error", "param": param, "code": code}
    return Act(status, {"error": error})


class ChatServer:
    """Serves while used as a context manager; `url` is what a client is given as base URL."""

    def __init__(
        self, answerer: Answerer, *, logprobs: bool = True, script: Script = lambda *_: None
    ) -> None:
        self.answerer, self.logprobs, self.script = answerer, logprobs, script
        self.requests: list[Request] = []
        self.at_once = self.most_at_once = 0
        self._lock = threading.Lock()
        self._server = _Server(("127.0.0.1", 0), _Handler)
        self._server.chat = self
        self._thread = threading.Thread(
            target=self._server.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True
        )

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self._server.server_port}/v1"

    def __enter__(self) -> "ChatServer":
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def meet(self, request: Request) -> Act:
        """Note a request and decide what comes of it."""
        with self._lock:
            before = sum(other.question == request.question for other in self.requests)
            self.requests.append(request)
            self.at_once += 1
            self.most_at_once = max(self.most_at_once, self.at_once)
        try:
            act = self.script(request, before) or Act()
            time.sleep(act.wait)
            if act.body is None and act.status == 200 and not act.reset and act.raw is None:
                answer = self.answerer(request.pictures, request.question)
                wanted = self.logprobs and bool(request.body.get("logprobs"))
                act = Act(body=completion(answer, logprobs=wanted))
            return act
        finally:
            with self._lock:
                self.at_once -= 1


def completion(answer: float | str, *, logprobs: bool) -> dict[str, Any]:
    """A reply's body. A probability is spread over several ways of writing yes and no."""
    if isinstance(answer, str):
        said, top = answer, []
    else:
        mass = 1 - LEFTOVER
        spread = {
            "Yes": 0.7 * answer * mass,
            " yes": 0.3 * answer * mass,
            "No": 0.6 * (1 - answer) * mass,
            "no": 0.4 * (1 - answer) * mass,
            "Maybe": LEFTOVER,
        }
        said = "Yes" if answer > 0.5 else "No"
        top = [
            {"token": token, "logprob": math.log(p) if p > 0 else -9999.0, "bytes": None}
            for token, p in sorted(spread.items(), key=lambda entry: -entry[1])
        ]
    choice: dict[str, Any] = {
        "index": 0,
        "message": {"role": "assistant", "content": said, "refusal": None},
        "finish_reason": "stop",
        "logprobs": None,
    }
    if logprobs and top:
        likeliest = next(entry for entry in top if entry["token"] == said)
        choice["logprobs"] = {"content": [{**likeliest, "top_logprobs": top}], "refusal": None}
    return {
        "id": "chatcmpl-1",
        "object": "chat.completion",
        "created": 1,
        "model": "test",
        "choices": [choice],
        "usage": {"prompt_tokens": 1, "completion_tokens": 1, "total_tokens": 2},
    }


class _Server(ThreadingHTTPServer):
    chat: ChatServer
    daemon_threads = True
    request_queue_size = 64


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def do_POST(self) -> None:
        server = self.server
        assert isinstance(server, _Server)
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        if self.path != "/v1/chat/completions":
            self._send(Act(404, {"error": {"message": f"no such path {self.path}"}}))
            return
        content = body["messages"][-1]["content"]
        text = next(part["text"] for part in content if part["type"] == "text")
        urls = [part["image_url"]["url"] for part in content if part["type"] == "image_url"]
        request = Request(
            question=text[: text.index("?") + 1].rpartition(". ")[2],
            pictures=tuple(base64.b64decode(url.partition("base64,")[2]) for url in urls),
            body=body,
            authorization=self.headers.get("Authorization", ""),
        )
        self._send(server.chat.meet(request))

    def _send(self, act: Act) -> None:
        if act.reset:
            # Closing with the linger time 0 sends a reset instead of an orderly end.
            self.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            self.close_connection = True
            self.connection.close()
            return
        if act.raw is not None:
            self.connection.sendall(act.raw)
            self.close_connection = True
            return
        body = act.body if isinstance(act.body, (str, bytes)) else json.dumps(act.body or {})
        data = body.encode() if isinstance(body, str) else body
        headers = {"Content-Type": "application/json", **act.headers}
        try:
            self.send_response(act.status)
            for name, value in headers.items():
                self.send_header(name, value)
            self.send_header("Content-Length", str(len(data)))
            self.end_headers()
            if not act.drip:
                self.wfile.write(data)
            for at in range(len(data) if act.drip else 0):
                self.wfile.write(data[at : at + 1])
                time.sleep(act.drip)
        except OSError:
            self.close_connection = True  # the client has gone

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing."""
