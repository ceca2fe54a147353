"""Things cut out of photographs and pasted into other pictures."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

pytest.importorskip("torch", reason="training needs torch")

from tpvqa.errors import TpvqaError
from tpvqa_household.training.cutouts import OUTLINES, pasted, read_cutouts
from tpvqa_household.training.labelled import COLUMNS, Labelled

SUBJECTS = list(COLUMNS)
NEAR = {s.arguments[0]: i for i, s in enumerate(SUBJECTS) if s.name == "near"}
OPENED = next(i for i, s in enumerate(SUBJECTS) if s.name == "opened")
HEADER = "file,thing,shape,points\n"


@pytest.fixture
def photographs(tmp_path: Path) -> Labelled:
    """A red disc and a blue square on green, of two homes."""
    picture = np.zeros((100, 100, 3), np.uint8)
    picture[..., 1] = 200
    y, x = np.mgrid[:100, :100]
    picture[(x - 50) ** 2 + (y - 40) ** 2 < 400] = 200, 0, 0
    Image.fromarray(picture).save(tmp_path / "disc.png")
    picture[...] = 0, 200, 0
    picture[20:80, 20:80] = 0, 0, 200
    Image.fromarray(picture).save(tmp_path / "square.png")
    labels = np.zeros((2, len(COLUMNS)), np.int64)
    pixels = np.zeros((2, 224, 224, 3), np.uint8)
    return Labelled(pixels, labels, np.array(["one", "two"]), ["disc.png", "square.png"])


def outlines(tmp_path: Path, text: str) -> Path:
    file = tmp_path / "outlines.csv"
    file.write_text(HEADER + text)
    return file


BOTH = "disc.png,apple,ellipse,50 40 20 20\nsquare.png,fridge,polygon,20 20 80 20 80 80 20 80\n"


def test_only_the_thing_is_cut_out(tmp_path: Path, photographs: Labelled) -> None:
    disc, square = read_cutouts(tmp_path, photographs, outlines(tmp_path, BOTH))
    assert (disc.thing, disc.group, square.thing, square.group) == ("apple", "one", "fridge", "two")
    for cut, colour, size in ((disc, 0, 40), (square, 2, 60)):
        assert abs(cut.picture.width - size) <= 2, cut.picture.size
        pixels = np.asarray(cut.picture)
        solid = pixels[pixels[..., 3] == 255]
        assert (solid[:, colour] == 200).mean() > 0.97


def test_photographs_that_measure_are_left_alone(tmp_path: Path, photographs: Labelled) -> None:
    first = Labelled(
        photographs.pixels[:1], photographs.labels[:1], np.array(["one"]), ["disc.png"]
    )
    (disc,) = read_cutouts(tmp_path, first, outlines(tmp_path, BOTH))
    assert disc.thing == "apple"


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("disc.png,cat,ellipse,1 2 3 4", "cat"),
        ("disc.png,apple,star,1 2 3 4", "star"),
        ("disc.png,apple,ellipse,1 2 x 4", "x"),
    ],
)
def test_bad_outlines_are_told(tmp_path: Path, photographs: Labelled, line: str, said: str) -> None:
    with pytest.raises(TpvqaError, match=said):
        read_cutouts(tmp_path, photographs, outlines(tmp_path, line))


def test_what_is_pasted_is_said_and_what_it_hides_is_not(
    tmp_path: Path, photographs: Labelled
) -> None:
    cutouts = read_cutouts(tmp_path, photographs, outlines(tmp_path, BOTH))
    scenes = np.full((3, 224, 224, 3), 90, np.uint8)
    labels = np.zeros((3, len(COLUMNS)), np.int64)
    labels[:, NEAR["sink"]] = 1
    nobody = np.full(3, "")
    made = pasted(scenes, labels, nobody, cutouts, count=60, seed=4)
    again = pasted(scenes, labels, nobody, cutouts, count=60, seed=4)
    np.testing.assert_array_equal(made.pixels, again.pixels)
    blue = (made.pixels[..., 2].astype(int) - made.pixels[..., 0] > 60).mean((1, 2))
    fridge = made.labels[:, NEAR["fridge"]] == 1
    assert fridge.any()
    assert not fridge.all()
    assert blue[fridge].min() > 0.01 > blue[~fridge].max()
    assert (made.labels[fridge, OPENED] == -1).all()
    assert (made.labels[~fridge, OPENED] == 0).all()
    assert (made.labels[fridge, NEAR["sink"]] == -1).mean() > 0.9  # a fridge hides much
    assert ((made.groups == "two").any(1) == fridge).all()
    assert set(made.labels[:, NEAR["tv"]]) == {0}


def test_the_outlines_name_known_things_and_lie_in_a_picture() -> None:
    lines = OUTLINES.read_text(encoding="utf-8").splitlines()
    assert lines[0] == HEADER.strip()
    for line in lines[1:]:
        _, thing, shape, points = line.split(",")
        assert thing in NEAR
        numbers = [int(n) for n in points.split()]
        assert all(0 <= n <= 336 for n in numbers), line
        assert len(numbers) == 4 if shape == "ellipse" else len(numbers) >= 6
