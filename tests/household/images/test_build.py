"""Making pictures: needs MuJoCo and software GL. Cycles itself is not run here."""

import fcntl
import json
import os
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from tpvqa.errors import PictureSetError, WorldError
from tpvqa.worlds.pictures import MANIFEST
from tpvqa_household.cli.dataset import dataset
from tpvqa_household.images.blender import VARIABLE, Cycles, find_blender_python
from tpvqa_household.images.build import Settings, build
from tpvqa_household.images.manifest import load_pictures
from tpvqa_household.images.reachable import Reachable
from tpvqa_household.images.recipe import FACTS, Job, jobs, objection
from tpvqa_household.images.verify import verify


@pytest.fixture
def few(clean_dishes: Reachable) -> list[Job]:
    return jobs([clean_dishes])[:2]


def modified(folder: Path) -> dict[str, int]:
    return {path.name: path.stat().st_mtime_ns for path in folder.glob("*.jpg")}


@pytest.mark.rendering
def test_a_build_that_was_stopped_goes_on_where_it_was(few: list[Job], tmp_path: Path) -> None:
    def stop(done: int, total: int) -> None:
        if done == 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        build(few, tmp_path, Settings("mujoco"), progress=stop)
    first = modified(tmp_path)
    assert len(first) == 1
    assert len(load_pictures(tmp_path).manifest.pictures) == 1

    told = []
    build(few, tmp_path, Settings("mujoco"), progress=lambda done, total: told.append(done))
    assert told == [1, 2]
    assert first.items() <= modified(tmp_path).items()
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".jpg", ".jpg", ".json"]


@pytest.mark.rendering
def test_what_is_built_is_true_and_the_same_again(
    few: list[Job], clean_dishes: Reachable, tmp_path: Path
) -> None:
    one = build(few, tmp_path / "one", Settings("mujoco"))
    two = build(few, tmp_path / "two", Settings("mujoco"))
    assert one == two
    gaps = verify(load_pictures(tmp_path / "one"), [clean_dishes]).gaps
    assert all("needed" in gap for gap in gaps), "only counts may be short"
    for job, picture in zip(few, sorted(one.pictures, key=lambda p: p.seed or 0), strict=True):
        assert picture.true_state in job.states
        for atom in job.visible:
            assert any(fact.startswith(f"({atom.predicate} ") for fact in picture.seen)


@pytest.mark.rendering
def test_a_damaged_picture_is_made_again(few: list[Job], tmp_path: Path) -> None:
    manifest = build(few[:1], tmp_path, Settings("mujoco"))
    path = tmp_path / manifest.pictures[0].file
    whole = path.read_bytes()
    path.write_bytes(whole[:-10])
    build(few[:1], tmp_path, Settings("mujoco"))
    assert path.read_bytes() == whole


def test_two_builds_do_not_share_a_folder(tmp_path: Path) -> None:
    lock = os.open(tmp_path, os.O_RDONLY)
    fcntl.flock(lock, fcntl.LOCK_EX)
    try:
        with pytest.raises(PictureSetError, match="another build"):
            build([], tmp_path, Settings("mujoco"))
    finally:
        os.close(lock)


def test_a_build_deletes_no_set_that_was_composed(
    painted: Path, few: list[Job], clean_dishes: Reachable
) -> None:
    path = painted / MANIFEST
    document = json.loads(path.read_text())
    document["pictures"][0]["origin"] = {"kind": "photo", "source": "kitchen.jpg"}
    path.write_text(json.dumps(document))
    before = modified(painted)
    with pytest.raises(PictureSetError, match="Name another folder"):
        build(few, painted, Settings("mujoco"))
    assert modified(painted) == before


def test_a_view_that_hides_what_matters_cannot_serve(few: list[Job]) -> None:
    job = few[0]
    state = job.states[0]
    true = {atom: atom in state for atom in FACTS}
    assert objection(job, state, true, dict.fromkeys(FACTS, False)) is not None
    wrong = {**true, FACTS[0]: not true[FACTS[0]]}
    assert "arranged" in (objection(job, state, wrong, dict.fromkeys(FACTS, True)) or "")


def test_a_view_that_shows_what_its_state_leaves_open_cannot_serve(
    clean_dishes: Reachable,
) -> None:
    job = next(job for job in jobs([clean_dishes]) if job.key[0] == "near(sink)")
    state = job.states[0]
    true = {atom: atom in state for atom in FACTS}
    everything = dict.fromkeys(FACTS, True)
    assert "not all states" in (objection(job, state, true, everything) or "")


def test_cycles_without_blender_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    with pytest.raises(WorldError, match="--blender-python"):
        find_blender_python()
    with pytest.raises(WorldError, match="no module `bpy`"):
        find_blender_python(Path(sys.executable))
    with pytest.raises(WorldError, match="cannot be run"):
        find_blender_python(Path("no/such/python"))


def test_a_blender_that_dies_is_reported(tmp_path: Path) -> None:
    """This Python has no bpy: the process ends at once, and what it said is passed on."""
    with pytest.raises(WorldError, match="bpy"):
        Cycles(Path(sys.executable))


def test_the_build_command_needs_blender_for_cycles(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    result = CliRunner().invoke(dataset, ["build", "--out", str(tmp_path / "set")])
    assert isinstance(result.exception, WorldError)
    assert VARIABLE in str(result.exception)
    assert not (tmp_path / "set").exists()
