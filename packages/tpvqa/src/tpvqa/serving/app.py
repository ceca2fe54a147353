"""The endpoint: chat completions, models, health."""

import asyncio
import json
import sys
import time
import traceback
from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import dataclass
from random import Random

from fastapi import FastAPI, Request, Response
from fastapi.responses import StreamingResponse
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.types import Receive, Scope, Send

from tpvqa.chance import chance
from tpvqa.serving.asked import question_in
from tpvqa.serving.desk import Desk
from tpvqa.serving.door import Door, check_coding
from tpvqa.serving.refusal import Refusal
from tpvqa.serving.sent import Pictures
from tpvqa.serving.several import questions_in, spoken_together
from tpvqa.serving.spoken import spoken
from tpvqa.serving.wire import Asking, Reply, read_request

_LARGE = 2**20
"""Bytes of a body from which on it is not read in the loop's thread."""


@dataclass(frozen=True, slots=True)
class Limits:
    """How much is taken.

    Attributes:
        body: Bytes of a request.
        bodies: Bytes of all requests together that are being read or wait.
        pictures: In a request.
        waiting: Questions at once.
        patience: Seconds until a question is answered.
        sending: Seconds that a request may take to come in.
        ending: Seconds for what waits when the server ends.
    """

    body: int = 32 * 2**20
    bodies: int = 256 * 2**20
    pictures: int = 8
    waiting: int = 256
    patience: float = 60.0
    sending: float = 30.0
    ending: float = 10.0


class Endpoint:
    """The application that a server runs.

    Args:
        model: What the VLM is called.
        desk: Where questions wait for it.
        door: Who may ask.
        limits: How much is taken.
    """

    def __init__(self, model: str, desk: Desk, door: Door, limits: Limits):
        self._model, self._desk, self._door, self._limits = model, desk, door, limits
        self._pictures = Pictures(most=limits.pictures)
        self._held = 0
        self._since = int(time.time())
        app = FastAPI(openapi_url=None, docs_url=None, redoc_url=None, redirect_slashes=False)
        app.add_api_route("/health", _answered(self._health), methods=["GET"])
        app.add_api_route("/v1/models", _answered(self._models), methods=["GET"])
        app.add_api_route("/v1/models/{name:path}", _answered(self._one_model), methods=["GET"])
        app.add_api_route("/v1/chat/completions", _answered(self._complete), methods=["POST"])
        app.add_exception_handler(HTTPException, _no_such_place)
        self.app = app

    async def _health(self, request: Request) -> Response:
        self._door.check_host(request.headers)
        ending = self._desk.closed
        said = {
            "status": "ending" if ending else "ok",
            "model": self._model,
            "waiting": self._desk.waiting,
        }
        return _json(said, 503 if ending else 200)

    async def _models(self, request: Request) -> Response:
        self._door.check(request.headers)
        return _json({"object": "list", "data": [self._card]})

    async def _one_model(self, request: Request) -> Response:
        self._door.check(request.headers)
        self._see_model(request.path_params["name"])
        return _json(self._card)

    @property
    def _card(self) -> dict[str, object]:
        return {
            "id": self._model,
            "object": "model",
            "created": self._since,
            "owned_by": "tpvqa",
        }

    def _see_model(self, name: str) -> None:
        if name != self._model:
            raise Refusal(
                404,
                f"There is no model {name[:80]!r} here; this server has {self._model!r}.",
                param="model",
                code="model_not_found",
            )

    async def _complete(self, request: Request) -> Response:
        self._door.check(request.headers)
        try:
            self._door.check_kind(request.headers)
            check_coding(request.headers)
        except Refusal:
            await self._let_pass(request)
            raise
        declared = _length(request)
        if declared is not None and declared > self._limits.body:
            return _BeforeTheRest(self._too_large(), lambda: self._let_pass(request))
        room = self._limits.body if declared is None else declared
        if self._held + room > self._limits.bodies:
            await self._let_pass(request)
            raise Refusal(
                503,
                "Requests hold too much memory at the moment. Ask again later.",
                code="too_much_waiting",
                retry_after=1,
            )
        self._held += room
        try:
            reply, asking = await self._reply(request, await self._body(request))
        finally:
            self._held -= room
        if asking.stream:
            return StreamingResponse(_stream(reply), media_type="text/event-stream")
        return _json(reply.body)

    async def _reply(self, request: Request, body: bytes) -> tuple[Reply, Asking]:
        large = len(body) > _LARGE
        asking = await asyncio.to_thread(read_request, body) if large else read_request(body)
        self._see_model(asking.model)
        form = asking.form
        questions = questions_in(asking.text, form) if form else [question_in(asking.text)]
        key, frames = (
            await asyncio.to_thread(self._pictures.read, asking.urls)
            if large
            else self._pictures.read(asking.urls)
        )
        gone = asyncio.create_task(_gone(request))
        try:
            answers = await self._desk.ask(key, frames, questions, gone)
        finally:
            gone.cancel()
        seeded = asking.seed is not None
        random = chance(asking.seed or 0, 0, "spoken", *questions, *key) if seeded else Random()
        each = [spoken(answer) for answer in answers]
        said = spoken_together(each, form) if form else each[0]
        return Reply(asking, sum(len(text.split()) for text in questions), said, random), asking

    async def _body(self, request: Request) -> bytes:
        parts, size = [], 0
        try:
            async with asyncio.timeout(self._limits.sending):
                async for part in request.stream():
                    size += len(part)
                    if size <= self._limits.body:
                        parts.append(part)
                    elif size > 2 * self._limits.body:
                        break
        except TimeoutError:
            raise Refusal(
                408,
                f"The request did not come in within {self._limits.sending:g} s. Send it again.",
                code="slow_request",
            ) from None
        if size > self._limits.body:
            raise self._too_large()
        return b"".join(parts)

    async def _let_pass(self, request: Request) -> None:
        """Read on for a while what is not wanted: a client that still sends hears no reply."""
        left = 2 * self._limits.body
        try:
            async with asyncio.timeout(self._limits.sending):
                async for part in request.stream():
                    left -= len(part)
                    if left < 0:
                        return
        except (TimeoutError, ClientDisconnect):
            return

    def _too_large(self) -> Refusal:
        most = self._limits.body / 2**20
        return Refusal(
            413,
            f"The request has more than {most:g} MiB. Send smaller pictures.",
            code="request_too_large",
        )


class _BeforeTheRest(Response):
    """A refusal that is sent at once, before the rest of the request has come in.

    Args:
        refusal: What it says.
        let_pass: Reads the rest, within bounds.
    """

    def __init__(self, refusal: Refusal, let_pass: Callable[[], Awaitable[None]]):
        super().__init__(json.dumps(refusal.body), refusal.status, media_type="application/json")
        self._let_pass = let_pass

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send the whole reply, and end it when the rest has passed."""
        head = {"status": self.status_code, "headers": self.raw_headers}
        await send({"type": "http.response.start", **head})
        await send({"type": "http.response.body", "body": self.body, "more_body": True})
        await self._let_pass()
        await send({"type": "http.response.body", "body": b"", "more_body": False})


_Place = Callable[[Request], Awaitable[Response]]


def _answered(place: _Place) -> _Place:
    """A place whose refusals are replies."""

    async def answered(request: Request) -> Response:
        try:
            return await place(request)
        except Refusal as refused:
            refusal = refused
        except ClientDisconnect:
            return Response(status_code=400)  # nobody reads it
        except Exception as error:  # noqa: BLE001 — whoever asks hears of it in the usual form
            traceback.print_exception(error, file=sys.stderr)
            refusal = Refusal(500, "The server broke; its log says where.", code="server_broke")
        return _json(refusal.body, refusal.status, refusal.headers)

    return answered


async def _no_such_place(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    refusal = Refusal(
        error.status_code,
        f"{request.method} {request.url.path[:80]}: there is no such thing here. There are POST "
        "/v1/chat/completions, GET /v1/models and GET /health.",
        code="not_found" if error.status_code == 404 else None,
    )
    return _json(refusal.body, refusal.status, dict(error.headers or {}))


async def _gone(request: Request) -> None:
    """Return when the client has gone."""
    while (await request.receive())["type"] != "http.disconnect":
        pass


async def _stream(reply: Reply) -> AsyncIterator[str]:
    for event in reply.events():
        yield f"data: {json.dumps(event)}\n\n"
    yield "data: [DONE]\n\n"


def _length(request: Request) -> int | None:
    declared = request.headers.get("content-length", "")
    return int(declared) if declared.isdecimal() else None


def _json(body: object, status: int = 200, headers: dict[str, str] | None = None) -> Response:
    return Response(json.dumps(body), status, headers, media_type="application/json")
