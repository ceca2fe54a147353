"""Basic shapes as meshes: turned on a lathe, cut out of a sheet, swept along a curve, boxes."""

from collections.abc import Sequence
from functools import cache
from itertools import product

import numpy as np

from tpvqa_household.kitchen.assets.mesh import Floats, Ints, Mesh


def lathe(
    profile: Sequence[tuple[float, float]] | Floats, *, steps: int = 32, disc_uv: bool = False
) -> Mesh:
    """A profile of (radius, height), from the bottom centre outwards and up, turned about z.

    Args:
        profile: The rim curve, listed so that the outside is on its right hand side.
        steps: How many slices.
        disc_uv: Look at the texture from above instead of wrapping it around.
    """
    curve = np.asarray(profile, np.float64)
    n = len(curve)
    angle = np.linspace(0, 2 * np.pi, steps + 1)
    radius = np.tile(curve[:, 0], steps + 1)
    a = np.repeat(angle, n)
    points = np.stack(
        [radius * np.cos(a), radius * np.sin(a), np.tile(curve[:, 1], steps + 1)], axis=1
    )
    if disc_uv:
        uv = 0.5 + points[:, :2] / (2 * curve[:, 0].max())
    else:
        length = np.r_[0, np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1))]
        uv = np.stack([a / (2 * np.pi), np.tile(length / length[-1], steps + 1)], axis=1)
    return Mesh(points, uv, _grid(steps + 1, n))


def _grid(rows: int, columns: int) -> Ints:
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = (i * columns + j).reshape(-1)
    b, c, d = a + columns, a + columns + 1, a + 1
    return np.stack([np.stack([a, b, c], 1), np.stack([a, c, d], 1)], 1).reshape(-1, 3)


def surface(points: Floats, *, uv: Floats | None = None) -> Mesh:
    """A sheet through a grid of points, (rows, columns, 3); outside is rows x columns."""
    rows, columns = points.shape[:2]
    if uv is None:
        u, v = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")
        uv = np.stack([u, v], -1)
    return Mesh(points.reshape(-1, 3), uv.reshape(-1, 2), _grid(rows, columns))


def box(x: float, y: float, z: float, *, bevel: float = 0.0, uv_scale: float | None = None) -> Mesh:
    """A box of full sizes x, y, z, standing on the origin, with its edges cut off at 45 degrees.

    Args:
        x: Width.
        y: Depth.
        z: Height.
        bevel: Width of the cut.
        uv_scale: Texture repeats per metre, the grain along x, or up on sides seen from along x;
            None puts the whole texture on each side.
    """
    half = np.array([x, y, z]) / 2
    cut = min(bevel, 0.49 * min(x, y, z))
    signs, inner, side, faces = _box_pattern(cut > 0)
    points = signs * (half - cut * inner)
    i, j = np.array([1, 0, 0])[side], np.array([2, 2, 1])[side]
    rows = np.arange(len(points))
    flat = np.stack([points[rows, i], points[rows, j]], 1)
    whole = 1 / (2 * np.stack([half[i], half[j]], 1))
    uv = 0.5 + flat * whole if uv_scale is None else flat * uv_scale
    return Mesh(points + np.array([0.0, 0.0, half[2]]), uv, faces)


@cache
def _box_pattern(bevelled: bool) -> tuple[Floats, Floats, Ints, Ints]:
    """Corners of all faces of a box: signs, which coordinates are cut back, main side; faces."""
    corner = {
        (axis, s): (np.array(s, float), np.array([float(k != axis) for k in range(3)]))
        for axis in range(3)
        for s in product((-1, 1), repeat=3)
    }
    loops: list[list[tuple[int, tuple[int, ...]]]] = []
    for axis in range(3):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        for sign in (-1, 1):
            ring = []
            for si, sj in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                s = [0, 0, 0]
                s[axis], s[i], s[j] = sign, si, sj
                ring.append((axis, tuple(s)))
            loops.append(ring)
    if bevelled:
        for axis in range(3):
            i, j = (axis + 1) % 3, (axis + 2) % 3
            for si, sj in product((-1, 1), repeat=2):
                ends = []
                for end in (-1, 1):
                    s = [0, 0, 0]
                    s[axis], s[i], s[j] = end, si, sj
                    ends.append(tuple(s))
                loops.append([(i, ends[0]), (i, ends[1]), (j, ends[1]), (j, ends[0])])
        loops += [[(a, s) for a in range(3)] for s in product((-1, 1), repeat=3)]
    signs: list[Floats] = []
    inner: list[Floats] = []
    side: list[int] = []
    faces: list[list[int]] = []
    for loop in loops:
        ring_points = [corner[key][0] * (1 - 0.1 * corner[key][1]) for key in loop]
        normal = np.cross(ring_points[1] - ring_points[0], ring_points[2] - ring_points[0])
        if normal @ np.mean(ring_points, axis=0) < 0:
            loop = loop[::-1]
            normal = -normal
        start = len(signs)
        for key in loop:
            signs.append(corner[key][0])
            inner.append(corner[key][1])
            side.append(int(np.argmax(np.abs(normal))))
        faces += [[start, start + k, start + k + 1] for k in range(1, len(loop) - 1)]
    return np.array(signs), np.array(inner), np.array(side), np.array(faces)


def slab(outline: Floats, low: float, high: float, *, bevel: float = 0.0) -> Mesh:
    """An outline in the xy plane (counter-clockwise, star-shaped about its mean) made thick.

    The texture is seen from above, stretched over the outline's bounding box.
    """
    n = len(outline)
    middle = outline.mean(axis=0)
    inner = middle + (outline - middle) * (
        1 - bevel / np.maximum(np.linalg.norm(outline - middle, axis=1, keepdims=True), bevel)
    )
    rings = [(inner, low), (outline, low + bevel), (outline, high - bevel), (inner, high)]
    if bevel == 0:
        rings = [(outline, low), (outline, high)]
    points = np.concatenate([np.c_[xy, np.full(n, z)] for xy, z in rings])
    points = np.r_[points, [[*middle, low]], [[*middle, high]]]
    faces = []
    for level in range(len(rings) - 1):
        for k in range(n):
            a, b = level * n + k, level * n + (k + 1) % n
            faces += [[a, b, b + n], [a, b + n, a + n]]
    top = (len(rings) - 1) * n
    for k in range(n):
        faces.append([len(points) - 2, (k + 1) % n, k])
        faces.append([len(points) - 1, top + k, top + (k + 1) % n])
    low_xy, span = outline.min(axis=0), np.ptp(outline, axis=0)
    return Mesh.of(points, faces, (points[:, :2] - low_xy) / span)


def tube(
    path: Sequence[Sequence[float]] | Floats,
    radius: float | Sequence[float] | Floats,
    *,
    steps: int = 10,
    flat: float = 1.0,
) -> Mesh:
    """A round bar along a curve, closed at its ends.

    Args:
        path: (n, 3) points.
        radius: One for all, or one for each point.
        steps: Corners of the cross section.
        flat: Height of the cross section over its width.
    """
    spine = np.asarray(path, np.float64)
    radii = np.broadcast_to(np.asarray(radius, np.float64), (len(spine),))
    along = np.gradient(spine, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    reference = np.array([0.0, 0.0, 1.0])
    if abs(along @ reference).mean() > 0.8:
        reference = np.array([0.0, 1.0, 0.0])
    side = np.cross(reference, along)
    norm = np.linalg.norm(side, axis=1, keepdims=True)
    side = np.where(norm > 1e-6, side / np.maximum(norm, 1e-6), [1.0, 0.0, 0.0])
    for k in range(1, len(side)):
        if side[k] @ side[k - 1] < 0:
            side[k] = -side[k]
    up = np.cross(along, side)
    angle = np.linspace(0, 2 * np.pi, steps + 1)
    ring = (
        np.cos(angle)[None, :, None] * side[:, None]
        + flat * np.sin(angle)[None, :, None] * up[:, None]
    ) * radii[:, None, None]
    grid = spine[:, None] + ring
    grid = np.concatenate(
        [np.repeat(spine[:1, None], steps + 1, 1), grid, np.repeat(spine[-1:, None], steps + 1, 1)]
    )
    return surface(grid.transpose(1, 0, 2))


def blob(
    x: float, y: float, z: float, *, rows: int = 12, columns: int = 20, power: float = 1.0
) -> Mesh:
    """An ellipsoid of full sizes x, y, z standing on the origin; `power` < 1 makes it boxier."""
    v = np.linspace(-np.pi / 2, np.pi / 2, rows)
    u = np.linspace(0, 2 * np.pi, columns + 1)

    def swell(values: Floats) -> Floats:
        return np.asarray(np.sign(values) * np.abs(values) ** power)

    grid = np.stack(
        [
            np.outer(swell(np.cos(u)), swell(np.cos(v))) * x / 2,
            np.outer(swell(np.sin(u)), swell(np.cos(v))) * y / 2,
            np.outer(np.ones_like(u), swell(np.sin(v))) * z / 2 + z / 2,
        ],
        -1,
    )
    return surface(grid)


def quad(x: float, z: float, *, thickness: float = 0.001) -> Mesh:
    """An upright picture in the xz plane about the origin, facing -y, readable from there."""
    a, b = x / 2, z / 2
    front = [[-a, 0, -b], [a, 0, -b], [a, 0, b], [-a, 0, b]]
    back = [[px, thickness, pz] for px, _, pz in front]
    uv = [[0, 0], [1, 0], [1, 1], [0, 1]]
    return Mesh.of(front + back, [[0, 1, 2], [0, 2, 3], [5, 4, 7], [5, 7, 6]], [*uv, *uv])


def disc(radius: float, *, thickness: float = 0.001, steps: int = 32) -> Mesh:
    """A flat round sheet on the origin with the texture seen from above."""
    angle = np.linspace(0, 2 * np.pi, steps, endpoint=False)
    return slab(radius * np.stack([np.cos(angle), np.sin(angle)], 1), 0.0, thickness)
