"""Bright pictures for a TV that is on, made from shapes and noise."""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator
from PIL import Image, ImageDraw

from tpvqa_household.kitchen.assets.mesh import Floats
from tpvqa_household.kitchen.assets.paint import Colour, clouds, hsv, mix, png

WIDTH, HEIGHT = 240, 136
Ink = tuple[int, int, int]


def _ink(colour: Colour) -> Ink:
    r, g, b = (round(255 * c) for c in colour)
    return r, g, b


def _bright(rng: Generator) -> Ink:
    return _ink(hsv(rng.random(), rng.uniform(0.5, 0.95), rng.uniform(0.7, 1.0)))


def _fade(low: Colour, high: Colour) -> Floats:
    """From `high` at the top to `low` at the bottom."""
    return mix(low, high, np.linspace(1, 0, HEIGHT)[:, None] * np.ones((1, WIDTH)))


def _canvas(picture: Floats) -> tuple[Image.Image, ImageDraw.ImageDraw]:
    image = Image.fromarray((np.clip(picture, 0, 1) * 255).astype(np.uint8))
    return image, ImageDraw.Draw(image)


def _back(image: Image.Image) -> Floats:
    return np.asarray(image, np.float64) / 255


def landscape(rng: Generator) -> Floats:
    """Sky, sun, mountains and meadows."""
    hue = rng.choice([0.58, 0.55, 0.05, 0.9])
    picture = _fade(hsv(hue, 0.25, 1.0), hsv(hue, 0.65, 0.9))
    image, pen = _canvas(picture)
    x, y, r = rng.uniform(20, 220), rng.uniform(15, 50), rng.uniform(8, 16)
    pen.ellipse((x - r, y - r, x + r, y + r), fill=(255, 240, 150))
    for layer in range(3):
        ridge = clouds(rng, 4, WIDTH, rows=1, columns=3 + 2 * layer, octaves=3)[0]
        base, high = 70 + 22 * layer, 50 - 14 * layer
        line = [(k, base - high * (float(ridge[k]) - 0.3)) for k in range(0, WIDTH, 3)]
        tone = hsv(0.3 + 0.05 * (2 - layer), 0.3 + 0.2 * layer, 0.75 - 0.15 * layer)
        pen.polygon([(0, HEIGHT), *line, (WIDTH, HEIGHT)], fill=_ink(tone))
    return _back(image)


def news(rng: Generator) -> Floats:
    """A speaker at a desk, a picture behind, a banner below."""
    hue = rng.uniform(0.5, 0.72)
    image, pen = _canvas(_fade(hsv(hue, 0.7, 0.35), hsv(hue, 0.6, 0.75)))
    pen.rectangle((130, 15, 225, 75), fill=_bright(rng))
    pen.polygon([(130, 75), (165, 35), (190, 60), (205, 45), (225, 75)], fill=_bright(rng))
    skin = _ink(hsv(0.07, rng.uniform(0.3, 0.6), rng.uniform(0.45, 0.95)))
    x = rng.uniform(60, 90)
    pen.pieslice((x - 34, 66, x + 34, 150), 180, 360, fill=_bright(rng))
    pen.polygon([(x - 9, 68), (x + 9, 68), (x, 96)], fill=(250, 250, 250))
    pen.ellipse((x - 16, 28, x + 16, 70), fill=skin)
    pen.pieslice(
        (x - 18, 22, x + 18, 62), 180, 360, fill=_ink(hsv(0.08, 0.6, rng.uniform(0.1, 0.6)))
    )
    pen.rectangle((0, 106, WIDTH, 126), fill=_bright(rng))
    pen.rectangle((6, 109, 50, 123), fill=(255, 255, 255))
    for k in range(9):
        pen.rectangle((58 + 19 * k, 113, 58 + 19 * k + int(rng.integers(8, 17)), 119), fill="white")
    return _back(image)


def cartoon(rng: Generator) -> Floats:
    """A round animal with big eyes before flat hills."""
    image, pen = _canvas(np.ones((HEIGHT, WIDTH, 3)) * np.array(hsv(rng.random(), 0.4, 1.0)))
    pen.ellipse((-60, 85, 140, 220), fill=_bright(rng))
    pen.ellipse((90, 95, 320, 230), fill=_bright(rng))
    x, y, r = rng.uniform(80, 160), rng.uniform(60, 80), rng.uniform(30, 42)
    body = _bright(rng)
    for side in (-1, 1):
        ear = rng.uniform(10, 20)
        pen.ellipse(
            (x + side * r * 0.7 - ear, y - r - ear, x + side * r * 0.7 + ear, y - r + ear),
            fill=body,
            outline="black",
            width=2,
        )
    pen.ellipse((x - r, y - r, x + r, y + r), fill=body, outline="black", width=2)
    for side in (-1, 1):
        ex = x + side * r * 0.4
        pen.ellipse((ex - 10, y - 18, ex + 10, y + 4), fill="white", outline="black")
        pen.ellipse((ex - 4, y - 10, ex + 4, y), fill="black")
    pen.chord(
        (x - r * 0.5, y, x + r * 0.5, y + r * 0.75),
        0,
        180,
        fill=(200, 30, 50),
        outline="black",
        width=2,
    )
    return _back(image)


def football(rng: Generator) -> Floats:
    """A pitch in stripes with white lines and players in two colours."""
    stripes = (np.arange(WIDTH) // 24 % 2)[None, :] * np.ones((HEIGHT, 1))
    image, pen = _canvas(mix((0.15, 0.55, 0.18), (0.22, 0.68, 0.22), stripes))
    pen.line((120, 22, 120, HEIGHT), fill="white", width=2)
    pen.ellipse((90, 50, 150, 100), outline="white", width=2)
    pen.rectangle((0, 45, 35, 105), outline="white", width=2)
    pen.rectangle((0, 0, WIDTH, 20), fill=_bright(rng))
    for k in range(0, WIDTH, 5):
        pen.ellipse((k, 6 + (k % 3) * 3, k + 4, 10 + (k % 3) * 3), fill=_bright(rng))
    for team in (_bright(rng), _bright(rng)):
        for _ in range(6):
            x, y = rng.uniform(10, 230), rng.uniform(30, 118)
            pen.rectangle((x - 3, y, x + 3, y + 9), fill=team)
            pen.rectangle((x - 3, y + 9, x + 3, y + 14), fill="white")
            pen.ellipse((x - 3, y - 6, x + 3, y), fill=(190, 140, 110))
    pen.ellipse((130, 78, 136, 84), fill="white", outline="black")
    pen.rectangle((8, 8, 62, 18), fill=(20, 20, 60))
    return _back(image)


def cooking(rng: Generator) -> Floats:
    """A dish seen from above on a bright table."""
    image, pen = _canvas(np.ones((HEIGHT, WIDTH, 3)) * np.array(hsv(rng.random(), 0.35, 0.95)))
    for k in range(0, WIDTH, 30):
        pen.line((k, 0, k, HEIGHT), fill="white", width=int(rng.integers(2, 8)))
    pen.ellipse((58, 6, 182, 130), fill="white", outline=(200, 200, 200), width=3)
    for _ in range(14):
        a, r = rng.uniform(0, 6.28), rng.uniform(0, 34)
        x, y, s = 120 + r * np.cos(a), 68 + r * np.sin(a), rng.uniform(6, 16)
        pen.ellipse((x - s, y - s * 0.7, x + s, y + s * 0.7), fill=_bright(rng))
    return _back(image)


def portrait(rng: Generator) -> Floats:
    """A face that fills the screen, as in a film."""
    image, pen = _canvas(_fade(hsv(rng.random(), 0.5, 0.5), hsv(rng.random(), 0.5, 0.95)))
    skin = hsv(0.07, rng.uniform(0.3, 0.6), rng.uniform(0.5, 1.0))
    x = rng.uniform(90, 150)
    pen.ellipse((x - 52, 8, x + 52, 150), fill=_ink(hsv(0.07, 0.7, rng.uniform(0.1, 0.7))))
    pen.ellipse((x - 40, 22, x + 40, 130), fill=_ink(skin))
    for side in (-1, 1):
        pen.ellipse((x + side * 17 - 8, 60, x + side * 17 + 8, 70), fill="white")
        pen.ellipse((x + side * 17 - 4, 61, x + side * 17 + 4, 69), fill=(40, 70, 90))
    pen.chord((x - 16, 90, x + 16, 112), 0, 180, fill=(190, 50, 60))
    pen.line(
        (x, 68, x - 4, 86, x + 4, 86),
        fill=_ink((skin[0] * 0.8, skin[1] * 0.7, skin[2] * 0.7)),
        width=2,
    )
    return _back(image)


def show(rng: Generator) -> Floats:
    """A stage with beams of light."""
    image, pen = _canvas(_fade(hsv(rng.random(), 0.8, 0.4), hsv(rng.random(), 0.8, 0.6)))
    for _ in range(6):
        x = rng.uniform(0, WIDTH)
        foot = x + rng.uniform(-60, 60)
        pen.polygon(
            [(x - 3, 0), (x + 3, 0), (foot + 20, HEIGHT), (foot - 20, HEIGHT)], fill=_bright(rng)
        )
    pen.rectangle((0, 112, WIDTH, HEIGHT), fill=(60, 30, 70))
    for k in range(5):
        x = 40 + 40 * k
        pen.ellipse((x - 6, 76, x + 6, 88), fill=(220, 180, 150))
        pen.rectangle((x - 8, 88, x + 8, 116), fill=_bright(rng))
    return _back(image)


def ocean(rng: Generator) -> Floats:
    """Sea, beach, a sail."""
    image, pen = _canvas(_fade((0.75, 0.9, 1.0), (0.2, 0.55, 0.95)))
    pen.rectangle((0, 62, WIDTH, 108), fill=_ink(hsv(0.53, 0.8, rng.uniform(0.5, 0.8))))
    for _ in range(30):
        x, y = rng.uniform(0, WIDTH), rng.uniform(66, 104)
        pen.line((x, y, x + rng.uniform(8, 24), y), fill=(220, 240, 250))
    pen.polygon([(0, 112), (WIDTH, 100), (WIDTH, HEIGHT), (0, HEIGHT)], fill=(240, 215, 150))
    x = rng.uniform(50, 190)
    pen.polygon([(x, 20), (x, 70), (x + 30, 70)], fill="white")
    pen.polygon([(x - 12, 72), (x + 36, 72), (x + 26, 82), (x - 4, 82)], fill=_bright(rng))
    return _back(image)


def flowers(rng: Generator) -> Floats:
    """A meadow of big flowers."""
    image, pen = _canvas(_fade((0.15, 0.5, 0.15), (0.45, 0.75, 0.3)))
    for _ in range(16):
        x, y, r = rng.uniform(0, WIDTH), rng.uniform(10, HEIGHT), rng.uniform(6, 14)
        petal = _bright(rng)
        for k in range(6):
            px, py = x + r * np.cos(k * 1.047), y + r * np.sin(k * 1.047)
            pen.ellipse((px - r * 0.6, py - r * 0.6, px + r * 0.6, py + r * 0.6), fill=petal)
        pen.ellipse((x - r * 0.5, y - r * 0.5, x + r * 0.5, y + r * 0.5), fill=(250, 210, 60))
    return _back(image)


def underwater(rng: Generator) -> Floats:
    """Held out: fish in blue water."""
    image, pen = _canvas(_fade((0.02, 0.2, 0.5), (0.2, 0.7, 0.9)))
    for _ in range(9):
        x, y, s = rng.uniform(20, 220), rng.uniform(15, 115), rng.uniform(8, 20)
        colour = _bright(rng)
        pen.ellipse((x - s, y - s * 0.5, x + s, y + s * 0.5), fill=colour)
        pen.polygon(
            [(x + s * 0.8, y), (x + s * 1.6, y - s * 0.5), (x + s * 1.6, y + s * 0.5)], fill=colour
        )
        pen.ellipse((x - s * 0.7, y - 3, x - s * 0.7 + 4, y + 1), fill="black")
    for k in range(0, WIDTH, 14):
        pen.line(
            (k, HEIGHT, k + rng.uniform(-10, 10), rng.uniform(85, 120)), fill=(40, 160, 90), width=4
        )
    return _back(image)


def night_city(rng: Generator) -> Floats:
    """Held out: towers with lit windows before an evening sky."""
    image, pen = _canvas(_fade((0.98, 0.55, 0.3), (0.25, 0.15, 0.5)))
    x = 0
    while x < WIDTH:
        wide, high = int(rng.integers(18, 38)), int(rng.integers(40, 110))
        pen.rectangle((x, HEIGHT - high, x + wide - 2, HEIGHT), fill=(35, 30, 60))
        for wy in range(HEIGHT - high + 4, HEIGHT - 4, 8):
            for wx in range(x + 3, x + wide - 6, 7):
                if rng.random() < 0.6:
                    pen.rectangle((wx, wy, wx + 3, wy + 4), fill=(255, 225, 120))
        x += wide
    return _back(image)


def weather(rng: Generator) -> Floats:
    """Held out: a map with suns and temperatures."""
    land = clouds(rng, HEIGHT, WIDTH, rows=3, columns=4) > 0.45
    image, pen = _canvas(mix((0.35, 0.65, 0.95), (0.5, 0.8, 0.4), land.astype(float)))
    for _ in range(6):
        x, y = rng.uniform(20, 220), rng.uniform(20, 110)
        pen.ellipse((x - 9, y - 9, x + 9, y + 9), fill=(255, 220, 60), outline="white", width=2)
        pen.ellipse((x, y, x + 20, y + 10), fill="white")
    pen.rectangle((0, 0, WIDTH, 14), fill=(20, 40, 120))
    pen.rectangle((6, 3, 90, 11), fill="white")
    return _back(image)


def game(rng: Generator) -> Floats:
    """Held out: an old computer game of blocks."""
    cells = rng.integers(0, 7, (9, 16))
    colours = np.array([hsv(k / 7, 0.8, 1.0) for k in range(6)] + [(0.1, 0.1, 0.15)])
    grid = colours[cells]
    rows = np.minimum(np.arange(HEIGHT) // 15, 8)
    columns = np.minimum(np.arange(WIDTH) // 15, 15)
    picture = grid[rows][:, columns].copy()
    picture[np.arange(HEIGHT) % 15 < 2] = 0.05
    picture[:, np.arange(WIDTH) % 15 < 2] = 0.05
    return np.asarray(picture)


TRAIN: tuple[Callable[[Generator], Floats], ...] = (
    landscape,
    news,
    cartoon,
    football,
    cooking,
    portrait,
    show,
    ocean,
    flowers,
)
HELD_OUT: tuple[Callable[[Generator], Floats], ...] = (underwater, night_city, weather, game)


def picture(rng: Generator, *, held_out: bool) -> bytes:
    """A random picture as PNG."""
    styles = HELD_OUT if held_out else TRAIN
    return png(styles[int(rng.integers(len(styles)))](rng))
