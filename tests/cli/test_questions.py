"""`tpvqa questions` and `tpvqa ask`, as a user types them."""

import json
import os
import pty
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from io import BytesIO
from pathlib import Path

import pytest
from PIL import Image

from tests.test_pictures import png_that_says
from tests.vlm.chat_server import Act, ChatServer
from tpvqa.cli import main

Run = Callable[..., tuple[int, str, str]]
TIMED = Path(__file__).parents[2] / "examples/timed/laboratory"
GRIPPER = """
(define (domain gripper) (:predicates (at-robby ?r) (carry ?o ?g) (at ?o ?r))
  (:action move :parameters (?from ?to) :precondition (at-robby ?from)
    :effect (and (at-robby ?to) (not (at-robby ?from)))))
"""
GOING = """
(define (problem going) (:domain gripper) (:objects hall kitchen)
  (:init (at-robby hall)) (:goal ({goal} kitchen)))
"""


@pytest.fixture
def tpvqa(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run the command: its exit code, stdout and stderr."""
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    monkeypatch.delenv("OPENAI_API_KEY", raising=False)
    monkeypatch.delenv("OPENAI_BASE_URL", raising=False)

    def run(*words: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["tpvqa", *map(str, words)])
        with pytest.raises(SystemExit) as end:
            main()
        out, err = capsys.readouterr()
        return int(end.value.code or 0), out, err

    return run


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    domain, problem = tmp_path / "domain.pddl", tmp_path / "problem.pddl"
    domain.write_text(GRIPPER)
    problem.write_text(GOING.format(goal="at-robby"))
    return domain, problem


def _red() -> Image.Image:
    """Red, with a dark edge: a picture of one colour shows nothing."""
    red = Image.new("RGB", (8, 8), "red")
    red.paste("black", (0, 6, 8, 8))
    return red


@pytest.fixture
def picture(tmp_path: Path) -> Path:
    path = tmp_path / "kitchen.png"
    _red().save(path)
    return path


def test_every_question_of_the_plan_is_printed_for_each_way_of_asking(tpvqa: Run) -> None:
    code, out, err = tpvqa("questions", "clean_dishes")
    assert (code, err) == (0, "")
    assert out.splitlines()[-7:] == [
        "4. wash the plate",
        "   precondition: Is the plate in a robot's hand? yes",
        "   precondition: Is there a sink in the image? yes",
        "   possible: Is it possible to wash the plate here? yes",
        "   effect: Is the plate clean? yes",
        "   successful: Was wash the plate successful? yes",
        "   did: Did the robot successfully wash the plate? yes",
    ]
    assert "   effect: Is the plate on the table? no" in out


def test_they_are_printed_as_json(tpvqa: Run) -> None:
    code, out, _ = tpvqa("questions", "eat_apple", "--json")
    found = json.loads(out)
    assert code == 0
    assert found["task"] == "eat_apple"
    assert found["notices"] == []
    assert [action["say"] for action in found["actions"]] == [
        "find the fridge",
        "open the fridge",
        "find the apple",
        "pick up the apple",
        "find the knife",
        "pick up the knife",
        "cut the apple in half",
    ]
    pick_up = found["actions"][3]
    assert (pick_up["name"], pick_up["arguments"]) == ("pick_up", ["apple", "fridge", "left"])
    assert pick_up["done"] == "picked up the apple"
    assert {
        "way": "effect",
        "text": "Is the apple in the fridge?",
        "expected": "no",
        "fact": "(on apple fridge)",
    } in pick_up["questions"]
    assert [entry["fact"] for entry in pick_up["not_asked"]] == ["(free left)", "(not (free left))"]
    assert all(entry["because"] for entry in pick_up["not_asked"])


def test_in_a_terminal_they_stand_in_a_table() -> None:
    ours, theirs = pty.openpty()
    command = "from tpvqa.cli import main; main()"
    out = b""
    with subprocess.Popen(
        [sys.executable, "-c", command, "questions", "clean_dishes"],
        stdout=theirs,
        env={**os.environ, "TERM": "xterm", "COLUMNS": "100"},
    ) as process:
        os.close(theirs)
        with suppress(OSError):  # what a terminal gives at its end
            while piece := os.read(ours, 4096):
                out += piece
    os.close(ours)
    assert process.returncode == 0
    text = out.decode()
    assert "Way of asking" in text
    assert "4. wash the plate" in text


def test_ones_own_files_fall_back_and_say_so(tpvqa: Run, files: tuple[Path, Path]) -> None:
    domain, problem = files
    code, out, err = tpvqa("questions", "--domain", domain, "--problem", problem)
    assert code == 0
    assert "1. move the hall (kitchen)" in out
    assert "No question is given for the predicate at-robby" in err


def test_ones_own_questions_are_used_and_their_mistakes_reported(
    tpvqa: Run, files: tuple[Path, Path], tmp_path: Path
) -> None:
    domain, problem = files
    words = tmp_path / "words.yaml"
    given = ("questions", "--domain", domain, "--problem", problem, "--questions", words)
    words.write_text('predicates: {at-robby: "Is this the {r}?"}\n')
    assert "precondition: Is this the hall? yes" in tpvqa(*given)[1]
    words.write_text('predicates:\n  at_robby: "Is this the {r}?"\n')
    code, out, err = tpvqa(*given)
    assert (code, out) == (2, "")
    assert f"{words}:2: " in err
    assert "Did you mean 'at-robby'?" in err


def test_a_task_without_a_plan_and_bad_input_have_their_own_exit_codes(
    tpvqa: Run, files: tuple[Path, Path]
) -> None:
    domain, problem = files
    problem.write_text(GOING.format(goal="not (at-robby"))
    assert tpvqa("questions", "--domain", domain, "--problem", problem)[0] == 2
    problem.write_text(GOING.format(goal="carry hall"))
    code, out, err = tpvqa("questions", "--domain", domain, "--problem", problem)
    assert (code, out) == (3, "")
    assert "no plan" in err
    for words in ((), ("clean_dishes", "--domain", domain), ("--domain", domain)):
        assert tpvqa("questions", *words)[0] == 2
    assert "Did you mean 'eat_apple'" in tpvqa("questions", "eat_aple")[2]


def test_a_planner_that_can_is_named_and_taken_where_actions_last(tpvqa: Run) -> None:
    pytest.importorskip("up_aries")
    files = [TIMED / "domain.pddl", TIMED / "problem.pddl"]
    code, _, said = tpvqa("questions", *files)
    assert code != 0
    assert "up:aries" in said
    code, out, _ = tpvqa("questions", *files, "--planner", "up:aries")
    assert code == 0
    assert "Is the scalpel in the autoclave?" in out


def test_asking_prints_answer_and_probability(tpvqa: Run, picture: Path) -> None:
    seen: list[bytes] = []

    def answerer(pictures: object, question: str) -> float | str:
        assert isinstance(pictures, tuple)
        seen.extend(pictures)
        return {"Is it red?": 0.97, "Is it blue?": 0.125}.get(question, "Yes and no")

    with ChatServer(answerer) as server:
        code, out, err = tpvqa(
            "ask", picture, "Is it red?", "Is it blue?", "Is it warm?",
            "--vlm", "openai:test", "--base-url", server.url,
        )  # fmt: skip
    assert (code, err) == (0, "")
    assert out.splitlines() == [
        "Is it red? yes (P(yes) = 0.970)",
        "Is it blue? no (P(yes) = 0.125)",
        "Is it warm? unknown (no probability: Yes and no)",
    ]
    assert set(seen) == {picture.read_bytes()}


def test_asking_prints_json_and_turns_other_formats_into_png(tpvqa: Run, tmp_path: Path) -> None:
    path = tmp_path / "kitchen.webp"
    _red().save(path, lossless=True)
    with ChatServer(lambda *_: 0.75) as server:
        code, out, _ = tpvqa(
            "ask", path, "Is it red?", "--vlm", "openai:test", "--base-url", server.url, "--json"
        )
    found = json.loads(out)
    assert code == 0
    assert (found["vlm"], found["image"]) == ("openai:test", str(path))
    (answer,) = found["answers"]
    assert (answer["question"], answer["reply"]) == ("Is it red?", "yes")
    assert answer["p_yes"] == pytest.approx(0.75)
    assert answer["source"] == "logprobs"
    with Image.open(BytesIO(server.requests[0].pictures[0])) as sent:
        assert (sent.format, sent.getpixel((3, 3))) == ("PNG", (255, 0, 0))


def test_what_is_no_picture_and_a_server_that_refuses_are_clear_errors(
    tpvqa: Run, picture: Path, tmp_path: Path
) -> None:
    text = tmp_path / "text.png"
    text.write_text("not a picture")
    cut = tmp_path / "cut.png"
    cut.write_bytes(picture.read_bytes()[:40])
    for path in (text, cut, tmp_path, tmp_path / "missing.png"):
        code, out, err = tpvqa("ask", path, "Is it red?", "--vlm", "openai:test")
        assert (code, out) == (2, "")
        assert str(path) in err
    refusing: Callable[..., Act] = lambda *_: Act(401, {"error": "no"})  # noqa: E731
    with ChatServer(lambda *_: 0.5, script=refusing) as server:
        code, _, err = tpvqa(
            "ask", picture, "Is it red?", "--vlm", "openai:test", "--base-url", server.url
        )
    assert code == 2
    assert "OPENAI_API_KEY" in err
    assert "noise model" in tpvqa("ask", picture, "Is it red?", "--vlm", "oracle")[2]
    assert "OPENAI_API_KEY" in tpvqa("ask", picture, "Is it red?", "--vlm", "openai:test")[2]


def test_the_papers_wording_is_for_whole_actions_alone(tpvqa: Run) -> None:
    _, usual, _ = tpvqa("questions", "clean_dishes")
    code, paper, _ = tpvqa("questions", "clean_dishes", "--wording", "paper")
    assert code == 0
    assert "   successful: Was wash plate successful? yes" in paper.splitlines()
    assert "   effect: Is the plate clean? yes" in paper.splitlines()
    changed = set(paper.splitlines()) - set(usual.splitlines())
    assert {line.split(":")[0].strip() for line in changed} == {"possible", "successful", "did"}
    assert tpvqa("questions", "clean_dishes", "--wording", "loud")[0] == 2


def test_a_picture_that_is_none_too_large_or_without_end_is_told_at_once(
    tpvqa: Run, picture: Path, tmp_path: Path
) -> None:
    eps = tmp_path / "drawing.eps"
    eps.write_text("%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\nshowpage\n")
    pipe = tmp_path / "pipe.png"
    os.mkfifo(pipe)
    large = tmp_path / "large.png"
    large.write_bytes(png_that_says(13_000, 13_000))
    for path, said in (
        (eps, "JPEG, PNG or WebP"),
        (pipe, "no regular file"),
        ("/dev/zero", "no regular file"),
        (large, "more than 50 million pixels"),
    ):
        code, out, err = tpvqa("ask", path, "Is it red?", "--vlm", "openai:test")
        assert (code, out) == (2, "")
        assert str(path) in err
        assert said in err


def test_a_dead_camera_is_told_whoever_is_asked(tpvqa: Run, tmp_path: Path) -> None:
    path = tmp_path / "dark.png"
    Image.new("RGB", (64, 64)).save(path)
    with ChatServer(lambda *_: 0.01) as server:
        words = ("--vlm", "openai:test", "--base-url", server.url)
        code, out, _ = tpvqa("ask", path, "Is it red?", *words)
    assert code == 0
    assert out == "Is it red? cannot see (no probability: the picture is black all over)\n"
    assert not server.requests
