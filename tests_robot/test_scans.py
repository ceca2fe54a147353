"""Toys that others modelled, on the toys' table."""

import json
from pathlib import Path
from zipfile import ZipFile

import pytest

from tpvqa import Atom, TpvqaError, load_task
from tpvqa.tasks import find_task
from tpvqa.worlds import Report
from tpvqa_robots.mishaps import Mishaps
from tpvqa_robots.toys.scans import FILE, SCANS
from tpvqa_robots.world import ToysWorld


def test_a_scanned_toy_is_recognised_picked_up_and_put_into_a_container() -> None:
    files = find_task("collect_biplane")
    assert files.default_world == "toys"
    task = load_task(files.domain, files.problem)
    world = ToysWorld(task, mishaps=Mishaps(), seed=1)
    assert world.truth.holds(Atom("on", ("toy_biplane", "table")))
    for name, words, then in (
        ("find", ("toy_biplane", "table"), Atom("found", ("toy_biplane",))),
        ("pick_up", ("toy_biplane",), Atom("in_hand", ("toy_biplane",))),
        ("find", ("cyan_container", "toy_biplane"), Atom("found", ("cyan_container",))),
        ("place", ("toy_biplane", "cyan_container"), Atom("on", ("toy_biplane", "cyan_container"))),
    ):
        done = world.execute(task.action(name, words))
        assert (done.report, world.truth.holds(then)) == (Report.DONE, True), done.message
    world.close()


@pytest.mark.parametrize(
    ("toys", "said"),
    [
        ("toy_car", "There is no 'toy_car' on the toys' table; there are .*toy_teddy"),
        ("toy_wood toy_teddy toy_train", "has room for 2 toys; the task has toy_wood, toy_teddy"),
    ],
)
def test_what_is_not_there_or_has_no_room_is_said(tmp_path: Path, toys: str, said: str) -> None:
    files = find_task("collect_teddy")
    problem = tmp_path / "problem.pddl"
    text = files.problem.read_text().replace("toy_teddy - toy", f"{toys} - toy")
    problem.write_text(text.replace("toy_teddy", toys.split()[0]) if "teddy" not in toys else text)
    with pytest.raises(TpvqaError, match=said):
        ToysWorld(load_task(files.domain, problem))


def test_the_notice_names_who_made_them() -> None:
    notice = (Path(__file__).parents[1] / "packages" / "tpvqa-robots" / "NOTICE").read_text()
    with ZipFile(FILE) as pack:
        index = json.loads(pack.read("index.json"))
    assert {entry["name"] for entry in index} == {scan.name for scan in SCANS.values()}
    for entry in index:
        line = f"- {entry['creator']}: {entry['name']} (from {entry['pack']}/{entry['model']})"
        assert line in notice.partition(entry["licence"])[2]
