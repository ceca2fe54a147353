"""Things scanned or modelled by others, read from the zip beside this file, without unpacking.

`tools/convert_furniture.py` writes it. A `.mesh` holds the numbers of points and faces (two
32-bit integers), the lowest corner and the spans of points (3 + 3 floats) and of texture places
(2 + 2 floats), then both in 16 bits a number, then the faces (three 16-bit indices each).
"""

import json
from functools import cache, lru_cache
from importlib import resources
from io import BytesIO
from typing import Any
from zipfile import ZipFile

import numpy as np
from PIL import Image

from tpvqa_household.kitchen.assets.mesh import Mesh, encode


@cache
def _archive() -> ZipFile:
    data = (resources.files(__package__) / "scanned.zip").read_bytes()
    return ZipFile(BytesIO(data))


@cache
def index() -> tuple[dict[str, Any], ...]:
    """What is in the pack: for each thing its name, kind, split, creator, licence and parts."""
    return tuple(json.loads(_archive().read("index.json")))


@lru_cache(maxsize=128)
def mesh(name: str) -> Mesh:
    """A mesh of the pack."""
    data = _archive().read(name)
    points, faces = np.frombuffer(data, "<u4", 2)
    ranges = np.frombuffer(data, "<f4", 10, 8).astype(np.float64)
    at = 48
    decoded = []
    for width, low, span in ((3, ranges[0:3], ranges[3:6]), (2, ranges[6:8], ranges[8:10])):
        values = np.frombuffer(data, "<u2", points * width, at).reshape(-1, width)
        decoded.append(low + span * values / 65535)
        at += values.nbytes
    indices = np.frombuffer(data, "<u2", faces * 3, at).reshape(-1, 3).astype(np.int64)
    return Mesh(decoded[0], decoded[1], indices)


@lru_cache(maxsize=256)
def encoded(name: str) -> bytes:
    """A mesh of the pack in MuJoCo's format."""
    return encode(mesh(name))


@lru_cache(maxsize=64)
def texture(name: str) -> bytes:
    """A picture of the pack as PNG, which is what MuJoCo reads."""
    out = BytesIO()
    with Image.open(BytesIO(_archive().read(name))) as image:
        image.save(out, "png", compress_level=1)
    return out.getvalue()
