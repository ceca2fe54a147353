"""Pieces of photographs join the training pictures as *no* and *cannot see*."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tpvqa_household.training.asking import Asking
from tpvqa_household.training.data import Pictures
from tpvqa_household.training.labels import Label
from tpvqa_household.training.photographs import FIRST, PART, main

ASKING = Asking.about("clean_dishes")


def test_pieces_say_no_to_what_is_not_there_and_cannot_see_the_rest(tmp_path: Path) -> None:
    photographs = tmp_path / "photographs"
    photographs.mkdir()
    noise = np.random.default_rng(0).integers(0, 256, (300, 400, 3), dtype=np.uint8)
    Image.fromarray(noise).save(photographs / "noise.png")
    assert main([str(photographs), str(tmp_path / "data"), "--pieces", "10"]) == 0
    pictures = Pictures(tmp_path / "data", "train", ASKING.subjects, ASKING.actions)
    assert pictures.refresh() == PART
    assert (tmp_path / "data" / f"train-{FIRST}.npz").exists()
    for subject, labels in zip(ASKING.subjects, pictures.labels.T, strict=True):
        expected = {Label.CANNOT_SEE, Label.NO}
        if subject.form == "possible" and subject.name == "find":
            expected = {Label.UNCLEAR}
        elif subject.name == "near":
            expected = {Label.NO}
        elif subject.form == "fact" and len(set(subject.arguments)) == len(subject.arguments):
            expected = {Label.CANNOT_SEE}
        assert set(labels.tolist()) <= expected, subject


def test_a_folder_without_photographs_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(tmp_path), str(tmp_path / "data")]) == 2
    assert "no photographs" in capsys.readouterr().err
    assert not (tmp_path / "data").exists()
