"""`tpvqa serve-vlm` with the embedded network, asked over HTTP by the same command line."""

import json
import os
import random
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest

import tpvqa_household.calibrations
from tests.cli.conftest import Run
from tests.conftest import Install
from tests.doubles import worded
from tests.serving.faulty_proxy import Fault, FaultyProxy
from tpvqa.episodes import read_episode
from tpvqa.events.events import Answered, Asked, Decided, Event, Observed
from tpvqa.observation import Frame, Observation
from tpvqa.vlm import Reply
from tpvqa_household.embedded import EmbeddedVLM
from tpvqa_household.images.manifest import load_pictures

KEY = "a-token-of-enough-letters"


class Served:
    """A server in a process of its own."""

    def __init__(self, process: "subprocess.Popen[str]"):
        assert process.stdout is not None
        self.process = process
        said = json.loads(process.stdout.readline())
        self.url, self.model = str(said["url"]), str(said["model"])

    def end(self, how: int = signal.SIGTERM) -> tuple[int, str]:
        """End it; its exit code and what it said on standard error."""
        self.process.send_signal(how)
        _, said = self.process.communicate(timeout=30)
        return self.process.returncode, said


@contextmanager
def serving(*words: object, **environment: str) -> Iterator[Served]:
    command = [sys.executable, "-m", "tpvqa", "serve-vlm", "--port", "0", "--json"]
    process = subprocess.Popen(
        [*command, *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, **environment},
    )
    try:
        yield Served(process)
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate()


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    with serving() as found:
        yield found
        code, said = found.end()
        assert code == 0
        assert re.search(r"ended: \d+ questions? answered in \d+ calls?", said)
        assert "Traceback" not in said


@pytest.fixture(autouse=True)
def _directly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    monkeypatch.delenv("OPENAI_API_KEY", raising=False)
    monkeypatch.delenv("TPVQA_SERVE_TOKEN", raising=False)


@pytest.fixture
def pictures(tmp_path: Path) -> list[Path]:
    shipped = load_pictures()
    chosen = shipped.manifest.pictures[:: len(shipped.manifest.pictures) // 3][:3]
    paths = [tmp_path / f"{number}.jpg" for number in range(len(chosen))]
    for path, picture in zip(paths, chosen, strict=True):
        path.write_bytes(shipped.read(picture))
    return paths


QUESTIONS = (
    "Is there a plate in the image?",
    "Is the plate clean?",
    "Is the fridge open?",
    "Is the TV turned on?",
    "Is the apple cut in half?",
    "Was wash the plate successful?",
    "Is the weather fine?",
)


def test_the_answers_are_those_of_the_network(
    tpvqa: Run, served: Served, pictures: list[Path]
) -> None:
    replies = set()
    for picture in pictures:
        asked = ("ask", picture, *QUESTIONS, "--json")
        code, direct, _ = tpvqa(*asked, "--vlm", "embedded")
        assert code == 0
        code, there, err = tpvqa(*asked, "--vlm", "openai:embedded", "--base-url", served.url)
        assert (code, err) == (0, "")
        for home, away in zip(
            json.loads(direct)["answers"], json.loads(there)["answers"], strict=True
        ):
            seen = home["reply"] if home["reply"] in ("yes", "no") else "unknown"
            assert (away["question"], away["reply"]) == (home["question"], seen)
            replies.add(seen)
            if seen == "unknown":
                assert away["p_yes"] is None
                assert home["p_yes"] is not None or home["text"] in away["text"]
            else:
                assert away["p_yes"] == pytest.approx(home["p_yes"], abs=1e-6)
                assert away["source"] == "logprobs"
    assert replies == {"yes", "no", "unknown"}


def decisions(events: Sequence[Event]) -> list[tuple[str, int, str, str, str]]:
    return [
        (event.when, event.step, event.action, event.decision, event.reason)
        for event in events
        if isinstance(event, Decided)
    ]


CALIBRATION = Path(tpvqa_household.calibrations.__file__).with_name("embedded.json")
TRIALS: list[tuple[str, int, tuple[object, ...], tuple[str, ...]]] = [
    ("eat_apple", 7, ("--monitor", "tpvqa"), ()),
    ("serve_breakfast", 20, ("--monitor", "tpvqa"), ("--together",)),
    ("clean_dishes", 3, ("--monitor", "vote:3"), ()),
    ("serve_breakfast", 7, ("--calibration", CALIBRATION), ("--together",)),
]


@pytest.mark.parametrize(("task", "seed", "more", "way"), TRIALS)
def test_a_trial_decides_as_with_the_network_itself(
    tpvqa: Run,
    served: Served,
    task: str,
    seed: int,
    more: tuple[object, ...],
    way: tuple[str, ...],
) -> None:
    words = ("run", task, "--seed", seed, *more, "--out")
    home = tpvqa(*words, "home", "--vlm", "embedded")
    there = ("--vlm", "openai:embedded", "--base-url", served.url)
    away = tpvqa(*words, "away", *there, *way)
    assert away[0] == home[0]
    expected = decisions(read_episode(Path("home")))
    assert len(expected) > 5
    assert decisions(read_episode(Path("away"))) == expected


def see_nothing_invented(folder: Path) -> list[Reply]:
    """Every answer of a trial against the network's own, to the picture that the log keeps."""
    network, found = EmbeddedVLM(), []
    seen: list[bytes] = []
    asked: tuple[str, ...] = ()
    for event in read_episode(folder):
        if isinstance(event, Observed):
            seen = [(folder / frame.file).read_bytes() for frame in event.frames]
        elif isinstance(event, Asked):
            asked = tuple(question.text for question in event.questions)
        elif isinstance(event, Answered):
            frames = {str(n): Frame(str(n), str(n), data) for n, data in enumerate(seen)}
            right = network.ask(Observation(0, 0.0, frames), [worded(text) for text in asked])
            for answer, own in zip(event.answers, right, strict=True):
                found.append(answer.reply)
                if answer.reply in (Reply.YES, Reply.NO):
                    assert answer.reply is own.reply
                    assert answer.p_yes == pytest.approx(own.p_yes, abs=1e-6)
                else:
                    assert answer.reply is Reply.UNKNOWN
    return found


QUICK = [each for each in Fault if each not in (Fault.DELAYED, Fault.TOO_LONG, Fault.DRIP)]


def test_a_trial_through_faults_ends_and_nothing_is_invented(tpvqa: Run, served: Served) -> None:
    chance = random.Random(4)

    def choose(number: int) -> Fault:
        return chance.choice(QUICK) if chance.random() < 0.3 else Fault.NONE

    with FaultyProxy(served.url, choose) as proxy:
        there = ("--vlm", "openai:embedded", "--base-url", proxy.url, "--max-actions", 8)
        code, out, err = tpvqa(
            "run", "eat_apple", "--monitor", "tpvqa", "--seed", 7, *there, "--out", "faulty"
        )
    assert code in (0, 1), out + err
    replies = see_nothing_invented(Path("faulty"))
    assert {Reply.YES, Reply.UNKNOWN} <= set(replies)
    assert len(set(proxy.met)) > 5


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_cleanly_and_the_token_is_never_said(
    tpvqa: Run, pictures: list[Path], monkeypatch: pytest.MonkeyPatch, how: signal.Signals
) -> None:
    with serving("--name", "kitchen-eyes", TPVQA_SERVE_TOKEN=KEY) as found:
        assert found.model == "kitchen-eyes"
        words = ("ask", pictures[0], QUESTIONS[0], "--vlm", "openai:kitchen-eyes")
        code, _, err = tpvqa(*words, "--base-url", found.url)
        assert code == 2
        assert "OPENAI_API_KEY" in err
        monkeypatch.setenv("OPENAI_API_KEY", KEY)
        code, out, _ = tpvqa(*words, "--base-url", found.url)
        assert (code, out.split("?")[1].split()[0] in ("yes", "no")) == (0, True)
        code, said = found.end(how)
    assert code == 0
    assert "1 question answered" in said
    assert "Traceback" not in said
    assert KEY not in said


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("--vlm", "oracle:0.9"), "noise model"),
        (("--vlm", "recorded:gemma-3-12b"), "noise model"),
        (("--vlm", "embeded"), "Did you mean 'embedded'?"),
        (("--vlm", "embedded:/nowhere"), "taught.json: cannot be read"),
        (("--host", "0.0.0.0"), "TPVQA_SERVE_TOKEN"),
        (("--option", "device"), "NAME=VALUE"),
        (("--option", "device=cpu"), "device"),
        (("--option", "truth=1", "--vlm", "oracle"), "'truth' already"),
        (("--token-file", "none"), "no such token file"),
        (("--vlm", "openai:m", "--base-url", "http://127.0.0.1:9/v1"), "cannot be reached"),
    ],
)
def test_what_cannot_be_served_is_said_at_once(
    tpvqa: Run, words: tuple[str, ...], reason: str
) -> None:
    code, out, err = tpvqa("serve-vlm", "--port", 0, *words)
    assert (code, out) == (2, "")
    assert reason in err
    assert err.startswith("error: ")


def test_a_port_that_is_taken_is_said(tpvqa: Run) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        code, _, err = tpvqa("serve-vlm", "--port", port)
    assert code == 2
    assert f"Port {port} at 127.0.0.1" in err


def test_without_the_extra_it_says_what_to_install(
    tpvqa: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    import importlib.util

    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util,
        "find_spec",
        lambda name, *rest: None if name == "fastapi" else find(name, *rest),
    )
    code, _, err = tpvqa("serve-vlm")
    assert code == 2
    assert "packages/tpvqa[serve]" in err


def test_a_vlm_of_ones_own_is_called_as_the_option_calls_it(
    install: Install, tmp_path: Path
) -> None:
    source = "class Own:\n    name = 'of the class'\n    def ask(self, observation, questions):\n"
    answers = "        return [Answer(each, Reply.YES) for each in questions]\n"
    install("own", f"from tpvqa.vlm import Answer, Reply\n{source}{answers}", "mine = own:Own")
    path = os.pathsep.join(filter(None, (str(tmp_path), os.environ.get("PYTHONPATH"))))
    with serving("--vlm", "mine", PYTHONPATH=path) as served:
        assert served.model == "mine"
