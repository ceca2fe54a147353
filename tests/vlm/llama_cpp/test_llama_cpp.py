"""A real server that nobody here wrote: llama.cpp's, with a tiny model that sees pictures."""

import base64
import json
import subprocess
import sys
import urllib.request
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from tests.cli.conftest import Run, tpvqa
from tests.vlm.llama_cpp import serving, tiny
from tpvqa.cli.picture_sets import shipped_set
from tpvqa.episodes import read_episode
from tpvqa.events.events import Answered, Decided
from tpvqa.vlm import Reply
from tpvqa.vlm.chat_completions import Inquiry, messages
from tpvqa.vlm.prompt import shipped_prompt
from tpvqa.vlm.yes_no import mass

__all__ = ["tpvqa"]
pytest.importorskip("xllamacpp", reason="its wheels are for some machines alone")
QUESTIONS = ("Is the fridge open?", "Is the plate clean?", "Is there a TV?")
PICTURES = sorted(shipped_set().glob("**/*.jpg"))[:4]


@contextmanager
def running(*files: Path) -> Iterator[str]:
    command = [sys.executable, serving.__file__, *map(str, files)]
    process = subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert process.stdout is not None
    try:
        yield process.stdout.readline().strip() + "/v1"
    finally:
        process.kill()
        process.communicate()


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with running(*tiny.make(tmp_path_factory.mktemp("gguf"))) as found:
        yield found


@pytest.fixture(autouse=True)
def _directly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    monkeypatch.delenv("OPENAI_API_KEY", raising=False)


def asked(run: Run, picture: Path, address: str, *more: str) -> list[dict[str, Any]]:
    words = ("ask", picture, *QUESTIONS, "--vlm", "openai:tiny", "--base-url", address, "--json")
    code, out, error = run(*words, *more)
    assert code == 0, error
    found: list[dict[str, Any]] = json.loads(out)["answers"]
    return found


def plainly(picture: Path, question: str, address: str) -> float:
    """P(yes) as llama.cpp gives it to a request that has nothing of the client but its words."""
    url = "data:image/jpeg;base64," + base64.b64encode(picture.read_bytes()).decode()
    (said,) = messages(Inquiry((question,), ()), shipped_prompt())
    content = [{"type": "image_url", "image_url": {"url": url}}, *said["content"]]
    sent = {
        "model": "tiny",
        "messages": [{"role": "user", "content": content}],
        "logprobs": True,
        "top_logprobs": 20,
        "temperature": 0,
        "max_tokens": 8,
    }
    request = urllib.request.Request(
        f"{address}/chat/completions",
        json.dumps(sent).encode(),
        {"Content-Type": "application/json"},
    )
    with urllib.request.build_opener(urllib.request.ProxyHandler({})).open(request) as reply:
        first = json.load(reply)["choices"][0]["logprobs"]["content"][0]
    found = mass([(each["token"], each["logprob"]) for each in first["top_logprobs"]])
    assert found is not None
    assert found.p_yes is not None
    return found.p_yes


def test_p_yes_is_that_of_its_tokens_and_depends_on_the_picture(address: str, tpvqa: Run) -> None:
    told = [asked(tpvqa, picture, address, "--picture-size", "224") for picture in PICTURES]
    read = {answer["source"] for answers in told for answer in answers}
    assert read == {"logprobs"}
    for picture, answers in zip(PICTURES, told, strict=True):
        for answer in answers:
            if answer["reply"] != "unknown":
                right = plainly(picture, answer["question"], address)
                assert answer["p_yes"] == pytest.approx(right, abs=0.02)
                assert answer["reply"] == ("yes" if answer["p_yes"] > 0.5 else "no")
    assert len({answers[0]["p_yes"] for answers in told}) == len(PICTURES)


def test_all_questions_in_one_reply_that_a_grammar_holds_to_the_schema(
    address: str, tpvqa: Run
) -> None:
    answers = asked(tpvqa, PICTURES[0], address, "--together")
    assert {answer["reply"] for answer in answers} <= {"yes", "no"}
    assert {answer["source"] for answer in answers} == {"logprobs"}
    for answer in answers:
        assert answer["reply"] == ("yes" if answer["p_yes"] > 0.5 else "no")


def decisions(folder: str) -> Sequence[tuple[str, str]]:
    events = read_episode(Path(folder))
    replies = {
        answer.reply for event in events if isinstance(event, Answered) for answer in event.answers
    }
    assert replies <= {Reply.YES, Reply.NO, Reply.UNKNOWN}
    assert Reply.UNKNOWN not in replies or len(replies) > 1
    return [(each.action, each.decision) for each in events if isinstance(each, Decided)]


@pytest.mark.parametrize("way", [(), ("--together",)])
def test_a_whole_trial_is_the_same_again(way: tuple[str, ...], address: str, tpvqa: Run) -> None:
    words = ("run", "eat_apple", "--seed", 3, "--max-actions", 10, "--monitor", "tpvqa", *way)
    for out in ("one", "other"):
        code, said, error = tpvqa(
            *words, "--vlm", "openai:tiny", "--base-url", address, "--out", out
        )
        assert code in (0, 1), error
        assert "requests" in said
    assert decisions("one") == decisions("other")
    assert len(decisions("one")) > 3


def test_a_model_without_eyes_is_told(tmp_path: Path, tpvqa: Run) -> None:
    words, _ = tiny.make(tmp_path)
    with running(words) as address:
        command = ("ask", PICTURES[0], QUESTIONS[0], "--vlm", "openai:tiny")
        code, _, error = tpvqa(*command, "--base-url", address)
    assert code == 2
    assert "image input is not supported" in " ".join(error.split())
