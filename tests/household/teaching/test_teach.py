"""`tpvqa train embedded`: a user's own words about pictures of their own domain."""

import json
import os
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image, ImageDraw

from tests.cli.conftest import Run, tpvqa
from tests.household.teaching.lamps import draw, make
from tests.lamps import DOMAIN, PROBLEM, QUESTIONS
from tpvqa_household.embedded.taught import sight
from tpvqa_household.images.manifest import load_pictures
from tpvqa_household.teaching import glimpses

__all__ = ["tpvqa"]
OWN = ("--domain", DOMAIN, "--problem", PROBLEM, "--questions", QUESTIONS)
LEFT, RIGHT = "Is the left lamp lit?", "Is the right lamp lit?"


Words = tuple[object, ...]


def command(pictures: Path, out: str, *more: object) -> Words:
    more = ("--seed", 2, "--epochs", 1, *more)
    return ("train", "embedded", "--pictures", pictures, *OWN, "--out", out, *more)


def answers(tpvqa: Run, folder: Path | str, picture: Path, *questions: str) -> list[dict[str, Any]]:
    code, out, error = tpvqa("ask", picture, *questions, "--json", "--vlm", f"embedded:{folder}")
    assert code == 0, error
    told: list[dict[str, Any]] = json.loads(out)["answers"]
    return told


def test_it_learns_what_is_held_back(lamp_set: Path, tpvqa: Run, tmp_path: Path) -> None:
    code, out, error = tpvqa(*command(lamp_set, "lamps", "--json"))
    assert code == 0, error
    told = json.loads(out)
    assert told["learnt_from"]["pictures"] == 36
    assert told["held_back"]["pictures"] == 12
    assert told["before"]["abstained"]["value"] == 1.0
    assert told["taken_as"] == "embedded:lamps"
    # Of the three questions the one about the room was yes wherever it was told: it stays unknown.
    assert told["balanced_accuracy_by_predicate"]["lit"] >= 0.85
    assert told["balanced_accuracy_by_predicate"]["bright"] is None
    assert any("bright" in each and "needs 3 of each" in each for each in told["notices"])
    assert {path.name for path in (tmp_path / "lamps").iterdir()} == {
        "heads.npz",
        "taught.json",
        "training.json",
    }
    assert not (tmp_path / "lamps.part").exists()
    assert "lamps.part" not in (tmp_path / "lamps" / "taught.json").read_text()


def test_new_pictures_are_answered_and_other_questions_are_not(
    taught: Path, tpvqa: Run, tmp_path: Path
) -> None:
    right = 0
    rng = np.random.default_rng(77)
    for number in range(12):
        left, other = bool(number % 2), bool(number // 2 % 2)
        picture = tmp_path / f"{number}.png"
        draw(rng, left=left, right=other).save(picture)
        told = answers(tpvqa, taught, picture, LEFT, RIGHT)
        right += told[0]["reply"] == ("yes" if left else "no")
        right += told[1]["reply"] == ("yes" if other else "no")
    assert right >= 22
    asked = ("is left lamp lit here", "Is the room bright?", "Is there a cat?", "Is it not lit?")
    known, bright, cat, negated = answers(tpvqa, taught, picture, *asked)
    assert known["reply"] == told[0]["reply"]
    assert [each["reply"] for each in (bright, cat, negated)] == ["unknown"] * 3
    assert "needs 3 of each" in bright["text"]
    assert "no word for cat" in cat["text"]


def test_pictures_unlike_those_taught_are_unknown(taught: Path, tpvqa: Run, tmp_path: Path) -> None:
    rings = Image.new("RGB", (160, 120), "white")
    for size in range(50, 5, -9):
        ImageDraw.Draw(rings).ellipse(
            (80 - size, 60 - size, 80 + size, 60 + size), fill=("red", "navy")[size % 2]
        )
    kitchens = load_pictures()
    kitchen = Image.open(kitchens.folder / kitchens.manifest.pictures[0].file)
    for number, other in enumerate((rings, kitchen)):
        other.save(tmp_path / f"other{number}.png")
        (told,) = answers(tpvqa, taught, tmp_path / f"other{number}.png", LEFT)
        assert told["reply"] == "unknown"
        assert told["text"] == "unlike the pictures it knows"


def test_a_trial_goes_by_it(taught: Path, lamp_set: Path, tpvqa: Run) -> None:
    words: Words = (
        "run",
        DOMAIN,
        PROBLEM,
        "--questions",
        QUESTIONS,
        "--world",
        f"pictures:{lamp_set}",
    )
    words += ("--vlm", f"embedded:{taught}", "--seed", "5", "--out", "episode")
    code, out, error = tpvqa(*words)
    assert code == 0, out + error
    code, out, error = tpvqa("show", "episode")
    assert code == 0, error
    assert LEFT in out


def test_groups_are_held_back_whole(tpvqa: Run, tmp_path: Path) -> None:
    grouped = make(tmp_path / "grouped", 24, groups=2)
    code, out, error = tpvqa(*command(grouped, "lamps", "--json", "--held-back", "0.3"))
    assert code == 0, error
    told = json.loads(out)
    assert (told["learnt_from"]["pictures"], told["held_back"]["pictures"]) == (12, 12)
    assert json.loads((tmp_path / "lamps" / "taught.json").read_text())["groups"] == 1
    assert any("of one group" in each for each in told["notices"])


def test_ctrl_c_loses_nothing(tpvqa: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pictures = make(tmp_path / "set", 24)
    seen: list[int] = []

    def counted(stop_at: int) -> Callable[..., Any]:
        def glimpse(*arguments: Any) -> Any:
            seen.append(1)
            if len(seen) == stop_at:
                os.kill(os.getpid(), signal.SIGINT)
            return sight.glimpsed(*arguments)

        return glimpse

    monkeypatch.setattr(glimpses, "glimpsed", counted(7))
    code, _, error = tpvqa(*command(pictures, "out"))
    assert code == 130
    assert "interrupted" in error
    assert not (tmp_path / "out").exists()
    assert len(seen) == 7
    monkeypatch.setattr(glimpses, "glimpsed", counted(0))
    code, _, error = tpvqa(*command(pictures, "out"))
    assert code == 0, error
    assert "going on with out.part" in error
    assert len(seen) == 18  # those learnt from, each once
    monkeypatch.setattr(glimpses, "glimpsed", sight.glimpsed)
    assert tpvqa(*command(pictures, "whole"))[0] == 0
    for name in ("heads.npz", "taught.json"):
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_what_cannot_be_taught_is_said(tpvqa: Run, taught: Path, tmp_path: Path) -> None:
    few = make(tmp_path / "few", 6)
    code, _, error = tpvqa(*command(few, "out"))
    assert code == 2
    assert "every question needs 3 where it is yes and 3 where it is no" in " ".join(error.split())
    words = ("train", f"embedded:{taught}", *command(few, "other")[2:])
    code, _, error = tpvqa(*words)
    assert code == 2
    assert "all pictures together" in " ".join(error.split())
    assert not (tmp_path / "out.part").exists()  # nothing keeps more pictures from being given
