"""A trial whose server costs too much: it stops in time, says so, and is gone on with."""

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Run
from tests.vlm.chat_server import ChatServer


@pytest.fixture(autouse=True)
def environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("OPENAI_API_KEY", raising=False)
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")


def test_a_spent_budget_stops_a_trial_that_ends_as_if_it_had_not(tpvqa: Run) -> None:
    with ChatServer(lambda *_: 0.9) as server:
        vlm = ("--vlm", "openai:m", "--base-url", server.url, "--monitor", "palmevqa")
        run = ("run", "eat_apple", *vlm, "--seed", "1", "--max-actions", "6")
        _, out, _ = tpvqa(*run, "--out", "whole", "--json")
        whole = json.loads(out)
        asked = len(server.requests)
        assert whole["usage"]["requests"] <= asked
        limit = asked // 2
        server.requests.clear()

        code, out, _ = tpvqa(*run, "--out", "part", "--json", "--max-requests", limit)
        stopped = json.loads(out)
        assert code != 0
        assert stopped["ended_because"] == "budget spent"
        assert len(server.requests) <= limit
        assert stopped["usage"]["prompt_tokens"] == stopped["usage"]["requests"]  # one each

        code, out, err = tpvqa("show", "part")
        assert code == 0, err
        assert "--max-requests" in " ".join(out.split())
        assert f"{stopped['usage']['requests']} requests" in " ".join(out.split())

        code, out, err = tpvqa(
            "resume", "part", "--json", "--max-requests", 10 * asked, "--base-url", server.url
        )
        assert json.loads(out)["ended_because"] == whole["ended_because"], err
    names = ("ended_because", "actions", "questions")
    assert {n: json.loads(out)[n] for n in names} == {n: whole[n] for n in names}


def test_another_prompt_is_refused_when_a_trial_is_gone_on_with(tpvqa: Run) -> None:
    file = Path("prompt.yaml")
    with ChatServer(lambda *_: 0.9) as server:
        file.write_text('question: "Look. {question}"\n')
        vlm = ("--vlm", "openai:m", "--base-url", server.url, "--monitor", "palmevqa")
        words = (*vlm, "--prompt", file, "--max-requests", 4, "--out", "here")
        tpvqa("run", "eat_apple", *words)
        log = (Path("here") / "episode.jsonl").read_text()
        file.write_text('question: "Look well. {question}"\n')
        again = ("--prompt", file, "--max-requests", 99, "--base-url", server.url)
        code, out, err = tpvqa("resume", "here", *again)
    assert (code, out) == (2, "")
    assert "another prompt" in " ".join(err.split())
    assert (Path("here") / "episode.jsonl").read_text() == log
