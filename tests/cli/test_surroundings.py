"""An environment in which a server cannot be asked: an error that names what is to be mended."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from PIL import Image

from tests.cli.conftest import Run
from tests.vlm.chat_server import ChatServer
from tests.vlm.test_hostile_server import QUESTION
from tests.vlm.test_openai_compatible import look, questions
from tpvqa.errors import AnswerError
from tpvqa.vlm.openai_compatible import OpenAICompatibleVLM


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


@pytest.mark.parametrize("value", ["sk-Zk83hTq9é", "sk-Zk83\r\nX: y", "sk-Zk83\x1bhTq9"])
@pytest.mark.parametrize("name", ["OPENAI_API_KEY", "OPENAI_ORG_ID", "OPENAI_PROJECT_ID"])
def test_what_no_header_can_hold_is_refused_by_the_name_of_its_variable(
    name: str,
    value: str,
    server: ChatServer,
    tpvqa: Run,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(name, value)
    code, out, err = asked(tpvqa, server, tmp_path)
    assert (code, out) == (2, "")
    assert name in err
    assert "Zk83" not in err
    assert not server.requests


def test_a_question_that_cannot_be_sent_is_no_answer_of_the_servers(server: ChatServer) -> None:
    vlm = OpenAICompatibleVLM("m", base_url=server.url)
    with pytest.raises(AnswerError, match="UnicodeEncodeError"):
        vlm.ask(look(), questions("Is the \udce9 open?"))
    vlm.close()
    assert not server.requests


def test_several_headers_may_be_given(
    server: ChatServer, tpvqa: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OPENAI_CUSTOM_HEADERS", "X-Team: a\r\nX-Task: b\tc\n")
    code, out, _ = asked(tpvqa, server, tmp_path)
    assert code == 0
    assert "no" in out
    monkeypatch.setenv("OPENAI_CUSTOM_HEADERS", "X-Team: a\nX-Task: é")
    code, out, err = asked(tpvqa, server, tmp_path)
    assert (code, out) == (2, "")
    assert "OPENAI_CUSTOM_HEADERS" in err


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("ALL_PROXY", "socks5://me:hunter2@127.0.0.1:1", "pip install socksio"),
        ("HTTP_PROXY", "http://me:hunter2/x@127.0.0.1:1", "http://HOST:PORT"),
        ("https_proxy", "gopher://hunter2@127.0.0.1:1", "http://HOST:PORT"),
        ("SSL_CERT_FILE", "hunter2.pem", "No such file"),
        ("SSL_CERT_FILE", "p.png", "no certificate"),
    ],
)
def test_a_proxy_or_certificates_that_cannot_be_used_are_named_with_the_remedy(
    name: str,
    value: str,
    said: str,
    server: ChatServer,
    tpvqa: Run,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "socksio", None)
    monkeypatch.setenv(name, value)
    code, out, err = asked(tpvqa, server, tmp_path)
    assert (code, out) == (2, "")
    assert name in err
    assert said in err
    assert "hunter2" not in err
    assert "broke" not in err
