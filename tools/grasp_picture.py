"""What the network says of some things: `python tools/grasp_picture.py FILE`, from a clone.

A column for each: its depth image, where the network would grasp, and the best grasp.
"""

import sys
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from tpvqa.chance import chance_array
from tpvqa_robots.grasps.above import PIXEL, SIDE, from_above
from tpvqa_robots.grasps.ggcnn import ggcnn, maps_of
from tpvqa_robots.grasps.training.bench import Bench
from tpvqa_robots.grasps.training.catalogue import named
from tpvqa_robots.grasps.training.sight import points_of, window
from tpvqa_robots.toys.cameras import Errors
from tpvqa_robots.toys.room import TABLE

THINGS = ("mug", "teddy-manitislate", "rubik-farcgs", "train-toy", "biplane-toy", "horseshoe")
CUT, LARGE = 120, 2
"""Pixels that are shown of a side, and how much larger."""


def column(name: str) -> Image.Image:
    """The three pictures of a thing, one above the other."""
    for number in range(20):
        rng = chance_array(5, number, "picture", name)
        bench = Bench([named(name, rng)], rng)
        if bench.settled:
            break
    points = points_of(window(bench.depth()), rng, Errors())
    thing = points[:, 2] > TABLE + 0.01
    middle = np.nanmedian(points[thing], axis=0)
    centre = float(middle[0]), float(middle[1])
    heights = from_above(points, centre, TABLE)
    maps = maps_of(heights)
    best = ggcnn(points, thing, centre=centre, table=TABLE)[0]
    depth = grey(1 - heights / max(0.05, float(heights.max())))
    quality = np.clip(maps.quality, 0, 1)
    warm = np.stack([255 * quality, 170 * quality**2, 60 * (1 - quality)], -1).astype(np.uint8)
    row, col = ((np.array([best.x, best.y]) - centre) / PIXEL + SIDE / 2) - (SIDE - CUT) / 2
    last = cut(depth)
    draw = ImageDraw.Draw(last)
    way = np.array([np.cos(best.angle), np.sin(best.angle)])
    across = np.array([-way[1], way[0]])
    at = np.array([row, col])
    ends = [at + side * way * best.width / 2 / PIXEL for side in (-1, 1)]
    draw.line([spot(end) for end in ends], fill=(230, 60, 40), width=3)
    for end in ends:
        pads = [end + side * across * 0.011 / PIXEL for side in (-1, 1)]
        draw.line([spot(pad) for pad in pads], fill=(40, 90, 230), width=4)
    whole = Image.new("RGB", (CUT * LARGE, 3 * CUT * LARGE + 18), "white")
    ImageDraw.Draw(whole).text((4, 3), name, fill="black")
    for number, part in enumerate((cut(depth), cut(warm), last)):
        whole.paste(part, (0, 18 + number * CUT * LARGE))
    return whole


def grey(values: np.ndarray) -> np.ndarray:
    """From 0 to 1 as three channels."""
    return np.repeat((255 * np.clip(values, 0, 1)).astype(np.uint8)[..., None], 3, -1)


def cut(picture: np.ndarray) -> Image.Image:
    """The middle, larger."""
    i = (SIDE - CUT) // 2
    size = (CUT * LARGE, CUT * LARGE)
    return Image.fromarray(picture[i : i + CUT, i : i + CUT]).resize(size, Image.Resampling.NEAREST)


def spot(at: np.ndarray) -> tuple[float, float]:
    """Row and column as a place in the larger picture."""
    return float(at[1] * LARGE), float(at[0] * LARGE)


if __name__ == "__main__":
    columns = [column(name) for name in THINGS]
    wide = Image.new("RGB", (sum(c.width + 6 for c in columns), columns[0].height), "white")
    for number, one in enumerate(columns):
        wide.paste(one, (number * (one.width + 6), 0))
    wide.save(Path(sys.argv[1]), quality=88)
