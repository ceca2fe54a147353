"""The ways of asking a server, in whole trials; none is given what was recorded of another."""

import json
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.cli.conftest import Run
from tests.serving.running import picture as a_picture
from tests.vlm.chat_server import ChatServer

WAYS = {
    "singly": (),
    "together": ("--together",),
    "samples": ("--samples", "3"),
    "before and after": ("--before-after",),
    "small": ("--picture-size", "64"),
    "prompt": ("--prompt", "prompt.yaml"),
}


@pytest.fixture(autouse=True)
def environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("OPENAI_API_KEY", raising=False)
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")


def in_words(_: Sequence[bytes], text: str) -> str:
    """Yes to everything, without probabilities, as one word or as the JSON that is asked for."""
    every = {f"q{number}": "yes" for number in range(1, 10)}
    return json.dumps(every) if text.startswith("q1:") else "Yes"


def test_ways_of_asking_run_trials_and_share_no_recorded_answer(tpvqa: Run) -> None:
    Path("prompt.yaml").write_text('question: "Look. {question}"\n')
    with ChatServer(in_words, logprobs=False) as server:
        vlm = ("--vlm", "openai:m", "--base-url", server.url, "--monitor", "tpvqa")
        run = ("run", "eat_apple", *vlm, "--seed", "1", "--max-actions", "3", "--json")
        asked, pictures, trials = {}, {}, {}
        for name, way in WAYS.items():
            server.requests.clear()
            code, out, err = tpvqa(*run, *way, "--out", f"{name} 1", "--cache", "answers.db")
            assert code != 2, err
            asked[name], trials[name] = len(server.requests), json.loads(out)
            pictures[name] = max(len(each.pictures) for each in server.requests)
            seeing = 1 + 3 * (name == "samples")  # whether the server is there
            assert trials[name]["usage"]["requests"] == asked[name] - seeing
        for name, way in WAYS.items():
            server.requests.clear()
            code, out, err = tpvqa(*run, *way, "--out", f"{name} 2", "--cache", "answers.db")
            again = json.loads(out)
            assert len(server.requests) <= 1 + 3 * (name == "samples"), name
            assert again["questions"] == trials[name]["questions"] > 0
        server.requests.clear()
        for name in ("together", "samples", "prompt"):
            again = ("--replay", "answers.db", "--out", f"{name} 3")
            code, out, err = tpvqa(*run, *WAYS[name], *again)
            assert json.loads(out)["questions"] == trials[name]["questions"], err
        Path("prompt.yaml").write_text('question: "Look well. {question}"\n')
        code, out, err = tpvqa(*run, "--prompt", "prompt.yaml", "--replay", "answers.db")
        assert code == 2
        assert "no recorded answers" in " ".join(err.split())
        assert not server.requests
    assert all(asked[name] > 1 for name in WAYS)
    assert asked["together"] < asked["singly"] < asked["samples"]
    assert pictures["before and after"] == 2 * pictures["singly"]


def test_a_single_question_is_asked_in_the_same_ways(tpvqa: Run) -> None:
    picture = Path("seen.png")
    picture.write_bytes(a_picture(7, "PNG"))
    with ChatServer(in_words, logprobs=False) as server:
        vlm = ("--vlm", "openai:m", "--base-url", server.url)
        texts = ("Is it open?", "Is it shut?")
        code, out, err = tpvqa("ask", picture, *texts, *vlm, "--together", "--json")
        assert code == 0, err
        assert [each["reply"] for each in json.loads(out)["answers"]] == ["yes", "yes"]
        assert [each.question for each in server.requests] == ["q1: Is it open?"]
        code, out, err = tpvqa("ask", picture, *texts, *vlm, "--max-requests", "1")
    assert code == 2
    assert "--max-requests" in " ".join(err.split())


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (("--together",), "--together is for --vlm openai:MODEL, and this VLM is 'embedded'"),
        (("--max-requests", "3"), "--max-requests is for --vlm openai:MODEL"),
        (("--batch", "3"), "--batch is for --vlm hf:MODEL"),
        (("--base-url", "http://x"), "--base-url is for --vlm openai:MODEL, and this VLM is"),
        (("--majority", "strict", "--monitor", "belief"), "--majority is for --monitor tpvqa, or"),
        (
            ("--no-alternatives", "--monitor", "vote:3"),
            "--no-alternatives is for --monitor tpvqa, and this monitor is 'vote:3'. Leave it out",
        ),
        (
            ("--world", "symbolic", "--simulator", "paper", "--vlm", "oracle"),
            "--simulator is for --world images, and this world is 'symbolic'. Leave it out",
        ),
        (
            ("--world", "symbolic", "--pictures", "set", "--vlm", "oracle"),
            "--pictures is for --world pictures:FOLDER, or for --world images, and this world",
        ),
        (("--device", "banana"), "write auto, cpu, cuda, cuda:N or mps, not 'banana'"),
        (("--picture-quality", "101"), "a quality of JPEG from 1 to 100, or png, not '101'"),
    ],
)
def test_an_option_that_does_not_fit_is_told_with_what_would(
    tpvqa: Run, words: tuple[str, ...], why: str
) -> None:
    code, _, err = tpvqa("run", "eat_apple", "--vlm", "embedded", *words)
    assert code == 2
    assert why in " ".join(err.split())


def test_ask_speaks_of_the_vlm_alone(tpvqa: Run) -> None:
    a_file = Path("picture.jpg")
    a_file.write_bytes(a_picture())
    code, _, err = tpvqa("ask", a_file, "Is it late?", "--option", "foo=1")
    assert code == 2
    assert "There is no option for this VLM 'foo'" in err
    code, _, err = tpvqa("ask", a_file, " ")
    assert code == 2
    assert "A question is empty" in err


def test_one_price_alone_is_told(tpvqa: Run) -> None:
    with ChatServer(lambda *_: 0.9) as server:
        vlm = ("--vlm", "openai:m", "--base-url", server.url, "--max-actions", "1")
        _, _, err = tpvqa("run", "eat_apple", *vlm, "--price-prompt", "1")
        assert "note: --price-completion is not given" in err
        prices = ("--price-prompt", "1", "--price-completion", "0")
        assert "is not given" not in tpvqa("run", "eat_apple", *vlm, *prices)[2]
