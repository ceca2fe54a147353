"""Prompts come with the package and can be replaced by the user's own."""

import os
import shutil
from pathlib import Path

import pytest

from tpvqa.errors import PhotosError
from tpvqa_household.images.reachable import Reachable
from tpvqa_household.images.sources.labels import Label, labels
from tpvqa_household.images.sources.prompts import read_prompts, shipped_prompts


def test_every_action_and_outcome_has_a_prompt(shipped_reachable: list[Reachable]) -> None:
    every = labels(shipped_reachable)
    prompts = read_prompts(every)
    assert set(prompts.by_label) == {label.shows for label in every}
    wash = next(label for label in every if str(label).endswith("wash(plate, sink), failure"))
    assert prompts.of(wash, 0) != prompts.of(wash, 1)
    assert prompts.of(wash, 0) == prompts.of(wash, 2)
    assert "dirty" in prompts.of(wash, 0)
    assert prompts.for_variation(wash).startswith(prompts.variation)
    assert "dirty" not in prompts.for_variation(wash, as_usual=False)


def test_own_prompts_go_before_the_shipped_ones(dish_labels: list[Label], tmp_path: Path) -> None:
    shutil.copy(shipped_prompts() / "clean_dishes.yaml", tmp_path)
    path = tmp_path / "clean_dishes.yaml"
    path.write_text(path.read_text().replace("dirty white plate", "muddy blue plate"))
    own, shipped = read_prompts(dish_labels, tmp_path), read_prompts(dish_labels)
    assert any("muddy blue plate" in text for texts in own.by_label.values() for text in texts)
    assert own.camera == shipped.camera


def test_a_pipe_in_place_of_prompts_is_told(dish_labels: list[Label], tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "clean_dishes.yaml")
    with pytest.raises(PhotosError, match=r"clean_dishes.yaml: .*a pipe"):
        read_prompts(dish_labels, tmp_path)


def test_a_broken_file_is_named(dish_labels: list[Label], tmp_path: Path) -> None:
    with pytest.raises(PhotosError, match="none of these files"):
        read_prompts(dish_labels, tmp_path)
    path = tmp_path / "clean_dishes.yaml"
    path.write_text("find(plate):\n  sucess: A plate.\n")
    with pytest.raises(PhotosError, match=r"clean_dishes.yaml:2: .*'sucess' is not known"):
        read_prompts(dish_labels, tmp_path)
    path.write_text("find(plat):\n  success: A plate.\n")
    with pytest.raises(PhotosError, match=r"clean_dishes.yaml:1: .*no action 'find\(plat\)'"):
        read_prompts(dish_labels, tmp_path)
    path.write_text("find(plate):\n  success: A plate.\n")
    with pytest.raises(PhotosError, match=r"no prompt for failure of find\(plate\)"):
        read_prompts(dish_labels, tmp_path)
