"""A small server that speaks the images API over real HTTP, on this machine.

Every picture that it makes is of another colour. How a request is met instead (slow, failing,
garbled) is a script.
"""

import base64
import json
import re
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from io import BytesIO
from types import TracebackType
from typing import Any

from PIL import Image


def picture(number: int, side: int = 64) -> bytes:
    """A plain PNG; another colour for another number."""
    buffer = BytesIO()
    Image.new("RGB", (side, side), (number * 7 % 256, number * 31 % 256, 90)).save(buffer, "PNG")
    return buffer.getvalue()


@dataclass(frozen=True)
class Request:
    """What a client asked: the end of the path, its form, its headers in lower case."""

    path: str
    form: Mapping[str, Any]
    headers: Mapping[str, str]
    at: float = field(default_factory=time.monotonic)


@dataclass(frozen=True)
class Act:
    """How one request is met instead of with a picture, or after waiting."""

    status: int = 200
    body: str | Mapping[str, Any] | None = None
    headers: Mapping[str, str] = field(default_factory=dict)
    wait: float = 0.0
    endless: bytes = b""
    """Said again and again after the headers, ten times a second."""


Script = Callable[[int], Act | None]
"""How often anything was asked before → what to do; None to make a picture."""


def refusal(status: int, message: str, *, code: str = "", **headers: str) -> Act:
    """An error in the shape that OpenAI's servers give it."""
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    return Act(status, {"error": {"message": message, "code": code}}, named)


class ImagesServer:
    """Serves while used as a context manager; `url` is what a client is given as base URL."""

    def __init__(self, *, script: Script = lambda _: None, by_url: bool = False) -> None:
        self.script, self.by_url = script, by_url
        self.requests: list[Request] = []
        self.fetched: list[Request] = []
        self.lost = 0  # how many of the next fetches of a finished picture fail
        self.endless_picture = b""  # what fetches of a finished picture are met with for ever
        self._lock = threading.Lock()
        self._server = _Server(("127.0.0.1", 0), _Handler)
        self._server.images = self
        self._thread = threading.Thread(
            target=self._server.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True
        )

    @property
    def root(self) -> str:
        return f"http://127.0.0.1:{self._server.server_port}"

    @property
    def url(self) -> str:
        return f"{self.root}/v1"

    def __enter__(self) -> "ImagesServer":
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
            before = len(self.requests)
            self.requests.append(request)
        act = self.script(before) or Act()
        time.sleep(act.wait)
        if act.status != 200 or act.body is not None or act.endless:
            return act
        entry: dict[str, str]
        if self.by_url:
            entry = {"url": f"{self.root}/made/{before}.png"}
        else:
            entry = {"b64_json": base64.b64encode(picture(before)).decode()}
        return Act(body={"created": 1, "data": [entry]})


class _Server(ThreadingHTTPServer):
    images: ImagesServer
    daemon_threads = True


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def do_POST(self) -> None:
        server = self.server
        assert isinstance(server, _Server)
        body = self.rfile.read(int(self.headers["Content-Length"]))
        name = self.path.removeprefix("/v1/images/")
        if name not in ("generations", "edits", "variations"):
            self._send(refusal(404, f"no such path {self.path}"))
            return
        kind = self.headers["Content-Type"]
        form = json.loads(body) if kind == "application/json" else _form(body, kind)
        self._send(server.images.meet(Request(name, form, self._named())))

    def do_GET(self) -> None:
        server = self.server
        assert isinstance(server, _Server)
        images = server.images
        images.fetched.append(Request(self.path, {}, self._named()))
        if images.lost:
            images.lost -= 1
            self._send(refusal(502, "try again"))
            return
        if images.endless_picture:
            self._repeat(images.endless_picture)
            return
        match = re.fullmatch(r"/made/(\d+)\.png", self.path)
        assert match is not None
        self._write(200, {"Content-Type": "image/png"}, picture(int(match[1])))

    def _named(self) -> dict[str, str]:
        return {name.lower(): value for name, value in self.headers.items()}

    def _send(self, act: Act) -> None:
        if act.endless:
            self._repeat(act.endless)
            return
        body = act.body if isinstance(act.body, str) else json.dumps(act.body or {})
        self._write(act.status, {"Content-Type": "application/json", **act.headers}, body.encode())

    def _write(self, status: int, headers: Mapping[str, str], data: bytes) -> None:
        try:
            self.send_response(status)
            for name, value in headers.items():
                self.send_header(name, value)
            self.send_header("Content-Length", str(len(data)))
            self.end_headers()
            self.wfile.write(data)
        except OSError:
            self.close_connection = True  # the client has gone

    def _repeat(self, data: bytes) -> None:
        self.close_connection = True
        with suppress(OSError):  # the client goes away
            self.send_response(200)
            self.end_headers()
            while True:
                self.wfile.write(data)
                time.sleep(0.1)

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing."""


def _form(body: bytes, content_type: str) -> dict[str, Any]:
    """The fields of a multipart form; files as bytes, the rest as text."""
    boundary = re.search(r'boundary="?([^";]+)', content_type)
    assert boundary is not None
    fields: dict[str, Any] = {}
    for part in body.split(b"--" + boundary[1].encode())[1:-1]:
        head, _, value = part.strip(b"\r\n").partition(b"\r\n\r\n")
        name = re.search(rb'name="([^"]+)"', head)
        assert name is not None
        is_file = b"filename=" in head
        fields[name[1].decode()] = value if is_file else value.decode()
    return fields
