"""Convert furniture of Sweet Home 3D's packs into the kitchen's pack of scanned things.

Run by hand, not at install time; the result is kept in the repository:

    apt-get install sweethome3d-furniture
    pip install numpy pillow fast-simplification
    python tools/convert_furniture.py /usr/share/sweethome3d/furniture \
        packages/tpvqa-household/src/tpvqa_household/kitchen/assets/scanned.zip

Every thing becomes z up, in metres, standing on the origin, with at most about 3,000 triangles:
one binary mesh a material (see `tpvqa_household.kitchen.assets.pack` for the format), its pictures
as JPEG of at most 256 pixels, and an entry in `index.json` with creator, pack and licence.
"""

import argparse
import io
import json
import re
import zipfile
from itertools import pairwise
from pathlib import Path
from typing import Any

import fast_simplification
import numpy as np
from furniture_list import CC0, CCBY, ITEMS, KATOR, SCOPIA, Item
from PIL import Image

TRIANGLES = 3000
WHOLE = 600
"""Parts with fewer triangles stay as they are: thinning would tear holes into boxes."""
PICTURE = 256
LICENCES = {
    CC0: "CC0-1.0",
    CCBY: "CC-BY-3.0",
    KATOR: "CC-BY-3.0-US",
    SCOPIA: "CC-BY-3.0",
}
# Sweet Home 3D's own colours for materials that a file names without describing them.
DEFAULT = {"kd": (0.8, 0.8, 0.8), "ks": 0.2, "ns": 50.0, "d": 1.0, "map": None}


def catalogue(archive: zipfile.ZipFile) -> dict[str, dict[str, str]]:
    """The pack's properties by model folder."""
    text = archive.read("PluginFurnitureCatalog.properties").decode("latin-1")
    by_number: dict[str, dict[str, str]] = {}
    for line in text.splitlines():
        match = re.match(r"(\w+)#(\d+)=(.*)", line)
        if match:
            by_number.setdefault(match[2], {})[match[1]] = match[3].strip()
    return {v["model"].split("/")[-2]: v for v in by_number.values() if "model" in v}


def materials(archive: zipfile.ZipFile, path: str) -> dict[str, dict[str, Any]]:
    """The materials of an MTL file."""
    found: dict[str, dict[str, Any]] = {}
    current: dict[str, Any] = {}
    for line in archive.read(path).decode("latin-1").splitlines():
        words = line.split()
        if not words:
            continue
        key = words[0].lower()
        if key == "newmtl":
            current = found.setdefault(" ".join(words[1:]), dict(DEFAULT))
        elif key == "kd":
            current["kd"] = tuple(float(w) for w in words[1:4])
        elif key == "ks":
            current["ks"] = sum(float(w) for w in words[1:4]) / 3
        elif key == "ns":
            current["ns"] = float(words[1])
        elif key == "d":
            current["d"] = float(words[-1])
        elif key == "map_kd":
            current["map"] = words[-1]
    return found


def read_obj(
    archive: zipfile.ZipFile, path: str, groups: str
) -> tuple[np.ndarray, np.ndarray, dict[str, list[tuple[list[int], list[int]]]], list[str]]:
    """Points, texture places, triangles (point and place indices) by material, MTL files."""
    points, places, libraries = [], [], []
    triangles: dict[str, list[tuple[list[int], list[int]]]] = {}
    group, material = "", ""
    for line in archive.read(path).decode("latin-1").splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            points.append([float(w) for w in words[1:4]])
        elif words[0] == "vt":
            places.append([float(w) for w in words[1:3]])
        elif words[0] in ("g", "o"):
            group = " ".join(words[1:])
        elif words[0] == "usemtl":
            material = " ".join(words[1:])
        elif words[0] == "mtllib":
            libraries.append(" ".join(words[1:]))
        elif words[0] == "f" and re.search(groups, group):
            corners = [(w + "//").split("/") for w in words[1:]]
            v = [int(c[0]) + (-1 if int(c[0]) > 0 else len(points)) for c in corners]
            t = [int(c[1]) - 1 if c[1] else -1 for c in corners]
            for k in range(1, len(v) - 1):
                triangles.setdefault(material, []).append(
                    ([v[0], v[k], v[k + 1]], [t[0], t[k], t[k + 1]])
                )
    return np.array(points), np.array(places or [[0.0, 0.0]]), triangles, libraries


def placed(points: np.ndarray, used: np.ndarray, item: Item, entry: dict[str, str]) -> np.ndarray:
    """Turned upright, scaled to metres, on the origin."""
    if "modelRotation" in entry:
        points = points @ np.array(entry["modelRotation"].split(), float).reshape(3, 3).T
    low, high = points[used].min(0), points[used].max(0)
    if item.groups:
        size = item.size
        if size is None:  # a part keeps the scale of the whole
            whole = points.max(0) - points.min(0)
            size = float((high - low).max() * float(entry["width"]) / 100 / whole[0])
        points = (points - low) * (size / (high - low).max())
    else:
        goal = np.array([float(entry[k]) for k in ("width", "height", "depth")]) / 100
        points = (points - low) * goal / np.maximum(high - low, 1e-9)
        if item.size:
            points = points * (item.size / goal.max())
    points = np.stack([points[:, 0], -points[:, 2], points[:, 1]], 1)
    for axis, degrees in ((0, item.tip), (2, item.turn)):
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn = np.eye(3)
        turn[i, i], turn[i, j], turn[j, i], turn[j, j] = c, -s, s, c
        points = points @ turn.T
    if item.flat:
        cloud = points[used] - points[used].mean(0)
        _, axes = np.linalg.eigh(cloud.T @ cloud)
        points = points @ np.stack([axes[:, 2], np.cross(axes[:, 0], axes[:, 2]), axes[:, 0]], 1)
        if item.turn:
            points = points * [-1, -1, 1]
    low, high = points[used].min(0), points[used].max(0)
    middle = (low + high) / 2
    return points - [middle[0], middle[1], low[2]]


def thinned(
    points: np.ndarray, faces: np.ndarray, uv: np.ndarray | None, goal: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Fewer triangles; texture places are carried over from the nearest old triangle."""
    used, index = np.unique(faces, return_inverse=True)
    _, first, weld = np.unique(
        np.round(points[used], 6), axis=0, return_index=True, return_inverse=True
    )
    old_points, old_faces = points[used][first], weld.reshape(-1)[index].reshape(-1, 3)
    new_points, new_faces = fast_simplification.simplify(
        old_points.astype(np.float32), old_faces.astype(np.int32), 1 - goal / len(faces)
    )
    # Thinning can throw single points far out.
    new_points = np.clip(new_points, old_points.min(0), old_points.max(0))
    if uv is None:
        return new_points, new_faces, np.zeros((len(new_points), 2))
    old = old_points[old_faces]
    new = new_points[new_faces]

    def normals(t: np.ndarray) -> np.ndarray:
        n = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
        return n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-12)

    scale = np.ptp(old_points, axis=0).max() * 0.05
    old_key = np.c_[old.mean(1), normals(old) * scale]
    new_key = np.c_[new.mean(1), normals(new) * scale]
    nearest = np.concatenate(
        [
            np.argmin(((chunk[:, None] - old_key[None]) ** 2).sum(-1), axis=1)
            for chunk in np.array_split(new_key, max(1, len(new_key) // 100))
        ]
    )
    a, b, c = (old[nearest, k] for k in range(3))
    e1, e2 = b - a, c - a
    d11, d12, d22 = (e1 * e1).sum(1), (e1 * e2).sum(1), (e2 * e2).sum(1)
    det = np.maximum(d11 * d22 - d12 * d12, 1e-18)
    corners = []
    for k in range(3):
        p = new[:, k] - a
        p1, p2 = (p * e1).sum(1), (p * e2).sum(1)
        s = np.clip((d22 * p1 - d12 * p2) / det, -0.5, 1.5)[:, None]
        t = np.clip((d11 * p2 - d12 * p1) / det, -0.5, 1.5)[:, None]
        u0, u1, u2 = (uv[nearest, m] for m in range(3))
        corners.append(u0 + s * (u1 - u0) + t * (u2 - u0))
    return (
        new.reshape(-1, 3),
        np.arange(3 * len(new)).reshape(-1, 3),
        np.stack(corners, 1).reshape(-1, 2),
    )


def packed(points: np.ndarray, faces: np.ndarray, uv: np.ndarray) -> bytes:
    """Counts, ranges, then points and texture places in 16 bits each, then faces."""
    used, index = np.unique(faces, return_inverse=True)
    points, uv, faces = points[used], uv[used], index.reshape(-1, 3)
    rows = np.c_[np.round(points, 6), np.round(uv, 5)]
    _, first, weld = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    points, uv, faces = points[first], uv[first], weld.reshape(-1)[faces]
    faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2])]
    if len(points) > 65535:
        raise ValueError("a part has more than 65,535 points; thin it more")
    out = [np.array([len(points), len(faces)], "<u4").tobytes()]
    coded = []
    for values in (points, uv):
        low, span = values.min(0), np.maximum(np.ptp(values, axis=0), 1e-9)
        out += [low.astype("<f4").tobytes(), span.astype("<f4").tobytes()]
        coded.append(np.round((values - low) / span * 65535).astype("<u2").tobytes())
    return b"".join([*out, *coded, faces.astype("<u2").tobytes()])


def picture(data: bytes) -> bytes:
    """A small JPEG."""
    image = Image.open(io.BytesIO(data)).convert("RGB")
    image.thumbnail((PICTURE, PICTURE))
    out = io.BytesIO()
    image.save(out, "jpeg", quality=80)
    return out.getvalue()


def dish(points: np.ndarray) -> list[list[float]]:
    """A plate's upper side: the greatest height by distance from the middle."""
    r = np.hypot(points[:, 0], points[:, 1])
    edge = min(np.abs(points[:, 0]).max(), np.abs(points[:, 1]).max())
    bins = np.linspace(0, edge, 13)
    found = []
    for low, high in pairwise(bins):
        inside = (r >= low) & (r < high + 1e-6)
        if inside.any():
            found.append([float((low + high) / 2), float(points[inside, 2].max())])
    return [[0.0, found[0][1]], *found]


def basin(triangles: np.ndarray) -> dict[str, list[float]]:
    """Where a sink's basin is: the widest sunken place seen from above."""
    rng = np.random.default_rng(0)
    area = np.linalg.norm(
        np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1
    )
    pick = rng.choice(len(triangles), 400_000, p=area / area.sum())
    a, b = np.sort(rng.random((2, len(pick))), axis=0)
    weights = np.stack([a, b - a, 1 - b], 1)[..., None]
    samples = (triangles[pick] * weights).sum(1)
    cell = 0.015
    low = samples[:, :2].min(0)
    at = ((samples[:, :2] - low) / cell).astype(int)
    height = np.full(tuple(at.max(0) + 1), -1.0)
    np.maximum.at(height, (at[:, 0], at[:, 1]), samples[:, 2])
    values, counts = np.unique(np.round(height[height > 0.5], 2), return_counts=True)
    top = float(values[np.argmax(counts)])
    sunken = (height < top - 0.07) & (height > top - 0.35)
    best: list[tuple[int, int]] = []
    seen = np.zeros_like(sunken)
    for start in zip(*np.nonzero(sunken), strict=True):
        if seen[start]:
            continue
        todo, region = [start], []
        seen[start] = True
        while todo:
            i, j = todo.pop()
            region.append((int(i), int(j)))
            for n in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
                inside = 0 <= n[0] < sunken.shape[0] and 0 <= n[1] < sunken.shape[1]
                if inside and sunken[n] and not seen[n]:
                    seen[n] = True
                    todo.append(n)
        if len(region) > len(best):
            best = region
    cells = np.array(best)
    middle = low + (cells.min(0) + cells.max(0) + 1) / 2 * cell
    half = (cells.max(0) - cells.min(0) + 1) / 2 * cell
    floor = float(np.median(height[cells[:, 0], cells[:, 1]]))
    return {
        "pos": [float(middle[0]), float(middle[1]), floor],
        "half": [float(half[0]), float(half[1])],
        "top": [top],
    }


def convert(
    item: Item, archive: zipfile.ZipFile, entry: dict[str, str], out: zipfile.ZipFile
) -> dict[str, Any]:
    """Write one thing's meshes and pictures; give its entry for the index."""
    path = entry["model"].lstrip("/")
    folder = path.rsplit("/", 1)[0]
    points, places, triangles, libraries = read_obj(archive, path, item.groups)
    if not triangles:
        raise ValueError(f"{item.name}: nothing in {path} matches {item.groups!r}")
    described: dict[str, dict[str, Any]] = {}
    for library in libraries:
        described |= materials(archive, f"{folder}/{library}")
    corners = {m: np.array([t[0] for t in ts]) for m, ts in triangles.items()}
    used = np.unique(np.concatenate([c.reshape(-1) for c in corners.values()]))
    points = placed(points, used, item, entry)
    total = sum(len(c) for c in corners.values())
    doubled = item.both_sides or entry.get("backFaceShown") == "true"
    share = min(1.0, TRIANGLES / total / (1 + doubled))
    parts, all_points, all_triangles = [], [], []
    screen = None
    for number, (name, faces) in enumerate(corners.items()):
        look = described.get(name, DEFAULT)
        place_index = np.array([t[1] for t in triangles[name]])
        textured = look["map"] is not None and (place_index >= 0).all()
        uv = places[place_index] if textured else None
        if item.screen and re.search(item.screen, name):
            p = points[np.unique(faces)]
            screen = [p.min(0).tolist(), p.max(0).tolist()]
            continue
        goal = len(faces) if len(faces) <= WHOLE else max(int(len(faces) * share), WHOLE // 2)
        if goal < 0.95 * len(faces):
            new_points, new_faces, new_uv = thinned(points, faces, uv, goal)
        else:
            new_points = points[faces].reshape(-1, 3)
            new_faces = np.arange(len(new_points)).reshape(-1, 3)
            new_uv = np.zeros((len(new_points), 2)) if uv is None else uv.reshape(-1, 2)
        if doubled:
            new_faces = np.r_[new_faces, new_faces[:, ::-1] + len(new_points)]
            new_points, new_uv = np.r_[new_points, new_points], np.r_[new_uv, new_uv]
        all_points.append(new_points)
        all_triangles.append(new_points[new_faces])
        mesh = f"{item.name}/{number}.mesh"
        out.writestr(mesh, packed(new_points, new_faces, new_uv))
        texture = None
        if textured:
            texture = f"{item.name}/{Path(look['map']).stem}.jpg"
            if texture not in out.namelist():
                out.writestr(texture, picture(archive.read(f"{folder}/{look['map']}")))
        colour = [1.0, 1.0, 1.0] if texture else [round(c, 4) for c in look["kd"]]
        parts.append(
            {
                "mesh": mesh,
                "texture": texture,
                "rgba": [*colour, round(float(look["d"]), 3)],
                "specular": round(min(float(look["ks"]), 1.0), 3),
                "shininess": round(min(float(look["ns"]) / 200, 1.0), 3),
            }
        )
    cloud = np.concatenate(all_points)
    extent = (cloud.max(0) - cloud.min(0)).round(4).tolist()
    result: dict[str, Any] = {
        "name": item.name,
        "kind": item.kind,
        "held_out": item.held_out,
        "extent": extent,
        "creator": entry.get("creator", item.pack),
        "pack": item.pack,
        "model": item.model,
        "licence": LICENCES[item.pack],
        "parts": parts,
    }
    if screen:
        result["screen"] = screen
    if item.kind == "plate":
        result["dish"] = dish(cloud)
    if item.kind == "sink":
        result["basin"] = basin(np.concatenate(all_triangles))
    kept = sum(len(t) for t in all_triangles)
    print(f"{item.kind:13}{item.name:24}{total:7} -> {kept:5} triangles  {extent}")
    return result


def main() -> None:
    """Convert everything on the list."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("packs", type=Path, help="folder with the .sh3f files")
    parser.add_argument("result", type=Path, help="the .zip to write")
    options = parser.parse_args()
    archives = {p: zipfile.ZipFile(options.packs / f"{p}.sh3f") for p in LICENCES}
    entries = {p: catalogue(archive) for p, archive in archives.items()}
    index = []
    with zipfile.ZipFile(options.result, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as out:
        for item in ITEMS:
            if item.model not in entries[item.pack]:
                raise SystemExit(f"{item.pack} has no model {item.model!r}")
            index.append(convert(item, archives[item.pack], entries[item.pack][item.model], out))
        out.writestr("index.json", json.dumps(index, indent=1))
    print(f"{len(index)} things, {options.result.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
