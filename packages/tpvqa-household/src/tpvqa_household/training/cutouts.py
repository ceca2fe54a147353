"""Things cut out of real photographs, and pasted into other pictures.

`cutouts.csv` holds their outlines, drawn by hand: names and numbers. The photographs themselves
lie where `labelled` reads them.
"""

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFilter

from tpvqa.chance import chance_array
from tpvqa.errors import TpvqaError
from tpvqa.pictures import in_colour, read_picture
from tpvqa_household.training.labelled import COLUMNS, Labelled

OUTLINES = Path(__file__).with_name("cutouts.csv")
SIZES: dict[str, tuple[float, float]] = {
    "apple": (0.08, 0.45),
    "bread": (0.12, 0.6),
    "plate": (0.15, 0.7),
    "knife": (0.15, 0.5),
    "tv": (0.25, 0.7),
    "sink": (0.3, 0.8),
    "fridge": (0.5, 1.0),
}
"""The longer side of what is pasted, as shares of the picture's side: least and greatest."""
_STAND = {"sink", "fridge"}
_TURN = {"apple", "bread", "plate", "knife"}
_COVERED = 0.04
"""Where more of a picture is covered, what was said to be in it may be hidden."""
_HOW_MANY = (1, 1, 2, 3)
_MOST = max(_HOW_MANY)
_FINER = 3
"""Outlines are drawn so many times as large, for smooth edges."""


@dataclass(frozen=True)
class Cutout:
    """A thing without what was around it.

    Attributes:
        thing: A name in `SIZES`.
        group: Of the photograph that it comes from.
        picture: With transparency, cropped to the thing.
    """

    thing: str
    group: str
    picture: Image.Image


@dataclass(frozen=True)
class Pasted:
    """Pictures with cut-outs in them.

    Attributes:
        pixels: n × 224 × 224 × 3.
        labels: n × len(`COLUMNS`): 1 true, 0 false, -1 not known.
        groups: n × k, all the photographs' groups that a picture shows something of; "" for none.
    """

    pixels: NDArray[np.uint8]
    labels: NDArray[np.int64]
    groups: NDArray[np.str_]


def read_cutouts(folder: Path, photographs: Labelled, outlines: Path = OUTLINES) -> list[Cutout]:
    """Cut out what the outlines name, of those photographs only.

    Args:
        folder: Where the photographs' names begin.
        photographs: Others than these are left alone, so that none that measures teaches.
        outlines: Columns file, thing, shape ("ellipse": middle x, y and half axes; "polygon":
            corners x, y, …) and points, in pixels of the photograph.

    Raises:
        TpvqaError: The outlines cannot be read, or a photograph cannot.
    """
    groups = dict(zip(photographs.files, photographs.groups.tolist(), strict=True))
    found = []
    try:
        with outlines.open(encoding="utf-8", newline="") as lines:
            for row in csv.DictReader(lines):
                if row["thing"] not in SIZES:
                    raise ValueError(f"cut-outs of {row['thing']!r} are not known")
                if row["file"] in groups:
                    cut = _cut(folder / row["file"], row["shape"], row["points"])
                    found.append(Cutout(row["thing"], groups[row["file"]], cut))
    except (OSError, UnicodeDecodeError, csv.Error, KeyError, ValueError) as error:
        raise TpvqaError(f"{outlines} cannot be read: {error}") from None
    return found


def _cut(photograph: Path, shape: str, points: str) -> Image.Image:
    picture = in_colour(read_picture(photograph))
    at = [_FINER * float(number) for number in points.split()]
    mask = Image.new("L", (picture.width * _FINER, picture.height * _FINER))
    if shape == "ellipse":
        x, y, wide, high = at
        ImageDraw.Draw(mask).ellipse([x - wide, y - high, x + wide, y + high], fill=255)
    elif shape == "polygon":
        ImageDraw.Draw(mask).polygon(at, fill=255)
    else:
        raise ValueError(f"a shape is 'ellipse' or 'polygon', not {shape!r}")
    picture.putalpha(mask.resize(picture.size, Image.Resampling.BOX))
    return picture.crop(picture.getchannel("A").getbbox())


def pasted(
    scenes: NDArray[np.uint8],
    labels: NDArray[np.int64],
    groups: NDArray[np.str_],
    cutouts: Sequence[Cutout],
    *,
    count: int,
    seed: int,
) -> Pasted:
    """Paste one to three cut-outs into pictures drawn at random, every kind of thing as often.

    Args:
        scenes: m × 224 × 224 × 3.
        labels: m × len(`COLUMNS`), what is true in them without the cut-outs.
        groups: m, whose photographs they are; "" for rendered ones.
        cutouts: At least one.
        count: How many pictures.
        seed: Decides everything.
    """
    by_thing = {t: [c for c in cutouts if c.thing == t] for t in sorted({c.thing for c in cutouts})}
    things, subjects = list(by_thing), list(COLUMNS)
    pixels, told, whose = [], [], []
    for number in range(count):
        rng = chance_array(seed, 0, "cut-outs", number)
        scene = int(rng.integers(len(scenes)))
        picture, label = Image.fromarray(scenes[scene]), labels[scene].copy()
        covered, shown = np.zeros(scenes[scene].shape[:2], bool), [str(groups[scene])]
        chosen = []
        for _ in range(int(rng.choice(_HOW_MANY))):
            of = by_thing[things[int(rng.integers(len(things)))]]
            cut = of[int(rng.integers(len(of)))]
            covered |= _paste(picture, cut, rng)
            chosen.append(cut.thing)
            shown.append(cut.group)
        if covered.mean() > _COVERED:
            label[label == 1] = -1
        for column, subject in enumerate(subjects):
            if subject.arguments[0] in chosen:
                label[column] = 1 if subject.name == "near" else -1
        pixels.append(np.asarray(picture))
        told.append(label)
        whose.append(shown + [""] * (_MOST + 1 - len(shown)))
    return Pasted(np.stack(pixels), np.stack(told), np.array(whose, np.str_))


def _paste(picture: Image.Image, cutout: Cutout, rng: np.random.Generator) -> NDArray[np.bool_]:
    """Paste one thing somewhere, of any size, in other light; which pixels it covers."""
    side, cut = picture.height, cutout.picture
    size = np.exp(rng.uniform(*np.log(SIZES[cutout.thing]))) * side / max(cut.size)
    wide, high = (max(4, round(length * size)) for length in cut.size)
    cut = cut.resize((wide, high), Image.Resampling.LANCZOS, reducing_gap=3)
    if rng.random() < 0.5:
        cut = cut.transpose(Image.Transpose.FLIP_LEFT_RIGHT)
    if cutout.thing in _TURN:
        cut = cut.rotate(rng.uniform(-20, 20), expand=True, resample=Image.Resampling.BICUBIC)
    light = np.exp(rng.uniform(np.log(0.6), np.log(1.3)) + rng.uniform(-0.06, 0.06, 3))
    lit = np.asarray(cut.convert("RGB")) * light
    alpha = cut.getchannel("A").filter(ImageFilter.GaussianBlur(0.7))
    cut = Image.fromarray(np.clip(lit, 0, 255).astype(np.uint8))
    left = int(rng.uniform(-0.1 * cut.width, side - 0.9 * cut.width))
    if cutout.thing in _STAND:
        top = int(side - cut.height * rng.uniform(0.8, 1.05))
    else:
        top = int(rng.uniform(0.3 * side, 1.05 * side) - cut.height)
    top = max(top, -cut.height // 10)
    picture.paste(cut, (left, top), alpha)
    cover = Image.new("L", picture.size)
    cover.paste(alpha, (left, top))
    return np.asarray(cover) > 127
