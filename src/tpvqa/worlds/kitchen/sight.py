"""Whether one point can be seen from another."""

from typing import Any

import numpy as np

from tpvqa.worlds.kitchen.gl import load_mujoco
from tpvqa.worlds.kitchen.rotation import Array


class Sight:
    """Casts rays through an arranged scene. Glass does not stop them."""

    def __init__(self, model: Any, data: Any):
        self._mujoco, self._model, self._data = load_mujoco(), model, data
        self._drawn = np.array([1, 1, 1, 0, 0, 0], np.uint8)

    def clear(self, start: Array, end: Array, body: int) -> bool:
        """Whether nothing but the body itself stands between two points."""
        way = end - start
        length = float(np.linalg.norm(way))
        way /= length
        gone = 0.0
        geom = np.zeros(1, np.int32)
        for _ in range(8):
            hit = self._mujoco.mj_ray(
                self._model, self._data, start + way * gone, way, self._drawn, 1, -1, geom
            )
            if geom[0] < 0 or gone + hit >= length - 0.005:
                return True
            if self._model.geom_bodyid[geom[0]] == body:
                return True
            material = self._model.geom_matid[geom[0]]
            if material < 0 or self._model.mat_rgba[material, 3] > 0.9:
                return False
            gone += hit + 0.002
        return False
