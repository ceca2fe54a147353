"""Tiny models, saved once, and a picture to ask about."""

from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import pytest
from PIL import Image

from tests.vlm.hf import tiny
from tpvqa.observation import PNG, Frame, Observation

Saved = Callable[..., Path]


@pytest.fixture(scope="session")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Saved:
    """The folder of a tiny model of a family."""
    known: dict[tuple[str, bool], Path] = {}

    def made(family: str, *, outspoken: bool = False) -> Path:
        key = family, outspoken
        if key not in known:
            folder = tmp_path_factory.mktemp(family) / "model"
            seed = int(family == "paligemma")  # with 0 it has no word for a dark picture
            known[key] = tiny.save(family, folder, seed=seed, outspoken=outspoken)
        return known[key]

    return made


def picture(*, left: bool = True, right: bool = False, size: int = 32) -> Image.Image:
    """A wall with two lamps."""
    image = Image.radial_gradient("L").resize((size, size)).convert("RGB")
    for lit, at in ((left, 0), (right, size // 2)):
        if lit:
            image.paste((250, 240, 120), (at, 0, at + size // 2, size // 2))
    return image


def observation(*pictures: Image.Image) -> Observation:
    """One look at pictures, a view each."""
    frames = {}
    for number, image in enumerate(pictures):
        data = BytesIO()
        image.save(data, "png")
        frames[str(number)] = Frame(str(number), str(number), data.getvalue(), PNG)
    return Observation(frames=frames)
