"""A set of pictures that comes from a stranger: its paths stay inside, its faults have a place."""

import json
import os
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from tests.lamps import DOMAIN, PROBLEM, Manifest, edit, make_set
from tpvqa.errors import PictureSetError, TpvqaError
from tpvqa.pddl import Task, load_task
from tpvqa.worlds.pictures import MANIFEST, PictureWorld, digest, load_set
from tpvqa.worlds.simulation import Simulation


@pytest.fixture(scope="module")
def task() -> Task:
    return load_task(DOMAIN, PROBLEM)


@pytest.fixture
def lamps(tmp_path: Path) -> Path:
    return make_set(tmp_path / "lamps")


def world_of(task: Task, folder: Path) -> PictureWorld:
    return PictureWorld(Simulation(task, failure=0.0), folder)


def first(**values: Any) -> Callable[[Manifest], object]:
    return lambda manifest: manifest["pictures"][0].update(values)


@pytest.mark.parametrize(
    "file",
    ["../secret.png", "/etc/hostname", "a/../../secret.png", "", ".", "..", "a//b.png", "./p.png",
     "p.png/", "\x1b[2J.png", "p\0.png", "p\n.png", "\u202egnp.png", 7, None, ["p.png"]],
)  # fmt: skip
def test_a_path_that_leaves_the_folder_is_refused_with_its_place(file: object, lamps: Path) -> None:
    edit(lamps, first(file=file))
    with pytest.raises(PictureSetError, match=r"manifest\.json: pictures\.0\.file: ") as caught:
        load_set(lamps)
    assert str(caught.value).isprintable()


def test_a_link_out_of_the_folder_is_not_followed(lamps: Path, tmp_path: Path, task: Task) -> None:
    secret = tmp_path / "secret.png"
    Image.new("RGB", (8, 8), "red").save(secret)
    (lamps / "dark.png").unlink()
    (lamps / "dark.png").symlink_to(secret)
    edit(lamps, first(sha256=digest(secret.read_bytes())))
    world = world_of(task, lamps)
    for use in (world.check, world.observe):
        with pytest.raises(PictureSetError, match=r"dark\.png: .*link"):
            use()


def test_a_folder_that_is_a_link_is_not_followed(lamps: Path, tmp_path: Path) -> None:
    (lamps / "below").symlink_to(tmp_path)
    (tmp_path / "p.png").write_bytes((lamps / "dark.png").read_bytes())
    edit(lamps, first(file="below/p.png"))
    with pytest.raises(PictureSetError, match=r"p\.png"):
        load_set(lamps).check()


def test_what_is_no_regular_file_or_no_picture_is_told(lamps: Path) -> None:
    (lamps / "dark.png").unlink()
    os.mkfifo(lamps / "dark.png")
    with pytest.raises(PictureSetError, match="no regular file"):
        load_set(lamps).check()
    (lamps / "dark.png").unlink()
    (lamps / "dark.png").write_bytes(b"%!PS-Adobe-3.0 EPSF-3.0")
    with pytest.raises(PictureSetError, match="JPEG, PNG or WebP"):
        load_set(lamps).check()
    (lamps / MANIFEST).unlink()
    os.mkfifo(lamps / MANIFEST)
    with pytest.raises(PictureSetError, match="no regular file"):
        load_set(lamps)


def test_a_set_without_pictures_is_told(lamps: Path) -> None:
    edit(lamps, lambda manifest: manifest.update(pictures=[]))
    with pytest.raises(PictureSetError, match=r"manifest\.json: the set has no pictures\. Mend it"):
        load_set(lamps)


@pytest.mark.parametrize(
    "fact", ["(lit (left))", "(lit left", "lit left)", "((lit left))", "lit(left", "(lit, left)",
             "lit(left right)", "()", "(lit left) (lit right)", "lit" + " x" * 100 + ")"],
)  # fmt: skip
def test_a_fact_that_is_no_atom_is_told_with_its_place(fact: str, lamps: Path) -> None:
    edit(lamps, first(state=[fact]))
    with pytest.raises(PictureSetError, match=r"pictures\.0\.state\.0: .* is not an atom"):
        load_set(lamps)


def test_facts_are_taken_as_they_are_printed_and_as_pddl_writes_them(lamps: Path) -> None:
    facts = ["( lit  left )", "lit(left)", "lit left", "raining", "raining()", "on(a, b)",
             "(>= (battery robot) 20)"]  # fmt: skip
    edit(lamps, first(state=facts))
    told = load_set(lamps).manifest.pictures[0].state
    assert told == (*["(lit left)"] * 3, *["(raining)"] * 2, "(on a b)", facts[-1])


@pytest.mark.parametrize("name", ["pictures", "state", "domain"])
def test_a_name_given_twice_is_told(name: str, lamps: Path) -> None:
    text = (lamps / MANIFEST).read_text()
    (lamps / MANIFEST).write_text(text.replace(f'"{name}": ', f'"{name}": [], "{name}": ', 1))
    with pytest.raises(PictureSetError, match=rf"manifest\.json: '{name}' is given twice .*Mend"):
        load_set(lamps)


@pytest.mark.parametrize("file", ["dark.png", "copy.png"])
def test_labels_that_contradict_each_other_are_told(file: str, lamps: Path) -> None:
    (lamps / "copy.png").write_bytes((lamps / "dark.png").read_bytes())
    again = json.loads((lamps / MANIFEST).read_text())["pictures"][0] | {"file": file}
    edit(lamps, lambda manifest: manifest["pictures"].append(again | {"seen": ["(lit left)"]}))
    load_set(lamps).check()
    edit(lamps, lambda manifest: manifest["pictures"].append(again | {"state": ["(lit right)"]}))
    with pytest.raises(PictureSetError, match=rf"{file}: .* \(lit right\) .*Keep one label"):
        load_set(lamps).check()


JUNK: list[Any] = [
    None, 0, -1, 1e300, True, "", "x", "(", ")", "()", "(lit)", "(lit left left)", "(lit nowhere)",
    "((lit left)", "\x1b[2J", [], ["(lit left)"], {}, {"a": 1}, [[]], "../x.png", "A" * 5000,
    "\ud800",
]  # fmt: skip


def mutated(value: Any, rng: random.Random) -> Any:
    """A manifest with one thing in it exchanged, doubled or gone."""
    if isinstance(value, dict) and value and rng.random() < 0.8:
        key = rng.choice(sorted(value))
        if rng.random() < 0.15:
            return {other: v for other, v in value.items() if other != key}
        return {**value, key: mutated(value[key], rng)}
    if isinstance(value, list) and value and rng.random() < 0.8:
        at = rng.randrange(len(value))
        return [*value[:at], mutated(value[at], rng), *value[at + rng.choice((0, 1, 1)) :]]
    return rng.choice(JUNK)


def test_mutated_manifests_are_read_or_told(lamps: Path, task: Task) -> None:
    whole, rng = json.loads((lamps / MANIFEST).read_text()), random.Random(1)
    messages = []
    for number in range(300):
        text = json.dumps(mutated(whole, rng))
        if number % 3 == 0:
            at = rng.randrange(len(text))
            junk = rng.choice(["", "\0", "{", "]", "\\", "9" * 5000, "[" * 3000])
            text = text[:at] + junk + text[at:]
        (lamps / MANIFEST).write_text(text)
        try:
            world = world_of(task, lamps)
            world.check()
            for lamp in ("left", "right"):
                world.observe()
                world.execute(task.action("switch_on", [lamp]))
        except TpvqaError as error:
            messages.append(str(error))
    assert len(messages) > 150
    for message in messages:
        assert len(message) < 2000
        assert message.isprintable()
        assert str(lamps) in message or "No picture shows" in message
