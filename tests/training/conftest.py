"""A set of labelled pictures of a lamp that a tiny model can learn."""

from pathlib import Path

import pytest
from PIL import Image

from tests.vlm.hf import tiny
from tpvqa.chance import chance
from tpvqa.worlds.pictures import MANIFEST, Manifest, Picture, digest

__all__ = ["lamp_set", "model"]


def make_lamp_set(folder: Path, count: int) -> Path:
    """Pictures of two lamps, the left of which is labelled."""
    folder.mkdir()
    draw, labelled = chance(1, 0, "lamps"), []
    for number in range(count):
        left, right = number % 2 == 0, draw.random() < 0.5
        wall = Image.linear_gradient("L").resize((32, 32)).rotate(90 * draw.randrange(4))
        image = wall.point([level // 3 + draw.randrange(30) for level in range(256)]).convert("RGB")
        for lit, at in ((left, 2), (right, 18)):
            if lit:
                image.paste((250, 240, draw.randrange(120)), (at, 2, at + 12, 30))
        file = f"{number}.png"
        image.save(folder / file)
        state = [f"(lit {name})" for name, lit in (("left", left), ("right", right)) if lit]
        labelled.append(
            Picture(
                file=file,
                sha256=digest((folder / file).read_bytes()),
                state=tuple(state),
                seen=frozenset({"(lit left)"}),
            )
        )
    manifest = Manifest[Picture](domain="lamps", pictures=tuple(labelled))
    (folder / MANIFEST).write_text(manifest.model_dump_json())
    return folder


@pytest.fixture(scope="session")
def lamp_set(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_lamp_set(tmp_path_factory.mktemp("lamps") / "set", 80)


@pytest.fixture(scope="session")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tiny.save("vilt", tmp_path_factory.mktemp("vilt") / "model", seed=3)
