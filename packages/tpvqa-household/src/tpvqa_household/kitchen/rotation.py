"""Rotations as 3 × 3 matrices and MuJoCo's quaternions (w, x, y, z)."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def about_x(angle: float) -> Array:
    """A turn about x, in radians."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1.0, 0, 0], [0, c, -s], [0, s, c]])


def about_y(angle: float) -> Array:
    """A turn about y, in radians."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0, s], [0, 1.0, 0], [-s, 0, c]])


def about_z(angle: float) -> Array:
    """A turn about z, in radians."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])


def quaternion(matrix: Array) -> Array:
    """The unit quaternion of a rotation matrix."""
    m = np.asarray(matrix, float)
    # From the greatest of the four, as the others lose their digits near half a turn.
    products = np.array(
        [
            [1 + np.trace(m), m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
            [
                m[2, 1] - m[1, 2],
                1 + m[0, 0] - m[1, 1] - m[2, 2],
                m[0, 1] + m[1, 0],
                m[0, 2] + m[2, 0],
            ],
            [
                m[0, 2] - m[2, 0],
                m[0, 1] + m[1, 0],
                1 - m[0, 0] + m[1, 1] - m[2, 2],
                m[1, 2] + m[2, 1],
            ],
            [
                m[1, 0] - m[0, 1],
                m[0, 2] + m[2, 0],
                m[1, 2] + m[2, 1],
                1 - m[0, 0] - m[1, 1] + m[2, 2],
            ],
        ]
    )
    q = products[np.argmax(np.diag(products))]
    q = q if q[0] >= 0 else -q
    return np.asarray(q / np.linalg.norm(q))


def matrix(quat: ArrayLike) -> Array:
    """The rotation matrix of a unit quaternion."""
    w, x, y, z = np.asarray(quat, float)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def looking(forward: ArrayLike, roll: float = 0.0) -> Array:
    """Camera axes (right, up, backward as columns) that look along `forward`, upright."""
    f = np.asarray(forward, float)
    f = f / np.linalg.norm(f)
    right = np.cross(f, [0.0, 0.0, 1.0])
    right = right / np.linalg.norm(right)
    axes = np.stack([right, np.cross(right, f), -f], axis=1)
    return np.asarray(axes @ about_z(roll))
