"""A few labelled pictures of lamps, made on the spot: for worlds and commands of any domain."""

import json
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

from PIL import Image

from tpvqa.worlds.pictures import MANIFEST, digest

LAMPS = Path(__file__).parent / "fixtures" / "lamps"
DOMAIN, PROBLEM = LAMPS / "domain.pddl", LAMPS / "both.pddl"
QUESTIONS = LAMPS / "questions.yaml"
LEFT, RIGHT, BRIGHT = "(lit left)", "(lit right)", "(bright)"
PICTURES: dict[str, tuple[list[str], list[str]]] = {
    "dark.png": ([], [LEFT, RIGHT]),
    "left.png": ([LEFT], ["lit(left)", RIGHT]),
    "right.png": ([RIGHT], [LEFT, RIGHT]),
    "both.png": ([LEFT, RIGHT], [LEFT, RIGHT]),
    "both2.jpg": ([RIGHT, LEFT], [RIGHT, LEFT]),
    "close.png": ([LEFT], [LEFT]),
    "wall.png": ([LEFT], [BRIGHT]),
}
"""Files with what is true in them and what they show."""
Manifest = dict[str, Any]


def make_set(folder: Path) -> Path:
    """Half a picture is white where that lamp is lit."""
    folder.mkdir()
    entries = []
    for number, (file, (state, seen)) in enumerate(PICTURES.items()):
        picture = Image.new("RGB", (8, 8), (number, 0, 0))
        for fact, side in ((LEFT, 0), (RIGHT, 4)):
            if fact in state:
                picture.paste((255, 255, 255 - number), (side, 0, side + 4, 8))
        picture.paste((20, 20, 60), (0, 7, 8, 8))  # the floor
        data = BytesIO()
        picture.save(data, "JPEG" if file.endswith("jpg") else "PNG")
        (folder / file).write_bytes(data.getvalue())
        told = {"file": file, "sha256": digest(data.getvalue()), "state": state, "seen": seen}
        entries.append({**told, "photographer": "somebody"})
    manifest = {"version": 1, "domain": "lamps", "licence": "CC0-1.0", "pictures": entries}
    (folder / MANIFEST).write_text(json.dumps(manifest))
    return folder


def edit(folder: Path, change: Callable[[Manifest], object]) -> None:
    """Change the manifest of a set."""
    manifest = json.loads((folder / MANIFEST).read_text())
    change(manifest)
    (folder / MANIFEST).write_text(json.dumps(manifest))


def without(*files: str) -> Callable[[Manifest], object]:
    """A change that leaves pictures out."""

    def change(manifest: Manifest) -> None:
        manifest["pictures"] = [each for each in manifest["pictures"] if each["file"] not in files]

    return change
