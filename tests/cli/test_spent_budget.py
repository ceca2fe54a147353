"""A trial whose server costs too much: it stops in time, says so, and is gone on with."""

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Run
from tests.vlm.chat_server import Act, ChatServer


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
        assert f"{limit} of {limit} spent, with the question that tests the server" in " ".join(
            out.split()
        )
        assert "the trial's questions took" in " ".join(out.split())
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


def test_a_server_that_is_lost_in_the_middle_is_told_with_how_to_go_on(tpvqa: Run) -> None:
    run = ("run", "eat_apple", "--monitor", "palmevqa", "--seed", 1, "--max-actions", 6)
    with ChatServer(lambda *_: 0.9) as server:
        vlm = ("--vlm", "openai:m", "--base-url", server.url)
        whole = json.loads(tpvqa(*run, *vlm, "--out", "whole", "--json")[1])
    lost: list[bool] = []
    with ChatServer(lambda *_: 0.9, script=lambda *_: Act(reset=True) if lost else None) as server:
        vlm = ("--vlm", "openai:m", "--base-url", server.url)

        def answer(*_: object) -> float:
            lost.extend([True] * (len(server.requests) > 4))
            return 0.9

        server.answerer = answer
        code, _, err = tpvqa(*run, *vlm, "--out", "part")
        assert code == 2
        assert "cannot be reached" in " ".join(err.split())
        assert f"tpvqa resume part --base-url {server.url}" in err
        lost.clear()
        server.answerer = lambda *_: 0.9
        code, out, err = tpvqa("resume", "part", "--base-url", server.url, "--json")
    names = ("ended_because", "actions", "questions")
    assert {n: json.loads(out)[n] for n in names} == {n: whole[n] for n in names}, err


def test_one_web_page_after_good_answers_is_one_unknown_answer(tpvqa: Run) -> None:
    page = Act(body="<html>502 Bad Gateway</html>", headers={"Content-Type": "text/html"})
    with ChatServer(lambda *_: 0.9) as server:
        server.script = lambda *_: page if len(server.requests) == 4 else None
        vlm = ("--vlm", "openai:m", "--base-url", server.url, "--monitor", "palmevqa")
        code, _, err = tpvqa("run", "eat_apple", *vlm, "--max-actions", 3, "--out", "here")
    assert code in (0, 1), err
    assert "garbled reply: a web page" in (Path("here") / "episode.jsonl").read_text()


def test_a_web_page_at_first_is_a_wrong_address(tpvqa: Run) -> None:
    page = Act(body="<html>hello</html>", headers={"Content-Type": "text/html"})
    with ChatServer(lambda *_: 0.9, script=lambda *_: page) as server:
        code, _, err = tpvqa("run", "eat_apple", "--vlm", "openai:m", "--base-url", server.url)
    assert code == 2
    assert "answers with a web page. Is the path right" in " ".join(err.split())
