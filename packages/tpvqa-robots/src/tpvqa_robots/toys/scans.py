"""Toys that others modelled, from the zip beside this file: seen as they are, touched as hulls.

NOTICE says who made them. A toy is shrunk until the hand and a container take it. What touches it
are the hulls of what is in each cell of a grid over it: some millimetres beside what is seen.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from tpvqa_robots.toys.mujoco import load_mujoco

FILE = Path(__file__).with_name("scans.zip")
"""Made by tools/toys_pack.py."""


@dataclass(frozen=True, slots=True)
class Scan:
    """A toy.

    Attributes:
        name: In the zip.
        cells: Into how many cells each of its sides is parted.
        large: Its largest size, metres.
        middle: The middle one of its three sizes, metres.
    """

    name: str
    cells: int
    large: float = 0.12
    middle: float = 0.062


SCANS: Mapping[str, Scan] = {
    "toy_teddy": Scan("teddy-manitislate", 4, large=0.10, middle=0.1),
    "toy_rubik": Scan("rubik-farcgs", 1),
    "toy_biplane": Scan("biplane-toy", 4, middle=0.11),
    "toy_train": Scan("train-toy", 4),
    "toy_wood": Scan("toy-wood", 4, large=0.10),
}
"""What tasks call them."""
OVERLAP, THIN, FEW = 0.001, 0.0008, 12
"""How far cells overlap, half of what a flat one is made thick, metres; points it must have."""
MASS = 0.05
"""Of each, kg."""
_FRICTION = [1.2, 0.02, 0.003]


@dataclass(frozen=True)
class Surface:
    """Triangles.

    Attributes:
        points: n × 3, metres.
        places: n × 2, of points in a picture.
        faces: m × 3, of points.
    """

    points: NDArray[np.float64]
    places: NDArray[np.float64]
    faces: NDArray[np.int64]


@dataclass(frozen=True)
class Part:
    """What of a toy has one colour or picture.

    Attributes:
        surface: Its triangles, the toy's middle at the origin.
        rgba: From 0 to 1.
        picture: As PNG; None for a plain colour.
        specular: As MuJoCo has it.
        shininess: The same.
    """

    surface: Surface
    rgba: Sequence[float]
    picture: bytes | None
    specular: float
    shininess: float


def surface_of(data: bytes) -> Surface:
    """A mesh of the household's format: counts, ranges, then 16 bits a number."""
    points, faces = (int(count) for count in np.frombuffer(data, "<u4", 2))
    ranges = np.frombuffer(data, "<f4", 10, 8).astype(np.float64)
    values = np.frombuffer(data, "<u2", points * 3, 48).reshape(-1, 3)
    places = np.frombuffer(data, "<u2", points * 2, 48 + points * 6).reshape(-1, 2)
    indices = np.frombuffer(data, "<u2", faces * 3, 48 + points * 10).reshape(-1, 3)
    return Surface(
        ranges[0:3] + ranges[3:6] * values / 65535,
        ranges[6:8] + ranges[8:10] * places / 65535,
        indices.astype(np.int64),
    )


def spread(parts: Sequence[Surface], count: int = 12000) -> NDArray[np.float64]:
    """Points spread over surfaces, and all their corners."""
    rng, found = np.random.default_rng(0), [part.points for part in parts]
    corners = np.concatenate([part.points[part.faces] for part in parts])
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    drawn = rng.choice(len(area), count, p=area / area.sum())
    u, v = rng.random((2, count, 1))
    over = u + v > 1
    u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
    found.append(a[drawn] + u * (b - a)[drawn] + v * (c - a)[drawn])
    return np.concatenate(found)


def pieces(points: NDArray[np.float64], count: int) -> list[NDArray[np.float64]]:
    """Points of the hulls of what is in each cell of a grid.

    Args:
        points: Spread over the surface, n × 3, metres.
        count: Of cells along each side.
    """
    low, side = points.min(0), np.ptp(points, axis=0) / count
    found = []
    for cell in np.ndindex(count, count, count):
        start = low + np.array(cell) * side - OVERLAP
        inside = ((points >= start) & (points <= start + side + 2 * OVERLAP)).all(1)
        if inside.sum() < FEW:
            continue
        own = points[inside]
        _, spans, ways = np.linalg.svd(own - own.mean(0), full_matrices=False)
        if spans[1] / np.sqrt(len(own)) < 0.0002:
            continue  # a line
        if spans[2] / np.sqrt(len(own)) < THIN:
            own = np.concatenate([own + THIN * ways[2], own - THIN * ways[2]])
        found.append(_few(own))
    return found


@cache
def parts_of(name: str) -> tuple[Part, ...]:
    """The parts of a toy of `SCANS`, as large as it is on the table."""
    scan = SCANS[name]
    with ZipFile(FILE) as pack:
        entry = next(e for e in json.loads(pack.read("index.json")) if e["name"] == scan.name)
        surfaces = [surface_of(pack.read(part["mesh"])) for part in entry["parts"]]
        pictures = [part["texture"] and _png(pack.read(part["texture"])) for part in entry["parts"]]
    points = np.concatenate([surface.points for surface in surfaces])
    low, high = points.min(0), points.max(0)
    _, middle, large = np.sort(high - low)
    factor = min(1.0, scan.middle / float(middle), scan.large / float(large))
    return tuple(
        Part(
            Surface((s.points - (low + high) / 2) * factor, s.places, s.faces),
            part["rgba"],
            picture,
            part["specular"],
            part["shininess"],
        )
        for s, part, picture in zip(surfaces, entry["parts"], pictures, strict=True)
    )


def half_height(name: str) -> float:
    """Of a toy of `SCANS` that stands, metres."""
    return float(max(part.surface.points[:, 2].max() for part in parts_of(name)))


def half_length(name: str) -> float:
    """Half of a toy's largest size, metres."""
    points = np.concatenate([part.surface.points for part in parts_of(name)])
    return float(np.ptp(points, axis=0).max() / 2)


def add_scan(room: Any, name: str, at: Sequence[float], yaw: float) -> None:
    """Put a toy of `SCANS` into a spec as a body that can move.

    Args:
        room: The spec.
        name: The toy's, and the body's.
        at: Where its middle is, metres.
        yaw: How it is turned, radians.
    """
    mj = load_mujoco()
    quat = [float(np.cos(yaw / 2)), 0, 0, float(np.sin(yaw / 2))]
    body = room.worldbody.add_body(name=name, pos=list(at), quat=quat)
    body.add_freejoint()
    for number, part in enumerate(parts_of(name)):
        material = room.add_material(name=f"{name}_{number}", rgba=list(part.rgba))
        material.specular, material.shininess = part.specular, part.shininess
        if part.picture:
            file = f"{name}_{number}.png"
            room.assets = {**room.assets, file: part.picture}
            room.add_texture(name=file, type=mj.mjtTexture.mjTEXTURE_2D, file=file)
            textures = material.textures
            textures[mj.mjtTextureRole.mjTEXROLE_RGB] = file
            material.textures = textures
        room.add_mesh(
            name=f"{name}_{number}",
            uservert=part.surface.points.ravel().tolist(),
            userface=part.surface.faces.ravel().tolist(),
            usertexcoord=(part.surface.places * [1, -1] + [0, 1]).ravel().tolist(),
            inertia=mj.mjtMeshInertia.mjMESH_INERTIA_SHELL,
        )
        seen = body.add_geom(type=mj.mjtGeom.mjGEOM_MESH, meshname=f"{name}_{number}", group=1)
        seen.material, seen.mass, seen.contype, seen.conaffinity = material.name, 0, 0, 0
    hulls = pieces(spread([part.surface for part in parts_of(name)]), SCANS[name].cells)
    for number, points in enumerate(hulls):
        hull = f"{name}_hull_{number}"
        room.add_mesh(
            name=hull,
            uservert=points.ravel().tolist(),
            maxhullvert=32,
            inertia=mj.mjtMeshInertia.mjMESH_INERTIA_CONVEX,
        )
        touched = body.add_geom(type=mj.mjtGeom.mjGEOM_MESH, meshname=hull, group=3)
        touched.friction, touched.condim, touched.mass = _FRICTION, 6, MASS / len(hulls)
        touched.solref = [0.01, 1.0]


def _few(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Those that are farthest in some of 200 directions: enough for the hull."""
    ways = np.random.default_rng(1).normal(size=(200, 3))
    few: NDArray[np.float64] = points[np.unique((points @ ways.T).argmax(0))]
    return few


def _png(data: bytes) -> bytes:
    from PIL import Image

    out = BytesIO()
    with Image.open(BytesIO(data)) as picture:
        picture.convert("RGB").save(out, "png", compress_level=1)
    return out.getvalue()
