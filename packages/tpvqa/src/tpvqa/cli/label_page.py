"""The page on which pictures are labelled: served to this machine alone, at an address that nobody
can guess."""

import json
import secrets
import sys
from functools import cached_property
from hashlib import sha256
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from threading import Lock, Thread
from typing import TYPE_CHECKING, Any, Self

from tpvqa.cli.label_words import press, progress_line, when
from tpvqa.errors import PictureError, TpvqaError
from tpvqa.pictures import picture_type, read_picture
from tpvqa.spelling import spelled

if TYPE_CHECKING:
    from tpvqa.labelling import Session

HERE = "127.0.0.1"
_LONGEST = 1_000
"""Bytes of a request's body."""
_MOST_DIGITS = 9
"""Python turns no more than some thousand into a number, and refuses with an error of its own."""
_HEADERS = {
    "Cache-Control": "no-store",
    "Referrer-Policy": "same-origin",
    "X-Content-Type-Options": "nosniff",
    "Content-Security-Policy": (
        "default-src 'none'; img-src 'self'; connect-src 'self'; "
        "style-src 'unsafe-inline'; script-src 'unsafe-inline'; frame-ancestors 'none'"
    ),
}


class LabelPage:
    """Serves a session until it is quit. Use it as a context manager.

    Only who knows the address can see or label anything: it holds a random token, and requests
    that other pages make in the browser, or under another host's name, are refused.

    Args:
        session: What is labelled. Nobody else may use it meanwhile.
        port: The port; 0 for a free one.

    Raises:
        TpvqaError: The port is taken.
    """

    def __init__(self, session: "Session", *, port: int = 0):
        self._session, self._token = session, secrets.token_urlsafe(16)
        self.broken: TpvqaError | None = None
        self._one, self._over = Lock(), False
        try:
            self._server = _Server((HERE, port), _Handler)
        except OSError as error:
            raise TpvqaError(
                f"port {port} of this machine cannot be used ({error.strerror}). Name another with "
                "--port, or none"
            ) from error
        self._server.page = self

    @property
    def address(self) -> str:
        """Where the page is."""
        return f"{self.origin}/{self._token}/"

    @property
    def origin(self) -> str:
        """What a browser says a request comes from that this page makes."""
        return f"http://{self.host}"

    @property
    def host(self) -> str:
        """What a browser calls this server."""
        return f"{HERE}:{self._server.server_address[1]}"

    @property
    def path(self) -> str:
        """What the path of every request begins with."""
        return f"/{self._token}/"

    def serve(self) -> None:
        """Serve until the page is quit or the process is interrupted.

        Raises:
            WriteError: A label could not be written.
        """
        self._server.serve_forever(poll_interval=0.1)
        if self.broken is not None:
            raise self.broken

    def end(self) -> None:
        """End serving, once this request is answered."""
        Thread(target=self._server.shutdown, daemon=True).start()

    @cached_property
    def html(self) -> bytes:
        """The page; it needs nothing beside it but what it asks this server for."""
        return files("tpvqa.cli").joinpath("label.html").read_bytes()

    def state(self) -> dict[str, Any]:
        """What the page shows now."""
        with self._one:
            return self._state()

    def _state(self) -> dict[str, Any]:
        session, progress = self._session, self._session.progress
        asking = session.now
        return {
            "vlm": spelled(session.vlm),
            "labels": progress.labels,
            "left": progress.standing.left,
            "enough": progress.standing.enough,
            "progress": progress_line(progress),
            "question": None if asking is None else spelled(asking.text),
            "when": None if asking is None else when(asking),
            "pictures": 0 if asking is None else len(asking.pictures),
            "number": secrets.token_hex(4),  # so that no browser shows an earlier picture
            "of": self._of,
            "label": None if asking is None else session.label_of(asking),
            "notice": session.notice,
        }

    @property
    def _of(self) -> str:
        """Tells the question that is shown now from others."""
        asking = self._session.now
        key = None if asking is None else (str(asking.episode), *asking.key)
        return sha256(repr(key).encode()).hexdigest()[:16]

    def press(self, key: str, of: str) -> bool:
        """Do what a key says; whether to go on.

        Args:
            key: Which.
            of: The question that was shown when it was pressed: where another tab has gone on
                since, nothing but to quit is done.
        """
        with self._one:
            if of != self._of and key != "q":
                return True
            try:
                return not self._over and press(self._session, key)
            except TpvqaError as error:
                self.broken = error
                return False

    def picture(self, number: int) -> bytes:
        """A picture of the question that is shown now.

        Raises:
            PictureError: There is none, or it is no picture.
        """
        asking = self._session.now
        if asking is None or not 0 <= number < len(asking.pictures):
            raise PictureError("there is no such picture")
        return read_picture(asking.pictures[number], inside=asking.episode)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        with self._one:  # a label that is being written is written
            self._over = True
        self._server.server_close()


class _Server(ThreadingHTTPServer):
    """A thread for every connection, as browsers open some that they do not use."""

    page: LabelPage
    daemon_threads = True
    allow_reuse_address = True

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A browser that goes away in the middle is not worth a line."""
        if not isinstance(sys.exception(), OSError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    server: _Server
    timeout = 10
    """Seconds after which a browser that only keeps a connection open is let go."""
    server_version = "tpvqa"
    sys_version = ""

    def do_GET(self) -> None:
        page, what = self.server.page, self._what()
        if what == "":
            self._send(page.html, "text/html; charset=utf-8")
        elif what == "state":
            self._send_state()
        elif what is not None and what.startswith("picture/"):
            number = what.removeprefix("picture/").partition("?")[0]
            try:
                data = page.picture(-1 if (found := _number(number)) is None else found)
                self._send(data, picture_type(data))
            except PictureError as error:
                self._refuse(HTTPStatus.NOT_FOUND, str(error))
        else:
            self._refuse(HTTPStatus.NOT_FOUND, "nothing is here")

    def do_POST(self) -> None:
        page = self.server.page
        what, _, of = (self._what() or "").partition("/")
        if what != "key":
            self._refuse(HTTPStatus.NOT_FOUND, "nothing is here")
            return
        length = _number(self.headers.get("Content-Length", ""))
        if length is None or length > _LONGEST:
            self._refuse(HTTPStatus.BAD_REQUEST, "what is said is too long")
            return
        key = self.rfile.read(length)
        if len(key) < length:
            self._refuse(HTTPStatus.BAD_REQUEST, "what is said has been cut off")
            return
        going = page.press(key.decode(errors="replace"), of)
        self._send_state(ended=not going)
        if not going:
            page.end()

    def _what(self) -> str | None:
        """What is asked for, of whoever knows the address; None for others."""
        page = self.server.page
        path = self.path.encode(errors="replace")
        mine = secrets.compare_digest(path[: len(page.path)], page.path.encode())
        origin = self.headers.get("Origin", page.origin)
        if not mine or self.headers.get("Host") != page.host or origin != page.origin:
            return None
        return self.path[len(page.path) :]

    def _send_state(self, *, ended: bool = False) -> None:
        page = self.server.page
        broken = None if page.broken is None else str(page.broken)
        state = {**page.state(), "ended": ended, "broken": broken}
        self._send(json.dumps(state).encode(), "application/json")

    def _send(self, data: bytes, kind: str, status: HTTPStatus = HTTPStatus.OK) -> None:
        self.send_response(status)
        for name, value in _HEADERS.items():
            self.send_header(name, value)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        self.wfile.write(data)

    def _refuse(self, status: HTTPStatus, why: str) -> None:
        self._send(why.encode(errors="replace"), "text/plain; charset=utf-8", status)

    def log_message(self, *_: object) -> None:
        """Requests are not worth a line."""


def _number(digits: str) -> int | None:
    """A number of few digits; None where it is none."""
    return int(digits) if len(digits) <= _MOST_DIGITS and digits.isdecimal() else None
