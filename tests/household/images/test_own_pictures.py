"""`tpvqa dataset build` and `compose` in folders where something lies: nothing of it is lost."""

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Run, tpvqa
from tests.lamps import make_set
from tpvqa.worlds.pictures import MANIFEST, digest
from tpvqa_household.images.manifest import load_pictures, shipped

__all__ = ["tpvqa"]
BUILD = ("dataset", "build", "--renderer", "mujoco", "--limit", "1")
FEW = ("--task", "clean_dishes", "--per-outcome", "1", "--no-fill", "--variations", "none")
COMPOSE = ("dataset", "compose", *FEW)


def held(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def refused(tpvqa: Run, folder: Path, *words: object) -> str:
    """What a command says that refuses a folder, and leaves it as it is."""
    before = held(folder)
    code, _, error = tpvqa(*words, "--out", folder)
    assert code == 2, error
    assert "Traceback" not in error
    assert held(folder) == before
    return " ".join(error.split())


@pytest.mark.parametrize("command", [BUILD, COMPOSE])
def test_a_set_of_ones_own_is_left_alone(
    tpvqa: Run, tmp_path: Path, command: tuple[str, ...]
) -> None:
    own = make_set(tmp_path / "own")
    (own / "unused").mkdir()
    (own / "unused" / "both2.jpg").write_bytes(b"another")
    assert "Name another folder if it is not of" in refused(tpvqa, own, *command)
    (own / MANIFEST).unlink()
    assert "'both2.jpg', which" in refused(tpvqa, own, *command)
    data = (own / "both2.jpg").read_bytes()
    told = load_pictures().manifest.pictures[0].model_dump(mode="json")
    listed = {**told, "file": "both2.jpg", "sha256": digest(data)}
    manifest = {"facts": load_pictures().manifest.facts, "pictures": [listed]}
    for kind in ("rendered", "photo"):
        listed["origin"] = {"kind": kind}
        (own / MANIFEST).write_text(json.dumps(manifest))
        assert "did not make ('both2.jpg' is none of its pictures)" in refused(tpvqa, own, *command)


def test_a_damaged_manifest_costs_no_picture(tpvqa: Run, tmp_path: Path) -> None:
    out = tmp_path / "set"
    assert tpvqa(*COMPOSE, "--out", out)[0] == 0
    whole = held(out)
    (out / MANIFEST).write_bytes(whole[MANIFEST][:-10])
    for command in (BUILD, COMPOSE, (*COMPOSE, "--dry-run")):
        assert "move it away and give the command again that" in refused(tpvqa, out, *command)
    code, _, error = tpvqa("dataset", "verify", "--pictures", out)
    assert (code, "`tpvqa dataset compose` takes up" in " ".join(error.split())) == (2, True)
    (out / MANIFEST).unlink()
    assert tpvqa(*COMPOSE, "--out", out)[0] == 0
    assert held(out) == whole


def test_what_is_put_away_takes_the_place_of_nothing(tpvqa: Run, tmp_path: Path) -> None:
    out = tmp_path / "set"
    assert tpvqa(*COMPOSE, "--out", out)[0] == 0
    listed = {picture.file for picture in load_pictures(out).manifest.pictures}
    (out / "unused").mkdir()
    other = {*(path.name for path in shipped().glob("*.jpg"))} - listed
    unwanted = sorted(other)[0]
    (out / unwanted).write_bytes((shipped() / unwanted).read_bytes())
    (out / "unused" / unwanted).write_bytes(b"another")
    assert f"unused/{unwanted}: is another picture" in refused(tpvqa, out, *COMPOSE)
    (out / "unused" / unwanted).unlink()
    assert tpvqa(*COMPOSE, "--out", out)[0] == 0
    assert not (out / unwanted).exists()
    assert (out / "unused" / unwanted).is_file()


def test_no_picture_is_put_where_a_link_leads(tpvqa: Run, tmp_path: Path) -> None:
    out, outside = tmp_path / "set", tmp_path / "outside"
    assert tpvqa(*COMPOSE, "--out", out)[0] == 0
    outside.mkdir()
    listed = {picture.file for picture in load_pictures(out).manifest.pictures}
    unwanted = sorted({*(path.name for path in shipped().glob("*.jpg"))} - listed)[0]
    (out / unwanted).write_bytes((shipped() / unwanted).read_bytes())
    (out / "unused").symlink_to(outside)
    assert "unused: has to be a folder" in refused(tpvqa, out, *COMPOSE)
    assert not list(outside.iterdir())
    (out / "unused").unlink()
    (out / "unused").write_text("a file")
    assert "unused: has to be a folder" in refused(tpvqa, out, *COMPOSE)
    (out / "unused").unlink()
    assert tpvqa(*COMPOSE, "--out", out)[0] == 0
    assert (out / "unused" / unwanted).is_file()
