"""Measuring the network on labelled photographs of a folder."""

import shutil
import sys
from pathlib import Path

import pytest

from benchmarks.real_photographs import Asked, ask_all, main, table
from tpvqa.pddl import Atom
from tpvqa.vlm import Reply
from tpvqa_household.embedded import EmbeddedVLM
from tpvqa_household.images.manifest import load_pictures
from tpvqa_household.training.labelled import COLUMNS

NEAR_TV = Atom("near", ("tv",))
WITHOUT_ANSWERS = [(True, 0.4), (True, 0.2), (False, 0.3), (False, 0.1)]


def _folder(folder: Path) -> Path:
    """Two pictures: one of a TV, and one of which nobody says whether a TV is there."""
    pictures = load_pictures()
    shown = next(p for p in pictures.manifest.pictures if NEAR_TV in p.true_state)
    shutil.copy(pictures.folder / shown.file, folder / "a.jpg")
    told = {"tv": "1", "apple": "0"}
    known = [told.get(column, "") for column in COLUMNS.values()]
    rows = [
        ("file", "split", "group", *COLUMNS.values()),
        ("a.jpg", "test", "home", *known),
        ("a.jpg", "test", "home", *[""] * len(COLUMNS)),
        ("not_there.jpg", "train", "other home", *known),
    ]
    (folder / "labels.csv").write_text("\n".join(map(",".join, rows)))
    return folder


def test_only_what_is_labelled_in_the_split_is_asked_and_counted(tmp_path: Path) -> None:
    asked = ask_all(EmbeddedVLM(), _folder(tmp_path), "test")
    assert {(one.thing, one.there) for one in asked} == {("tv", True), ("apple", False)}
    assert {one.thing: one.reply for one in asked} == {"tv": Reply.YES, "apple": Reply.NO}
    lines = table(asked).splitlines()
    assert lines[2].startswith("| tv | 1 | – | 1.00 (0.21–1.00) | 0.00")
    assert lines[3].startswith("| apple | 0 | – | – | – | – | 1 | 0.00")
    assert lines[-1].startswith("| all | 1 | – | 1.00")


def test_how_well_p_yes_tells_is_measured_before_any_abstention() -> None:
    unknown = [Asked("tv", there, Reply.UNKNOWN, None, p) for there, p in WITHOUT_ANSWERS]
    assert table(unknown).splitlines()[2].startswith("| tv | 2 | 0.750 (")


@pytest.mark.parametrize("labels", [None, "file,split\n", "", "\xff"])
def test_labels_that_cannot_be_used_are_told(
    tmp_path: Path,
    labels: str | None,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    if labels is not None:
        (tmp_path / "labels.csv").write_text(labels, encoding="latin-1")
    monkeypatch.setattr(sys, "argv", ["real_photographs.py", str(tmp_path)])
    assert main() == 2
    assert "labels.csv" in capsys.readouterr().err
