"""Recorded answers on the command line: runs that go on and are replayed, and `tpvqa cache`."""

import csv
import json
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from tests.cli.conftest import Run
from tests.conftest import Install
from tests.vlm.chat_server import ChatServer
from tpvqa.episodes.log import LOG
from tpvqa.vlm.kept.upkeep import stats

COIN = """
import os
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.capabilities import NeedsPictures

class Coin(NeedsPictures):
    name = "coin"
    @classmethod
    def from_spec(cls, arguments, *, bias="0.1"):
        assert "NO_VLM" not in os.environ
        made = cls()
        made.bias = float(bias)
        return made
    def ask(self, observation, questions):
        p = [int.from_bytes(os.urandom(2), "big") / 65535 for _ in questions]
        said = [Reply.YES if x > self.bias else Reply.NO for x in p]
        return [Answer(q, r, p_yes=x, source="coin") for q, r, x in zip(questions, said, p)]
"""
TRIAL = ("eat_apple", "--monitor", "tpvqa:3", "--seed", 4, "--max-actions", 12)


def answers(folder: str) -> list[Any]:
    lines = map(json.loads, (Path(folder) / LOG).read_text().splitlines())
    return [event["answers"] for event in lines if event["kind"] == "answered"]


def test_a_trial_is_replayed_without_its_vlm(
    tpvqa: Run, install: Install, monkeypatch: pytest.MonkeyPatch
) -> None:
    install("coins", COIN, "coin = coins:Coin")
    coin = (*TRIAL, "--vlm", "coin")
    first, _, _ = tpvqa("run", *coin, "--record", "a.db", "--out", "one")
    monkeypatch.setenv("NO_VLM", "1")
    again, _, err = tpvqa("run", *coin, "--replay", "a.db", "--out", "two")
    assert "answers are from" in err
    assert "0 were asked" in err
    assert (answers("two"), again) == (answers("one"), first)
    code, _, err = tpvqa("run", *coin[:-2], "--vlm", "embedded", "--replay", "a.db")
    assert (code, "no recorded answers of 'embedded'" in err) == (2, True)
    code, _, err = tpvqa("run", *coin, "--seed", 5, "--replay", "a.db")
    assert (code, "has no recorded answer to" in err) == (2, True)
    code, _, err = tpvqa("run", *coin, "--option", "bias=0.5", "--replay", "a.db")
    assert (code, "with these options" in err) == (2, True)


def test_a_trial_that_was_cut_goes_on_with_its_recorded_answers(
    tpvqa: Run, install: Install
) -> None:
    install("coins", COIN, "coin = coins:Coin")
    tpvqa("run", *TRIAL, "--vlm", "coin", "--cache", "a.db", "--out", "one")
    whole = answers("one")
    log = Path("one") / LOG
    lines = log.read_bytes().splitlines(keepends=True)
    log.write_bytes(b"".join(lines[: len(lines) // 2]))
    cut = len(answers("one"))
    code, _, err = tpvqa("resume", "one")
    assert code == 2
    assert f"--cache {Path('a.db').resolve()}" in err
    tpvqa("resume", "one", "--replay", "a.db")
    assert cut < len(whole)
    assert answers("one") == whole


def test_noise_models_are_not_recorded(tpvqa: Run) -> None:
    code, _, err = tpvqa("run", *TRIAL, "--vlm", "oracle", "--cache", "a.db")
    assert code == 2
    assert "is a noise model" in err


def test_one_use_of_a_file_at_a_time(tpvqa: Run) -> None:
    code, _, err = tpvqa("run", *TRIAL, "--cache", "a.db", "--replay", "a.db")
    assert code == 2
    assert "give one of --cache, --record and --replay" in err


@pytest.fixture
def asked(tpvqa: Run, shipped_picture: Path) -> Path:
    for question in (
        "Is the fridge open?",
        "Is there a plate in the image?",
        "Is the plate clean?",
    ):
        assert tpvqa("ask", shipped_picture, question, "--record", "a.db")[0] == 0
    return Path("a.db")


@pytest.fixture
def shipped_picture() -> Path:
    from tpvqa.cli.picture_sets import shipped_set

    return sorted(shipped_set().glob("**/*.jpg"))[0]


def test_a_picture_is_asked_about_from_the_record(
    tpvqa: Run, asked: Path, shipped_picture: Path
) -> None:
    live = tpvqa("ask", shipped_picture, "Is the fridge open?")
    assert tpvqa("ask", shipped_picture, "Is the fridge open?", "--replay", asked) == live
    code, _, err = tpvqa("ask", shipped_picture, "Is it late?", "--replay", asked)
    assert (code, "no recorded answer to 'Is it late?'" in err) == (2, True)


def test_it_is_counted_and_exported(tpvqa: Run, asked: Path) -> None:
    _, out, _ = tpvqa("cache", "stats", asked)
    assert "3 answers" in out
    assert "embedded" in out
    found = json.loads(tpvqa("cache", "stats", asked, "--json")[1])
    assert (found["answers"], found["schema"]) == (3, 1)
    assert (found["vlms"][0]["name"], found["vlms"][0]["pictures"]) == ("embedded", 1)
    lines = [json.loads(line) for line in tpvqa("cache", "export", asked)[1].splitlines()]
    assert lines[0]["question"] == "Is the fridge open?"
    tpvqa("cache", "export", asked, "--out", "a.csv")
    with Path("a.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["p_yes"] for row in rows] == [repr(line["p_yes"]) for line in lines]


def test_an_export_holds_nothing_that_a_terminal_obeys(tpvqa: Run, install: Install) -> None:
    said = "\x1b[2Jred\r\n\x9b" + "a" * 3000
    install("coins", COIN.replace('source="coin"', f"text={said!r}"), "coin = coins:Coin")
    Image.linear_gradient("L").save("p.png")
    tpvqa("ask", "p.png", "Is it \x1b[31mopen?", "--vlm", "coin", "--record", "a.db")
    tpvqa("cache", "export", "a.db", "--out", "a.csv")
    (row,) = csv.DictReader(Path("a.csv").read_text().splitlines())
    assert row["question"] == r"Is it \x1b[31mopen?"
    assert row["text"] == r"\x1b[2Jred\r\n\x9b" + "a" * 3000
    _, out, _ = tpvqa("cache", "export", "a.db", "--format", "csv")
    assert out.splitlines() == Path("a.csv").read_text().splitlines()


def test_it_is_pruned(tpvqa: Run, asked: Path) -> None:
    for option, left in (
        (("--older-than", "1h"), 3),
        (("--model", "embedded", "--dry-run"), 0),
        (("--max-size", "1M"), 3),
        (("--model", "embedded"), 0),
    ):
        code, out, _ = tpvqa("cache", "prune", asked, *option)
        assert code == 0
        assert f"{left} are left" in out
    assert stats(asked).answers == 0
    wrong: list[tuple[tuple[str, ...], str]] = [
        ((), "Say what is to go"),
        (("--model", "other"), "no answers of 'other'"),
        (("--older-than", "ages"), "not understood"),
    ]
    for words, why in wrong:
        code, _, err = tpvqa("cache", "prune", asked, *words)
        assert code == 2
        assert why in err


def test_a_size_below_that_of_an_empty_file_takes_nothing(tpvqa: Run, asked: Path) -> None:
    code, _, err = tpvqa("cache", "prune", asked, "--max-size", "8K")
    assert code == 2
    said = " ".join(err.split())
    assert "and 8,000 are allowed" in said
    assert stats(asked).answers == 3
    tpvqa("cache", "prune", asked, "--model", "embedded")
    assert f"a file without any answer has {stats(asked).bytes:,} bytes" in said


def test_an_export_writes_over_nothing_and_knows_its_endings(tpvqa: Run, asked: Path) -> None:
    Path("a.csv").write_text("mine")
    code, _, err = tpvqa("cache", "export", asked, "--out", "a.csv")
    assert (code, "--force" in err, Path("a.csv").read_text()) == (2, True, "mine")
    assert tpvqa("cache", "export", asked, "--out", "a.csv", "--force")[0] == 0
    assert Path("a.csv").read_text() != "mine"
    code, _, err = tpvqa("cache", "export", asked, "--out", "a.xls")
    assert code == 2
    assert "Write .csv or .jsonl" in err
    assert not Path("a.xls").exists()
    assert tpvqa("cache", "export", asked, "--out", "a.xls", "--format", "csv")[0] == 0


def test_a_folder_is_called_a_folder(tpvqa: Run, shipped_picture: Path) -> None:
    Path("answers").mkdir()
    for use in ("--cache", "--replay"):
        code, _, err = tpvqa("ask", shipped_picture, "Is it late?", use, "answers")
        assert code == 2
        assert "it is a folder" in err


def test_there_is_nothing_in_no_file(tpvqa: Run) -> None:
    for command in (("stats",), ("export",), ("prune", "--model", "embedded")):
        code, _, err = tpvqa("cache", command[0], "none.db", *command[1:])
        assert code == 2
        assert "none.db" in err
    assert not Path("none.db").exists()


def test_a_servers_answers_are_there_when_it_is_gone(
    tpvqa: Run, shipped_picture: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    monkeypatch.delenv("OPENAI_API_KEY", raising=False)
    words = ("ask", shipped_picture, "Is the fridge open?", "--vlm", "openai:some", "--json")
    with ChatServer(lambda pictures, question: 0.8) as server:
        code, live, _ = tpvqa(*words, "--base-url", server.url, "--cache", "a.db")
        assert code == 0
        requests = len(server.requests)
        assert tpvqa(*words, "--base-url", server.url, "--cache", "a.db")[1] == live
        assert len(server.requests) == requests
    assert json.loads(live)["answers"][0]["p_yes"] == pytest.approx(0.8, abs=0.01)
    assert tpvqa(*words, "--replay", "a.db")[:2] == (0, live)
    assert tpvqa(*words, "--cache", "a.db", "--base-url", server.url)[1] == live
