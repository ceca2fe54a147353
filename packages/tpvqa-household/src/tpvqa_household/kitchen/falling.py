"""How a dropped thing comes to rest on the floor, by physics."""

from functools import lru_cache
from typing import Any

import numpy as np

from tpvqa_household.kitchen.assets import Model
from tpvqa_household.kitchen.gl import load_mujoco
from tpvqa_household.kitchen.rotation import Array, about_x, about_y, about_z, matrix, quaternion

SECONDS = 2.5
"""A fall is not followed longer than this."""
_STEP = 0.004
_REST = 0.02
_REACH = 0.2
_WORLD = """<mujoco><option timestep="{step}" integrator="implicitfast"/><worldbody>
<geom type="plane" size="5 5 0.1" friction="1 0.05 0.01"/>
<body name="thing"><freejoint/>{solids}</body></worldbody></mujoco>"""


def come_to_rest(model: Model, rng: np.random.Generator) -> tuple[Array, Array]:
    """Drop a thing from about a hand's height.

    Args:
        model: What falls; its solids and its mass count.
        rng: Decides how it is held and let go.

    Returns:
        Position, relative to the point of the floor above which it was held, and axes as columns.
        Plates land the right way up: dropped ones that turn over are dropped again.
    """
    mujoco = load_mujoco()
    world = _compile("".join(model.mjcf_solids("")))
    data = mujoco.MjData(world)
    tilt = 0.5 if model.kind == "plate" else 1.2
    for _ in range(5):
        mujoco.mj_resetData(world, data)
        axes = about_z(rng.uniform(0, 2 * np.pi)) @ about_x(rng.uniform(-tilt, tilt))
        axes = axes @ about_y(rng.uniform(-tilt, tilt))
        data.qpos[:] = [0, 0, rng.uniform(0.45, 0.8), *quaternion(axes)]
        data.qvel[:] = [*rng.uniform(-0.2, 0.2, 3), *rng.uniform(-2, 2, 3)]
        for step in range(round(SECONDS / _STEP)):
            mujoco.mj_step(world, data)
            if step > 100 and np.abs(data.qvel).max() < _REST:
                break
        if model.kind != "plate" or matrix(data.qpos[3:])[2, 2] > 0.5:
            break
    position = data.qpos[:3].copy()
    away = float(np.hypot(position[0], position[1]))
    position[:2] *= min(1.0, _REACH / max(away, 1e-9))  # what rolls off is stopped by something
    return position, matrix(data.qpos[3:])


@lru_cache(maxsize=32)
def _compile(solids: str) -> Any:
    return load_mujoco().MjModel.from_xml_string(_WORLD.format(step=_STEP, solids=solids))
