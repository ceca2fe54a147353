"""An arranged kitchen as plain arrays, for a renderer that knows nothing of MuJoCo.

`scene` is JSON: camera (matrix, fovy in degrees), parts (shape, size, matrix, mesh, material),
materials, area lights, background, exposure and seed. Beside it `vertices_K`, `faces_K`, `uv_K`
(one pair a corner) of each mesh, and `texture_K` (height × width × 3, the first row at v = 0).
Lights, exposure and the finish of surfaces are drawn anew for each picture: they are not those
of the training pictures.
"""

import colorsys
import json
import random
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from tpvqa.chance import chance
from tpvqa_household.kitchen.furniture import Furniture
from tpvqa_household.kitchen.gl import load_mujoco
from tpvqa_household.kitchen.scene import KitchenScene

mujoco = load_mujoco()
SHAPES = {
    mujoco.mjtGeom.mjGEOM_PLANE: "plane",
    mujoco.mjtGeom.mjGEOM_SPHERE: "sphere",
    mujoco.mjtGeom.mjGEOM_CAPSULE: "capsule",
    mujoco.mjtGeom.mjGEOM_ELLIPSOID: "ellipsoid",
    mujoco.mjtGeom.mjGEOM_CYLINDER: "cylinder",
    mujoco.mjtGeom.mjGEOM_BOX: "box",
    mujoco.mjtGeom.mjGEOM_MESH: "mesh",
}
DRAWN = 3
"""Geoms of this group and above are not drawn."""
GLOW = 0.3
"""Emission from which a surface is a light of its own (a screen, a lamp)."""


def scene_arrays(scene: KitchenScene, *, look: int) -> dict[str, Any]:
    """The arrays of a scene file.

    Args:
        scene: An arranged kitchen.
        look: What it was arranged for; decides lights and finish, with the kitchen.
    """
    model = scene.model
    writer = _Writer(model, scene.data, chance(scene.seed, look, "cycles"))
    for geom in range(model.ngeom):
        if model.geom_group[geom] < DRAWN:
            writer.add(geom)
    return writer.finish(scene)


class _Writer:
    def __init__(self, model: Any, data: Any, draw: random.Random):
        self.model, self.data, self.draw = model, data, draw
        self.arrays: dict[str, Any] = {}
        self.parts: list[dict[str, Any]] = []
        self.materials: list[dict[str, Any]] = []
        self._known: dict[tuple[Any, ...], int] = {}

    def add(self, geom: int) -> None:
        """Add a geom as a part."""
        model, data = self.model, self.data
        matrix = np.eye(4)
        matrix[:3, :3] = data.geom_xmat[geom].reshape(3, 3)
        matrix[:3, 3] = data.geom_xpos[geom]
        shape = SHAPES[mujoco.mjtGeom(model.geom_type[geom])]
        self.parts.append(
            {
                "shape": shape,
                "size": model.geom_size[geom].tolist(),
                "matrix": matrix.tolist(),
                "mesh": self._mesh(int(model.geom_dataid[geom])) if shape == "mesh" else None,
                "material": self._material(geom),
            }
        )

    def _mesh(self, mesh: int) -> int:
        if f"vertices_{mesh}" in self.arrays:
            return mesh
        model = self.model
        first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        start, faces = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
        self.arrays[f"vertices_{mesh}"] = model.mesh_vert[first : first + count].copy()
        self.arrays[f"faces_{mesh}"] = model.mesh_face[start : start + faces].copy()
        texcoord, count = model.mesh_texcoordadr[mesh], model.mesh_texcoordnum[mesh]
        if texcoord >= 0:
            corners = model.mesh_facetexcoord[start : start + faces].ravel()
            self.arrays[f"uv_{mesh}"] = model.mesh_texcoord[texcoord : texcoord + count][corners]
        return mesh

    def _material(self, geom: int) -> int:
        model, number = self.model, int(self.model.geom_matid[geom])
        # A geom's own colour counts only where it was changed from the default.
        own = model.geom_rgba[geom]
        plain = number >= 0 and np.allclose(own, (0.5, 0.5, 0.5, 1.0))
        rgba = (model.mat_rgba[number] if plain else own).astype(float)
        key = (number, *rgba.round(4))
        if key in self._known:
            return self._known[key]
        name = "colour" if number < 0 else model.material(number).name
        emission = float(model.mat_emission[number]) if number >= 0 else 0.0
        shine = float(model.mat_shininess[number]) if number >= 0 else 0.3
        specular = float(model.mat_specular[number]) if number >= 0 else 0.2
        metal = any(word in name for word in ("steel", "chrome", "metal", "blade", "tap", "faucet"))
        texture = self._texture(number)
        glows = emission >= GLOW
        self._known[key] = len(self.materials)
        self.materials.append(
            {
                "name": name,
                "rgba": rgba.tolist(),
                "texture": texture,
                "repeat": (model.mat_texrepeat[number] if number >= 0 else np.ones(2)).tolist(),
                "uniform": bool(number >= 0 and model.mat_texuniform[number]),
                "metallic": self.draw.uniform(0.6, 0.95) if metal and texture is None else 0.0,
                "roughness": min(
                    0.85, max(0.12, 0.75 - 0.45 * max(shine, specular) + self.draw.gauss(0, 0.08))
                ),
                "emission": self.draw.uniform(0.9, 1.8) if glows else 0.0,
            }
        )
        return self._known[key]

    def _texture(self, material: int) -> int | None:
        if material < 0:
            return None
        used = [int(texture) for texture in np.atleast_1d(self.model.mat_texid[material])]
        texture = next((texture for texture in used if texture >= 0), None)
        if texture is None:
            return None
        if f"texture_{texture}" not in self.arrays:
            model = self.model
            width, height = int(model.tex_width[texture]), int(model.tex_height[texture])
            channels, start = int(model.tex_nchannel[texture]), int(model.tex_adr[texture])
            pixels = model.tex_data[start : start + width * height * channels]
            self.arrays[f"texture_{texture}"] = np.array(
                pixels.reshape(height, width, channels)[..., :3]
            )
        return texture

    def finish(self, scene: KitchenScene) -> dict[str, Any]:
        """Everything, with camera and lights."""
        draw, model = self.draw, self.model
        camera = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_CAMERA, "robot")
        matrix = np.eye(4)
        matrix[:3, :3] = self.data.cam_xmat[camera].reshape(3, 3)
        matrix[:3, 3] = self.data.cam_xpos[camera]
        head = self.data.cam_xpos[camera].tolist()
        self.arrays["scene"] = json.dumps(
            {
                "camera": {"matrix": matrix.tolist(), "fovy": float(model.cam_fovy[camera])},
                "parts": self.parts,
                "materials": self.materials,
                "lights": _lights(scene.furniture, head, draw),
                "background": {"colour": _tint(draw, 0.12), "strength": draw.uniform(0.05, 0.18)},
                "exposure": draw.uniform(-0.75, 0.05),
                "seed": draw.randrange(2**31),
            }
        )
        return self.arrays


def _tint(draw: random.Random, saturation: float) -> list[float]:
    """A nearly white colour, from the yellow of a bulb to the blue of the sky."""
    hue = draw.choice((draw.uniform(0.07, 0.14), draw.uniform(0.53, 0.62)))
    return list(colorsys.hsv_to_rgb(hue, draw.uniform(0.0, saturation), 1.0))


def _lights(
    furniture: Furniture, head: Sequence[float], draw: random.Random
) -> list[dict[str, Any]]:
    """One or two ceiling lamps, a window, a weak light behind the robot, the fridge's lamp."""
    layout = furniture.layout
    width, depth, height = layout.width, layout.depth, layout.height
    room = width * depth / 16

    def light(
        position: Iterable[float], target: Iterable[float], watts: float, size: float, tint: float
    ) -> dict[str, Any]:
        return {
            "position": [float(x) for x in position],
            "target": [float(x) for x in target],
            "watts": watts,
            "size": size,
            "colour": _tint(draw, tint),
        }

    lights = []
    lamps = draw.choice((1, 2, 2))
    for k in range(lamps):
        x = width * (draw.uniform(-0.25, 0.25) + (0.25 * (2 * k - 1) if lamps == 2 else 0.0))
        y = -depth * draw.uniform(0.3, 0.7)
        watts = 90 * room / lamps * draw.uniform(0.6, 1.5)
        lights.append(light((x, y, height - 0.04), (x, y, 0), watts, draw.uniform(0.3, 1.2), 0.3))
    side = draw.choice((-1, 1))
    window = (side * (width / 2 - 0.06), -depth * draw.uniform(0.4, 0.8), draw.uniform(1.4, 1.9))
    lights.append(
        light(window, (0, -depth / 2, 0.6), 70 * room * draw.uniform(0.1, 1.2), 1.0, 0.15)
    )
    lights.append(light((head[0], head[1], height - 0.3), (0, -0.6, 0.9), 8, 0.8, 0.1))
    fridge, model = layout.fridge, furniture.models["fridge"]
    front = model.extent[1] / 2 - 0.12
    lamp = fridge.point(0, -front, model.extent[2] - 0.14)
    lights.append(light(lamp, fridge.point(0, 0, 0.6), draw.uniform(0.8, 2.0), 0.12, 0.1))
    return lights
