"""What a thing is made of: convex solids, which are seen as they collide."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

FRICTION = (0.5, 0.005, 0.0005)
"""Of things, whatever touches them: less than the toys have (1.2), so that bad grasps slip."""
DENSITY = 200.0
"""Of all things, kg/m³: hollow ones."""
Vec = tuple[float, float, float]
LEVEL = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Solid:
    """A box, cylinder, capsule, ellipsoid or ball of MuJoCo's, or the hull of points.

    Attributes:
        kind: MuJoCo's name of it, or "hull".
        size: Half sizes as MuJoCo has them, metres.
        at: Its middle.
        turned: A quaternion, real part first.
        points: Of a hull, n × 3, metres.
    """

    kind: str
    size: Vec = (0.0, 0.0, 0.0)
    at: Vec = (0.0, 0.0, 0.0)
    turned: tuple[float, float, float, float] = LEVEL
    points: NDArray[np.float64] | None = None


@dataclass(frozen=True)
class Thing:
    """Something to be grasped.

    Attributes:
        name: Of its family.
        solids: What it is made of.
        upright: Whether it is put down as it stands; else it falls any way round.
    """

    name: str
    solids: tuple[Solid, ...]
    upright: bool = False


def turn(axis: Sequence[float], angle: float) -> tuple[float, float, float, float]:
    """The quaternion of a turn about an axis of length 1, radians."""
    s = np.sin(angle / 2)
    return (float(np.cos(angle / 2)), *(float(s * a) for a in axis))  # type: ignore[return-value]


def add(mj: Any, spec: Any, thing: Thing, name: str, at: Sequence[float], quat: Any) -> None:
    """Put a thing into a MuJoCo spec as a body that can move.

    Args:
        mj: The module `mujoco`.
        spec: The spec.
        thing: The thing.
        name: The body's.
        at: Where it is, metres.
        quat: How it is turned.
    """
    body = spec.worldbody.add_body(name=name, pos=list(at), quat=list(quat))
    body.add_freejoint()
    for number, solid in enumerate(thing.solids):
        kinds = {
            "friction": list(FRICTION),
            "condim": 6,
            "priority": 1,
            "solref": [0.01, 1.0],
            "group": 1,
            "density": DENSITY,
            "rgba": [0.55, 0.62, 0.7, 1.0],
        }
        if solid.kind == "hull":
            assert solid.points is not None
            mesh = f"{name}_{number}"
            spec.add_mesh(
                name=mesh,
                uservert=solid.points.ravel().tolist(),
                maxhullvert=48,
                inertia=mj.mjtMeshInertia.mjMESH_INERTIA_CONVEX,
            )
            body.add_geom(type=mj.mjtGeom.mjGEOM_MESH, meshname=mesh, **kinds)
        else:
            kind = getattr(mj.mjtGeom, f"mjGEOM_{solid.kind.upper()}")
            body.add_geom(
                type=kind,
                size=list(solid.size),
                pos=list(solid.at),
                quat=list(solid.turned),
                **kinds,
            )
