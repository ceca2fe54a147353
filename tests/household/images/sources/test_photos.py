"""Photos of the user's own: labels by folder and by table, and what is wrong with them."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from tpvqa.errors import PhotosError
from tpvqa.pddl import Atom
from tpvqa_household.images.reachable import Reachable
from tpvqa_household.images.sources.labels import Label, labels
from tpvqa_household.images.sources.photos import read_photos, stock

Add = Callable[[str, int], Path]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    path = tmp_path / "photos"
    path.mkdir()
    return path


def test_folders_say_what_photos_show(dish_labels: list[Label], add_photo: Add) -> None:
    add_photo("wash(plate, sink)/success/a.png", 1)
    add_photo("wash_plate_sink/failure/b.PNG", 2)
    add_photo("clean_dishes/find-sink/success/c.png", 3)
    folder = add_photo("find_sink/success/.hidden.png", 4).parents[2]
    (folder / "notes.txt").write_text("by the window")
    found = {photo.name: photo for photo in read_photos(folder, dish_labels)}
    assert {name: str(photo.label) for name, photo in found.items()} == {
        "wash(plate, sink)/success/a.png": "clean_dishes: wash(plate, sink), success",
        "wash_plate_sink/failure/b.PNG": "clean_dishes: wash(plate, sink), failure",
        "clean_dishes/find-sink/success/c.png": "clean_dishes: find(sink), success",
    }
    clean = Atom("clean", ("plate",))
    assert clean in found["wash(plate, sink)/success/a.png"].state
    assert clean not in found["wash_plate_sink/failure/b.PNG"].state


def test_what_is_missing_is_counted_action_by_action(
    dish_labels: list[Label], add_photo: Add
) -> None:
    for number in range(3):
        path = add_photo(f"pick_up_plate/success/{number}.png", number)
    shelves = stock(read_photos(path.parents[2], dish_labels), dish_labels)
    assert len(shelves) == 2 * 4
    counts = {str(shelf.label): (shelf.photos, shelf.missing) for shelf in shelves}
    assert counts.pop("clean_dishes: pick_up(plate), success") == (3, 7)
    assert set(counts.values()) == {(0, 10)}


def test_a_table_says_what_photos_show(dish_labels: list[Label], add_photo: Add) -> None:
    folder = add_photo("one.png", 1).parent
    add_photo("two.png", 2)
    table = folder / "labels.csv"
    table.write_text(
        "file,task,action,outcome,facts\n"
        'one.png,clean_dishes,"find(sink)",failure,(near plate) (on plate floor)\n'
        "two.png,,find_sink,success,\n"
    )
    one, two = read_photos(folder, dish_labels, table=table)
    assert Atom("on", ("plate", "floor")) in one.state
    assert {atom.predicate for atom in one.label.state - one.state} == {"in_hand"}
    assert {atom.predicate for atom in one.state - one.label.state} == {"on", "free"}
    assert two.state == two.label.state


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("one.png,,find_snik,success,", "Did you mean 'find_sink'"),
        ("one.png,,find_sink,sucess,", "'sucess' is no outcome"),
        ("one.png,cleaning,find_sink,success,", "no task 'cleaning'"),
        ("gone.png,,find_sink,success,", "gone.png: cannot be read"),
        ("one.png,,find_sink,success,(on plate moon)", "(on plate moon) is no fact"),
        ("one.png,,find_sink,success,(near plate) (on plate floor)", "not seen after success"),
        ("one.png,,find_sink,success,(near plate) (near sink)", "no state of the kitchen"),
        ("one.png,,find_sink,success,(((", "'(((' is not an atom"),
        ("one.png,,find_sink,success,())", "'()' is not an atom"),
        ("one.png,,find_sink,success,(near plate", "'(near plate' is not an atom"),
        ("one.png,,find_sink,success,(near sink),(on plate floor)", "more cells than the 5"),
        ("a" * 140_000 + ",,find_sink,success,", "is no CSV (field larger than"),
    ],
)
def test_a_wrong_line_of_a_table_is_named(
    line: str, said: str, dish_labels: list[Label], add_photo: Add
) -> None:
    folder = add_photo("one.png", 1).parent
    table = folder / "labels.csv"
    table.write_text(f"file,task,action,outcome,facts\n{line}\n")
    with pytest.raises(PhotosError) as raised:
        read_photos(folder, dish_labels, table=table)
    assert said in str(raised.value)
    assert str(raised.value).startswith(f"{table}:2: ")


def test_a_table_without_a_column_is_refused(dish_labels: list[Label], folder: Path) -> None:
    table = folder / "labels.csv"
    table.write_text("file,outcome\n")
    with pytest.raises(PhotosError, match=r"labels.csv:1: no column 'action'"):
        read_photos(folder, dish_labels, table=table)
    table.write_bytes(b"file,action,outcome\n\xff")
    with pytest.raises(PhotosError, match="cannot be read"):
        read_photos(folder, dish_labels, table=table)
    table.write_text("file,action,Outcome,outcome\n")
    with pytest.raises(PhotosError, match=r"labels.csv:1: the column 'outcome' is there twice"):
        read_photos(folder, dish_labels, table=table)
    table.write_text("a" * 140_000)
    with pytest.raises(PhotosError, match=r"labels.csv:1: is no CSV"):
        read_photos(folder, dish_labels, table=table)
    table.unlink()
    os.mkfifo(table)
    with pytest.raises(PhotosError, match="a pipe or a device"):
        read_photos(folder, dish_labels, table=table)


def test_every_fault_is_listed(dish_labels: list[Label], add_photo: Add) -> None:
    broken = add_photo("find_sink/success/broken.jpg", 1)
    broken.write_bytes(broken.read_bytes()[:60])
    (broken.parent / "phone.heic").write_bytes(b"ftypheic")
    add_photo("find_snik/success/a.png", 2)
    add_photo("find_sink/maybe/b.png", 3)
    with pytest.raises(PhotosError) as raised:
        read_photos(broken.parents[2], dish_labels)
    for said in ("broken.jpg", "phone.heic", "Save it as one", "'find_snik'", "'maybe'"):
        assert said in str(raised.value)


def test_a_photo_that_no_folder_labels_is_an_error(
    dish_labels: list[Label], add_photo: Add
) -> None:
    with pytest.raises(PhotosError, match="lies in no folder that says what it shows"):
        read_photos(add_photo("loose.png", 1).parent, dish_labels)


def test_a_photo_that_no_manifest_can_name_is_an_error(
    dish_labels: list[Label], add_photo: Add
) -> None:
    path = add_photo("find_sink/success/a.jpg", 1)
    path.rename(path.parent / os.fsdecode(b"\xff.jpg"))
    with pytest.raises(PhotosError, match=r"find_sink/success/.*Rename it") as raised:
        read_photos(path.parents[2], dish_labels)
    assert str(raised.value).isprintable()


def test_the_same_photo_twice_is_an_error(dish_labels: list[Label], add_photo: Add) -> None:
    folder = add_photo("find_sink/success/a.png", 1).parents[2]
    add_photo("find_sink/success/b.png", 1)
    with pytest.raises(PhotosError, match=r"the same photo as find_sink/success/a.png"):
        read_photos(folder, dish_labels)


def test_an_action_of_several_tasks_needs_the_task(
    shipped_reachable: list[Reachable], add_photo: Add
) -> None:
    every = labels(shipped_reachable)
    folder = add_photo("serve_breakfast/find_plate/success/a.png", 1).parents[3]
    (photo,) = read_photos(folder, every)
    assert photo.label.shows.task == "serve_breakfast"
    add_photo("find_plate/success/b.png", 2)
    with pytest.raises(PhotosError, match="clean_dishes and serve_breakfast"):
        read_photos(folder, every)


def test_a_pipe_among_photos_is_told(dish_labels: list[Label], add_photo: Add) -> None:
    folder = add_photo("wash_plate_sink/success/a.png", 1).parent
    os.mkfifo(folder / "b.png")
    with pytest.raises(PhotosError, match=r"b\.png: is no regular file"):
        read_photos(folder.parents[1], dish_labels)


def test_no_folder(dish_labels: list[Label], tmp_path: Path) -> None:
    with pytest.raises(PhotosError, match="no such folder"):
        read_photos(tmp_path / "none", dish_labels)
