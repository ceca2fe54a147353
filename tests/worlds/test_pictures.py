"""The world of labelled pictures, on a few pictures of lamps that are made on the spot."""

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from tests.lamps import (
    BRIGHT,
    DOMAIN,
    LEFT,
    PICTURES,
    PROBLEM,
    QUESTIONS,
    RIGHT,
    Manifest,
    edit,
    make_set,
    without,
)
from tpvqa.bench.labelled_pictures import ask_pictures
from tpvqa.errors import CalibrationError, PictureSetError, PluginError
from tpvqa.observation import Observation
from tpvqa.pddl import Action, Atom, Task, load_task
from tpvqa.questions import Question, QuestionBook
from tpvqa.vlm import Answer, Reply
from tpvqa.worlds import Report, Restorable, World
from tpvqa.worlds.pictures import PictureWorld, load_set
from tpvqa.worlds.simulation import Simulation

Change = Callable[[Manifest], object]


@pytest.fixture(scope="module")
def task() -> Task:
    return load_task(DOMAIN, PROBLEM)


@pytest.fixture
def lamps(tmp_path: Path) -> Path:
    return make_set(tmp_path / "lamps")


def world_of(task: Task, folder: Path, **options: Any) -> PictureWorld:
    simulation = Simulation(task, failure=0.0, **options)
    return PictureWorld.from_spec(str(folder), simulation=simulation)


def switch(task: Task, lamp: str) -> Action:
    return task.action("switch_on", [lamp])


def drawn(world: PictureWorld, looks: int = 30) -> list[str]:
    return [world.observe().frames["front"].source for _ in range(looks)]


def test_it_is_a_world_that_can_be_restored(task: Task, lamps: Path) -> None:
    world = world_of(task, lamps)
    assert isinstance(world, World)
    assert isinstance(world, Restorable)


def test_what_is_drawn_fits_and_shows_as_much_as_any(task: Task, lamps: Path) -> None:
    world = world_of(task, lamps)
    world.check()
    assert set(drawn(world)) == {"dark.png"}
    world.execute(switch(task, "left"))
    assert set(drawn(world)) == {"left.png", "wall.png"}  # the close-up shows less than the first
    assert world.truth.holds(Atom.parse(BRIGHT))
    world.execute(switch(task, "right"))
    assert set(drawn(world)) == {"both.png", "both2.jpg", "wall.png"}


def test_a_close_up_is_drawn_where_nothing_better_is_there(task: Task, lamps: Path) -> None:
    edit(lamps, without("left.png"))
    world = world_of(task, lamps)
    world.execute(switch(task, "left"))
    assert set(drawn(world)) == {"close.png", "wall.png"}
    while world.observe().frames["front"].source != "close.png":
        pass
    assert world.truth.visible(Atom.parse(LEFT))
    assert not world.truth.visible(Atom.parse(RIGHT))


def test_the_same_trial_sees_the_same_pictures(task: Task, lamps: Path) -> None:
    first, again, other = (world_of(task, lamps, seed=seed) for seed in (1, 1, 2))
    for world in (first, again, other):
        world.execute(switch(task, "left"))
    seen = drawn(first)
    assert seen == drawn(again)
    assert seen != drawn(other)


def test_frames_are_of_the_pictures_own_type(task: Task, lamps: Path) -> None:
    world = world_of(task, lamps)
    for lamp in ("left", "right"):
        world.execute(switch(task, lamp))
    for _ in range(20):
        frame = world.observe().frames["front"]
        assert frame.media_type == f"image/{'jpeg' if frame.source.endswith('jpg') else 'png'}"
        assert frame.data == (lamps / frame.source).read_bytes()


def test_a_state_that_no_picture_shows_is_refused(task: Task, lamps: Path) -> None:
    edit(lamps, without("right.png", "wall.png"))
    world = world_of(task, lamps)
    refused = world.execute(switch(task, "right"))
    assert refused.report is Report.UNAVAILABLE
    assert refused.message == (
        "no picture shows what switch_on(right) could lead to: lit(right). "
        "Add a picture of it to the set and its manifest.json"
    )
    assert set(drawn(world)) == {"dark.png"}
    world.simulation.execute(switch(task, "right"))
    with pytest.raises(PictureSetError, match=r"No picture shows: lit\(right\)\. Add a picture"):
        world.observe()


def test_it_goes_on_where_it_was(task: Task, lamps: Path) -> None:
    world, other = world_of(task, lamps), world_of(task, lamps)
    world.execute(switch(task, "left"))
    drawn(world, 3)
    kept = json.loads(json.dumps(world.snapshot()))
    expected = drawn(world)
    other.restore(kept)
    assert drawn(other) == expected
    with pytest.raises(PictureSetError, match=r"'gone\.png', which is not in"):
        other.restore({**kept, "picture": "gone.png"})


def first(**changes: object) -> Change:
    return lambda manifest: manifest["pictures"][0].update(changes)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda manifest: manifest.update(domain="toys"), "of the domain 'toys', and the task"),
        (lambda manifest: manifest.update(version=2), "version: Input should be 1"),
        (lambda manifest: manifest.update(pictures=[]), "the set has no pictures"),
        (first(seen=["(litt left)"]), r"dark\.png: \(litt left\) .* Did you mean 'lit'"),
        (first(state=["()"]), r"pictures\.0\.state\.0: .*is not an atom"),
        (first(sha256="0"), r"dark\.png: its SHA-256 is not the manifest's"),
        (first(file="gone.png"), r"gone\.png: cannot be read"),
        (first(file="dark.gif"), r"ends in \.jpg or \.png"),
    ],
)
def test_a_set_that_is_wrong_is_refused_before_anything_moves(
    task: Task, lamps: Path, change: Change, says: str
) -> None:
    edit(lamps, change)
    with pytest.raises(PictureSetError, match=says):
        world_of(task, lamps).check()


def test_a_set_has_to_be_named_and_to_be_there(task: Task, tmp_path: Path) -> None:
    with pytest.raises(PluginError, match="pictures:FOLDER"):
        PictureWorld.from_spec("", simulation=Simulation(task))
    with pytest.raises(PictureSetError, match=r"nowhere/manifest\.json: cannot be read"):
        world_of(task, tmp_path / "nowhere").check()


class Sayer:
    """Says yes to everything."""

    name = "sayer"

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        return [Answer(question, Reply.YES) for question in questions]


def test_pictures_that_look_alike_are_the_looks_of_one_trial(task: Task, lamps: Path) -> None:
    book = QuestionBook.load(QUESTIONS, task)
    rows = ask_pictures(Sayer(), load_set(lamps), [book])
    trials = dict(zip(PICTURES, dict.fromkeys(row.look for row in rows), strict=True))
    of_look = {row.look: row.trial for row in rows}
    assert of_look[trials["both.png"]] == of_look[trials["both2.jpg"]]
    assert len(set(of_look.values())) == len(PICTURES) - 1
    with pytest.raises(CalibrationError, match="no fact of this set"):
        ask_pictures(Sayer(), load_set(lamps))


def test_the_documentations_code_labels_a_set(task: Task, lamps: Path) -> None:
    page = (Path(__file__).parents[2] / "docs" / "pictures.md").read_text()
    code = page.partition("```python\n")[2].partition("```")[0]
    before = load_set(lamps).manifest
    names: dict[str, Any] = {}
    exec(code, names)
    names["label"](lamps, PICTURES)
    after = load_set(lamps)
    assert after.manifest == before
    world_of(task, lamps).check()
