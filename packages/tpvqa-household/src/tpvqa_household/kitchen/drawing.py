"""Draws a MuJoCo scene into arrays: colours, and which geom each pixel shows."""

import weakref
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tpvqa_household.kitchen.gl import cannot_draw, load_mujoco, new_context


class Drawing:
    """An off-screen canvas for one model. Use it from the thread that made it; `close()` frees it.

    Args:
        model: A compiled MuJoCo model.
        size: Height and width of the canvas, pixels.

    Raises:
        WorldError: There is no graphics library to draw with.
    """

    def __init__(self, model: Any, size: int):
        self._mujoco = mj = load_mujoco()
        self.size = size
        self._gl = new_context(size)
        try:
            self._gl.make_current()
            self._context = mj.MjrContext(model, mj.mjtFontScale.mjFONTSCALE_100)
            mj.mjr_setBuffer(mj.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        except Exception as error:
            raise cannot_draw(error) from error
        self.close = weakref.finalize(self, _free, self._gl, self._context)
        self._model = model
        self._scene = mj.MjvScene(model, maxgeom=2000)
        self._camera = mj.MjvCamera()
        self._camera.type = mj.mjtCamera.mjCAMERA_FIXED
        self._option = mj.MjvOption()
        self._option.geomgroup[:] = [1, 1, 1, 0, 0, 0]
        self._perturb = mj.MjvPerturb()

    def _draw(self, data: Any, camera: int, size: int, *, ids: bool, shadow: bool) -> Any:
        mj = self._mujoco
        self._gl.make_current()
        self._camera.fixedcamid = camera
        mj.mjv_updateScene(
            self._model,
            data,
            self._option,
            self._perturb,
            self._camera,
            int(mj.mjtCatBit.mjCAT_ALL),
            self._scene,
        )
        flags = self._scene.flags
        flags[mj.mjtRndFlag.mjRND_SHADOW] = int(shadow and not ids)
        flags[mj.mjtRndFlag.mjRND_REFLECTION] = 0
        flags[mj.mjtRndFlag.mjRND_SEGMENT] = int(ids)
        flags[mj.mjtRndFlag.mjRND_IDCOLOR] = int(ids)
        flags[mj.mjtRndFlag.mjRND_SKYBOX] = int(not ids)
        rectangle = mj.MjrRect(0, 0, size, size)
        out = np.empty((size, size, 3), np.uint8)
        mj.mjr_render(rectangle, self._scene, self._context)
        mj.mjr_readPixels(out, None, rectangle, self._context)
        return out[::-1]

    def picture(self, data: Any, camera: int, *, shadow: bool = True) -> NDArray[np.uint8]:
        """What the camera sees, size × size × 3."""
        return np.ascontiguousarray(self._draw(data, camera, self.size, ids=False, shadow=shadow))

    def geoms(self, data: Any, camera: int, size: int) -> NDArray[np.int64]:
        """The number of the geom that each pixel shows, the model's `ngeom` where none."""
        rgb = self._draw(data, camera, size, ids=True, shadow=False).astype(np.int32)
        segment = rgb[..., 0] + (rgb[..., 1] << 8) + (rgb[..., 2] << 16) - 1
        geom_of = np.full(self._scene.ngeom + 1, self._model.ngeom, np.int64)
        for geom in self._scene.geoms[: self._scene.ngeom]:
            if geom.objtype == self._mujoco.mjtObj.mjOBJ_GEOM and geom.segid >= 0:
                geom_of[geom.segid] = geom.objid
        segment[(segment < 0) | (segment >= self._scene.ngeom)] = self._scene.ngeom
        return np.asarray(geom_of[segment])


def _free(gl: Any, context: Any) -> None:
    gl.make_current()
    context.free()
    gl.free()
