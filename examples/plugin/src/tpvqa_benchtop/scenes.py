"""What the two small projects look like: a state in, a picture out."""

from collections.abc import Callable, Mapping
from io import BytesIO
from random import Random

import numpy as np
from PIL import Image, ImageDraw

from tpvqa.errors import WorldError
from tpvqa.pddl import Atom, State

SIZE = (96, 72)  # pixels: width, height
Scene = Callable[[ImageDraw.ImageDraw, State, Random], None]


def sorting(draw: ImageDraw.ImageDraw, state: State, chance: Random) -> None:
    """Three trays, two parts, and a gripper above them."""
    corners = {"in_tray": 6, "left_tray": 37, "right_tray": 68}
    for left in corners.values():
        draw.rectangle((left, 44, left + 24, 66), fill=(120, 110, 100), outline=(60, 55, 50))
    draw.line((48, 0, 48, 14), fill=(70, 70, 80), width=3)
    draw.line((40, 14, 56, 14), fill=(70, 70, 80), width=3)
    for atom in sorted(state):
        if atom.predicate not in ("lies", "held"):
            continue
        part, *tray = atom.arguments
        x = corners[tray[0]] + (2 if part == "red_cube" else 13) if tray else 43
        x, y = x + chance.randint(-1, 1), (50 if tray else 16) + chance.randint(-1, 1)
        if part == "red_cube":
            draw.rectangle((x, y, x + 9, y + 9), fill=(200, 40, 40))
        else:
            draw.ellipse((x, y, x + 9, y + 9), fill=(40, 70, 200))


def greenhouse(draw: ImageDraw.ImageDraw, state: State, chance: Random) -> None:
    """Two pots on a shelf below a lamp; moist soil is dark, and a watering can may be tilted."""
    if Atom("lit") in state:
        draw.rectangle((0, 0, *SIZE), fill=(250, 245, 205))
    draw.rectangle((30, 2, 66, 8), fill=(255, 230, 90) if Atom("lit") in state else (90, 90, 90))
    draw.rectangle((0, 62, 96, 72), fill=(150, 110, 70))
    for left, plant in ((12, "fern"), (56, "cactus")):
        x, y = left + chance.randint(-1, 1), 40 + chance.randint(-1, 1)
        moist = Atom("moist", (plant,)) in state
        draw.rectangle((x, y + 6, x + 26, 62), fill=(180, 90, 60))
        draw.rectangle((x, y, x + 26, y + 7), fill=(50, 32, 20) if moist else (190, 160, 120))
        if plant == "fern":
            for lean in (-8, -3, 3, 8):
                draw.line((x + 13, y, x + 13 + lean, y - 18), fill=(40, 140, 60), width=2)
        else:
            draw.rectangle((x + 8, y - 18, x + 18, y), fill=(30, 110, 50))


SCENES: Mapping[str, Scene] = {"sorting": sorting, "greenhouse": greenhouse}
"""How the states of a domain are drawn, by the domain's name."""


def picture(domain: str, state: State, chance: Random) -> bytes:
    """A state as a camera shows it: a JPEG, with the light, noise and jitter of this one look.

    Raises:
        WorldError: Nobody has drawn this domain.
    """
    scene = SCENES.get(domain)
    if scene is None:
        raise WorldError(f"There is no drawing of the domain {domain!r}, only of {list(SCENES)}.")
    image = Image.new("RGB", SIZE, (205, 210, 215))
    scene(ImageDraw.Draw(image), state, chance)
    pixels = np.asarray(image, dtype=float) * chance.uniform(0.8, 1.1)
    pixels += np.random.default_rng(chance.getrandbits(32)).normal(0, 9, pixels.shape)
    data = BytesIO()
    Image.fromarray(pixels.clip(0, 255).astype(np.uint8)).save(data, "JPEG", quality=80)
    return data.getvalue()
