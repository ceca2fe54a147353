"""An environment in which a server cannot be asked: an error that names what is to be mended."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from PIL import Image

from tests.cli.conftest import Run
from tests.vlm.chat_server import ChatServer
from tests.vlm.test_hostile_server import QUESTION


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> Iterator[ChatServer]:
    for name in ("OPENAI_API_KEY", "OPENAI_ORG_ID", "NO_PROXY", "no_proxy"):
        monkeypatch.delenv(name, raising=False)
    with ChatServer(lambda *_: "no") as served:
        yield served


def asked(tpvqa: Run, server: ChatServer, folder: Path) -> tuple[int, str, str]:
    Image.linear_gradient("L").save(folder / "p.png")
    return tpvqa("ask", folder / "p.png", QUESTION, "--vlm", "openai:m", "--base-url", server.url)


@pytest.mark.parametrize(
    ("name", "value", "cause"),
    [
        ("HTTP_PROXY", "http://127.0.0.1:99999999", "port must be 0-65535"),
        ("OPENAI_CUSTOM_HEADERS", "Content-Length: 5", "Too much data"),
        ("OPENAI_CUSTOM_HEADERS", "X y: 5", "Illegal header name"),
    ],
)
def test_what_cannot_be_sent_is_told_with_its_cause_and_what_to_look_at(
    name: str,
    value: str,
    cause: str,
    server: ChatServer,
    tpvqa: Run,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(name, value)
    code, out, err = asked(tpvqa, server, tmp_path)
    assert (code, out) == (2, "")
    assert cause in err
    assert name in err
    assert "TaskGroup" not in err
    assert not server.requests
