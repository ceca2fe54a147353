"""What commands say of a server that is not to be trusted, and of an address with a password."""

import json
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from tests.cli.conftest import Run
from tests.vlm.chat_server import Act, ChatServer, completion
from tests.vlm.test_hostile_server import KEY, QUESTION, always, leaks
from tpvqa.config import TrialConfig
from tpvqa.errors import AnswerError
from tpvqa.vlm.openai_compatible import OpenAICompatibleVLM
from tpvqa.vlm.server_text import KEY as TAKEN_OUT


def _draw(path: Path) -> None:
    picture = Image.new("RGB", (8, 8), "red")
    picture.paste("black", (0, 4, 8, 8))
    picture.save(path)


def test_the_command_prints_no_key(
    tpvqa: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    _draw(tmp_path / "p.jpg")
    for status in (200, 400):
        body: dict[str, Any] = completion(f"Yes {KEY}", logprobs=False)
        body |= {"error": {"message": f"key {KEY}"}} if status == 400 else {}
        with ChatServer(lambda *_: "no", script=always(Act(status, body))) as server:
            for more in ((), ("--json",)):
                words = ("--vlm", "openai:m", "--base-url", server.url, *more)
                code, out, err = tpvqa("ask", tmp_path / "p.jpg", QUESTION, *words)
                assert code == (0 if status == 200 else 2)
                assert not leaks(out + err)
                assert TAKEN_OUT in out + err


SECRET = "hunter2hunter2"
WITH_SECRETS = [
    f"http://me:{SECRET}@localhost:8000/v1",
    f"https://{SECRET}@host/v1",
    f"http://host/v1?key={SECRET}",
    f"http://host/v1#{SECRET}",
    f"http://me:{SECRET}@[::1/v1",
    f"me:{SECRET}@host",
]


@pytest.mark.parametrize("address", WITH_SECRETS)
def test_a_password_in_an_address_is_refused_and_not_repeated(
    address: str, tpvqa: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _draw(tmp_path / "p.jpg")
    file = tmp_path / "trial.yaml"
    file.write_text(f"vlm:\n  base_url: {json.dumps(address)}\n")
    for words in (
        ("ask", tmp_path / "p.jpg", QUESTION, "--vlm", "openai:m", "--base-url", address),
        ("config", "build_tower", "--base-url", address),
        ("config", "build_tower", "--config", file),
        ("run", "build_tower", "--vlm", "oracle", "--base-url", address, "--out", tmp_path / "e"),
    ):
        code, out, err = tpvqa(*words)
        assert code == 2, words
        assert "OPENAI_API_KEY" in err
        assert SECRET not in out + err
    assert not (tmp_path / "e").exists()
    with pytest.raises(ValueError, match="OPENAI_API_KEY") as caught:
        TrialConfig(vlm={"spec": "openai:m", "base_url": address})  # type: ignore[arg-type]
    assert SECRET not in str(caught.value)
    monkeypatch.setenv("OPENAI_BASE_URL", address)
    with pytest.raises(AnswerError, match="OPENAI_API_KEY") as refused:
        OpenAICompatibleVLM("m")
    assert SECRET not in str(refused.value)
