import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from tpvqa.errors import PictureSetError
from tpvqa.worlds.pictures import MANIFEST
from tpvqa_household.cli.dataset import dataset
from tpvqa_household.images.manifest import load_pictures
from tpvqa_household.images.reachable import Reachable
from tpvqa_household.images.verify import PER_OUTCOME, PER_STATE, verify


def edit(folder: Path, number: int, **changes: object) -> None:
    path = folder / MANIFEST
    document = json.loads(path.read_text())
    document["pictures"][number] |= changes
    path.write_text(json.dumps(document))


def gaps(folder: Path, task: Reachable) -> list[str]:
    return verify(load_pictures(folder), [task]).gaps


def test_a_whole_set_has_no_gaps(painted: Path, clean_dishes: Reachable) -> None:
    report = verify(load_pictures(painted), [clean_dishes])
    assert report.gaps == []
    assert min(report.states.values()) >= PER_STATE
    assert len(report.observations) == 2 * 4
    assert min(report.observations.values()) >= PER_OUTCOME


def test_a_damaged_file_is_found(painted: Path, clean_dishes: Reachable) -> None:
    path = painted / "5.jpg"
    data = bytearray(path.read_bytes())
    data[-20] ^= 1
    path.write_bytes(data)
    assert any("5.jpg: damaged" in gap for gap in gaps(painted, clean_dishes))


def test_a_missing_file_is_found(painted: Path, clean_dishes: Reachable) -> None:
    (painted / "5.jpg").unlink()
    assert gaps(painted, clean_dishes) == ["5.jpg: missing"]


def test_a_file_that_nothing_lists_is_found(painted: Path, clean_dishes: Reachable) -> None:
    (painted / "stray.jpg").write_bytes(b"")
    assert len(gaps(painted, clean_dishes)) == 1


def test_a_state_without_enough_pictures_is_found(painted: Path, clean_dishes: Reachable) -> None:
    path = painted / MANIFEST
    document = json.loads(path.read_text())
    visible = "near(plate), on(plate, floor)"
    dropped = [p for p in document["pictures"] if p["visible"] == visible]
    document["pictures"] = [p for p in document["pictures"] if p["visible"] != visible]
    path.write_text(json.dumps(document))
    for picture in dropped:
        (painted / picture["file"]).unlink()
    assert f"{visible}: 0 pictures, {PER_STATE} needed" in gaps(painted, clean_dishes)


def test_an_untrue_fact_is_found(painted: Path, clean_dishes: Reachable) -> None:
    first = load_pictures(painted).manifest.pictures[0]
    wrong = [fact for fact in first.state if not fact.startswith("(near")] + ["(near knife)"]
    edit(painted, 0, state=wrong)
    assert any("its facts look like" in gap for gap in gaps(painted, clean_dishes))


def test_a_picture_that_shows_what_its_state_leaves_open_is_found(
    painted: Path, clean_dishes: Reachable
) -> None:
    pictures = load_pictures(painted).manifest.pictures
    number = next(k for k, p in enumerate(pictures) if p.visible == "near(sink)")
    edit(painted, number, seen=[*pictures[number].seen, "(on plate floor)"])
    assert any("on(plate, floor)" in gap for gap in gaps(painted, clean_dishes))


IMPOSSIBLE = ["(near plate)", "(near sink)"]


def test_every_impossible_state_is_found(painted: Path, clean_dishes: Reachable) -> None:
    for number in (0, 1):
        edit(painted, number, state=IMPOSSIBLE)
    found = [gap for gap in gaps(painted, clean_dishes) if "no state of the kitchen" in gap]
    assert [gap.partition(":")[0] for gap in found] == ["0.jpg", "1.jpg"]


@pytest.mark.parametrize("change", ["state", "file", "both ways"])
def test_what_is_scored_is_checked_before(change: str, painted: Path) -> None:
    if change == "state":
        edit(painted, 3, state=IMPOSSIBLE)
    elif change == "file":
        (painted / "3.jpg").write_bytes((painted / "4.jpg").read_bytes())
    else:
        told = load_pictures(painted).manifest.pictures
        edit(painted, 3, file=told[4].file, sha256=told[4].sha256)
        other = [fact for fact in told[4].state if fact not in told[4].seen]
        edit(painted, 3, state=other, seen=sorted(told[4].seen))
    words = ["score", "--pictures", str(painted), "--vlm", "no such VLM"]
    result = CliRunner().invoke(dataset, words)
    assert isinstance(result.exception, PictureSetError), result.output
    assert ("4.jpg" if change == "both ways" else "3.jpg") in str(result.exception)


def test_a_wrong_tag_is_found(painted: Path, clean_dishes: Reachable) -> None:
    edit(painted, 0, shows=[])
    assert any("is not an observation" in gap for gap in gaps(painted, clean_dishes))


def test_the_command_fails_on_a_gap_and_lists_it(painted: Path) -> None:
    (painted / "5.jpg").unlink()
    result = CliRunner().invoke(dataset, ["verify", "--pictures", str(painted)])
    assert result.exit_code == 1
    assert "5.jpg: missing" in result.output
    assert "tpvqa dataset build" in result.output


def test_the_shipped_set_is_in_order(shipped_reachable: list[Reachable]) -> None:
    pictures = load_pictures()
    report = verify(pictures, shipped_reachable)
    assert report.gaps == []
    for task in shipped_reachable:
        for visible in task.classes():
            assert len(pictures.of(visible)) >= PER_STATE
    assert abs(report.meshes["known"] - report.meshes["held_out"]) <= len(report.states)
    assert report.size <= 12e6


def test_the_verify_command_passes_on_the_shipped_set() -> None:
    result = CliRunner().invoke(dataset, ["verify"])
    assert result.exit_code == 0, result.output
    machine = CliRunner().invoke(dataset, ["verify", "--json"])
    assert json.loads(machine.stdout)["gaps"] == []


def test_show_takes_the_place_of_such_pages_alone(painted: Path, tmp_path: Path) -> None:
    page, picture = tmp_path / "sheet.html", load_pictures(painted).paths[1]
    page.write_text("<!doctype html>mine")
    words = ["show", "--pictures", str(painted)]
    for out, force in ((page, []), (picture, []), (picture, ["--force"])):
        before = out.read_bytes()
        result = CliRunner().invoke(dataset, [*words, str(out), *force])
        assert isinstance(result.exception, PictureSetError)
        assert out.read_bytes() == before
    for force in (["--force"], []):
        result = CliRunner().invoke(dataset, [*words, str(page), *force])
        assert result.exit_code == 0, result.output
    assert "Pictures of the kitchen" in page.read_text()


def test_show_writes_one_page_with_every_picture(painted: Path, tmp_path: Path) -> None:
    page = tmp_path / "sheet.html"
    result = CliRunner().invoke(dataset, ["show", str(page), "--pictures", str(painted)])
    assert result.exit_code == 0, result.output
    text = page.read_text()
    for picture in load_pictures(painted).manifest.pictures:
        assert f'"{picture.file}":"' in text
    assert "clean_dishes: wash(plate, sink)" in text
