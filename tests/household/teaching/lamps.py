"""Labelled pictures of two lamps on a shelf, drawn on the spot: to teach a user's words with."""

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

from tpvqa.worlds.pictures import MANIFEST, Manifest, Picture, digest

BRIGHT = "(bright)"


def draw(rng: np.random.Generator, *, left: bool, right: bool) -> Image.Image:
    """Two lamps before a wall, by some camera in some light."""
    wall = tuple(int(x) for x in rng.integers(40, 110, 3))
    image = Image.new("RGB", (160, 120), wall)
    pen = ImageDraw.Draw(image)
    dx, dy, size = (int(rng.integers(-8, 9)) for _ in range(3))
    pen.rectangle((0, 92 + dy, 160, 120), fill=tuple(int(x * 0.6) for x in wall))
    for lit, at in ((left, 42 + dx), (right, 118 + dx)):
        wide = 15 + size // 3
        pen.line((at, 92 + dy, at, 55 + dy), fill=(20, 20, 20), width=3)
        shade = (255, 240, int(rng.integers(120, 200))) if lit else (70, 70, 80)
        pen.polygon(
            [(at - wide, 56 + dy), (at + wide, 56 + dy), (at + 7, 30 + dy), (at - 7, 30 + dy)],
            fill=shade,
        )
    for _ in range(int(rng.integers(0, 4))):
        x, y = int(rng.integers(0, 150)), int(rng.integers(95, 115))
        pen.rectangle((x, y, x + 8, y + 5), fill=tuple(int(c) for c in rng.integers(0, 255, 3)))
    blurred = image.filter(ImageFilter.GaussianBlur(float(rng.uniform(0, 1))))
    light = float(rng.uniform(0.8, 1.15))
    return blurred.point([min(255, int(level * light)) for level in range(256)] * 3)


def make(folder: Path, count: int, *, seed: int = 0, groups: int = 0) -> Path:
    """A set of them. Of a bright room only bright pictures tell."""
    folder.mkdir()
    rng, pictures = np.random.default_rng(seed), []
    for number in range(count):
        left, right = bool(number % 2), bool(number // 2 % 2)
        file = f"{number}.png"
        draw(rng, left=left, right=right).save(folder / file)
        lit = [f"(lit {name})" for name, on in (("left", left), ("right", right)) if on]
        seen = {"(lit left)", "(lit right)"} | ({BRIGHT} if lit else set())
        pictures.append(
            Picture(
                file=file,
                sha256=digest((folder / file).read_bytes()),
                state=tuple(lit),
                seen=frozenset(seen),
                group=f"room {number % groups}" if groups else "",
            )
        )
    manifest = Manifest[Picture](domain="lamps", pictures=tuple(pictures))
    (folder / MANIFEST).write_text(manifest.model_dump_json())
    return folder
