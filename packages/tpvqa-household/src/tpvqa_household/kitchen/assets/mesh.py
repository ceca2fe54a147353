"""Triangle meshes as arrays, and their encoding for MuJoCo."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Triangles.

    Attributes:
        points: (n, 3) positions in metres.
        uv: (n, 2) places in the texture; (0, 0) is the picture's bottom left.
        faces: (m, 3) indices, counter-clockwise seen from outside.
    """

    points: Floats
    uv: Floats
    faces: Ints

    @staticmethod
    def of(points: npt.ArrayLike, faces: npt.ArrayLike, uv: npt.ArrayLike | None = None) -> "Mesh":
        """A mesh from nested sequences."""
        array = np.asarray(points, np.float64).reshape(-1, 3)
        places = np.zeros((len(array), 2)) if uv is None else np.asarray(uv, np.float64)
        return Mesh(array, places, np.asarray(faces, np.int64).reshape(-1, 3))

    @property
    def low(self) -> Floats:
        """The lowest corner of the bounding box."""
        return np.asarray(self.points.min(axis=0))

    @property
    def high(self) -> Floats:
        """The highest corner of the bounding box."""
        return np.asarray(self.points.max(axis=0))

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> "Mesh":
        """Shifted."""
        return Mesh(self.points + np.array([x, y, z]), self.uv, self.faces)

    def scaled(self, x: float, y: float | None = None, z: float | None = None) -> "Mesh":
        """Stretched about the origin; mirrored axes keep their outside outside."""
        factors = np.array([x, x if y is None else y, x if z is None else z])
        faces = self.faces if np.prod(factors) > 0 else self.faces[:, ::-1]
        return Mesh(self.points * factors, self.uv, faces)

    def turned(self, axis: int, degrees: float) -> "Mesh":
        """Turned about the x (0), y (1) or z (2) axis."""
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn = np.eye(3)
        turn[i, i], turn[i, j], turn[j, i], turn[j, j] = c, -s, s, c
        return Mesh(self.points @ turn.T, self.uv, self.faces)

    def mapped(self, uv: Floats) -> "Mesh":
        """With other places in the texture."""
        return Mesh(self.points, uv, self.faces)

    def flipped(self) -> "Mesh":
        """Inside out."""
        return Mesh(self.points, self.uv, self.faces[:, ::-1])


def joined(meshes: Iterable[Mesh]) -> Mesh:
    """All of them as one."""
    meshes = list(meshes)
    starts = np.cumsum([0] + [len(mesh.points) for mesh in meshes[:-1]])
    return Mesh(
        np.concatenate([mesh.points for mesh in meshes]),
        np.concatenate([mesh.uv for mesh in meshes]),
        np.concatenate([mesh.faces + s for mesh, s in zip(meshes, starts, strict=True)]),
    )


def encode(mesh: Mesh, *, crease: float = 40.0) -> bytes:
    """The mesh in MuJoCo's binary format, with normals.

    Args:
        mesh: What to encode.
        crease: Edges between faces that differ by more degrees than this are sharp.
    """
    corner = mesh.points[mesh.faces]
    cross = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    area = np.linalg.norm(cross, axis=1)
    keep = area > 1e-14
    faces, cross, area = mesh.faces[keep], cross[keep], area[keep]
    flat = cross / area[:, None]
    # Corners at the same place share their normal unless their faces are too far apart, so a
    # seam in the texture is not an edge.
    _, place = np.unique(_key(mesh.points * 1e5, 20), return_inverse=True)
    at = place[faces].reshape(-1)
    face = np.repeat(np.arange(len(faces)), 3)
    order = np.argsort(at, kind="stable")
    at, face = at[order], face[order]
    first = np.flatnonzero(np.r_[True, at[1:] != at[:-1]])
    count = np.diff(np.r_[first, len(at)])
    normal = np.zeros((len(at), 3))
    limit = np.cos(np.radians(crease))
    start = np.repeat(first, count)
    rank = np.arange(len(at)) - start
    span = np.repeat(count, count)
    for shift in range(int(count.max(initial=0))):
        live = shift < span
        other = face[(start + (rank + shift) % span)[live]]
        mine = face[live]
        near = np.einsum("ij,ij->i", flat[mine], flat[other]) > limit
        normal[np.flatnonzero(live)[near]] += cross[other[near]]
    normals = np.empty_like(normal)
    normals[order] = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-20)
    index = faces.reshape(-1)
    rows = (index.astype(np.int64) << 33) + _key(normals * 500, 11)
    _, unique, inverse = np.unique(rows, return_index=True, return_inverse=True)
    points, uv = mesh.points[index[unique]], mesh.uv[index[unique]]
    header = np.array([len(unique)] * 3 + [len(faces)], np.int32)
    flipped = np.stack([uv[:, 0], 1 - uv[:, 1]], axis=1)
    return b"".join(
        [
            header.tobytes(),
            points.astype(np.float32).tobytes(),
            normals[unique].astype(np.float32).tobytes(),
            flipped.astype(np.float32).tobytes(),
            inverse.reshape(-1, 3).astype(np.int32).tobytes(),
        ]
    )


def _key(values: Floats, bits: int) -> Ints:
    """One number for each row of three, equal for rows that round to the same."""
    whole = np.round(values).astype(np.int64) + (1 << (bits - 1))
    return np.asarray((whole[:, 0] << 2 * bits) + (whole[:, 1] << bits) + whole[:, 2])


def cut(mesh: Mesh) -> tuple[Mesh, Floats]:
    """The half with y <= 0, and the points where the surface was cut (y = 0)."""
    y = mesh.points[:, 1]
    points, uv, faces = list(mesh.points), list(mesh.uv), []
    rim: dict[tuple[int, int], int] = {}

    def crossing(a: int, b: int) -> int:
        key = (min(a, b), max(a, b))
        if key not in rim:
            share = y[a] / (y[a] - y[b])
            rim[key] = len(points)
            points.append(mesh.points[a] + share * (mesh.points[b] - mesh.points[a]))
            uv.append(mesh.uv[a] + share * (mesh.uv[b] - mesh.uv[a]))
        return rim[key]

    inside = y <= 0
    kept = mesh.faces[inside[mesh.faces].all(axis=1)]
    for face in mesh.faces[inside[mesh.faces].any(axis=1) & ~inside[mesh.faces].all(axis=1)]:
        loop: list[int] = []
        for k in range(3):
            a, b = int(face[k]), int(face[(k + 1) % 3])
            if inside[a]:
                loop.append(a)
            if inside[a] != inside[b]:
                loop.append(crossing(a, b))
        faces += [[loop[0], loop[k], loop[k + 1]] for k in range(1, len(loop) - 1)]
    places = np.array(points)
    used, index = np.unique([*kept.tolist(), *faces], return_inverse=True)
    half = Mesh(places[used], np.array(uv)[used], index.reshape(-1, 3))
    return half, places[sorted(rim.values())]
