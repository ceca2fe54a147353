"""Colours and lights of a kitchen, changed without compiling it again."""

import colorsys
from collections.abc import Mapping
from typing import Any

import numpy as np

from tpvqa_household.kitchen.furniture import ROOM, ROOM_CHOICE
from tpvqa_household.kitchen.rotation import Array


def colour(
    rng: np.random.Generator, *, saturation: float, dark: float, bright: float = 1.0
) -> Array:
    """A random colour, at most so saturated and between so dark and so bright."""
    return np.array(
        colorsys.hsv_to_rgb(
            rng.random(), rng.random() * saturation, float(rng.uniform(dark, bright))
        )
    )


class Paintwork:
    """Repaints and lights one model.

    Args:
        model: The compiled scene.
        material: Number of each material by name.
        geom: Number of each geom by name.
    """

    def __init__(self, model: Any, material: Mapping[str, int], geom: Mapping[str, int]):
        self._model, self._material = model, material
        self._surfaces = {
            use: [k for name, k in geom.items() if name.split("_")[0] == use] for use in ROOM
        }
        self._base = model.mat_rgba.copy()
        self._light_position = model.light_pos.copy()
        self._light_colour = model.light_diffuse.copy()

    def repaint(self, rng: np.random.Generator) -> None:
        """Other textures and tints for the walls and the floor, and tints for the rest."""
        model = self._model
        model.mat_rgba[:] = self._base
        for use, geoms in self._surfaces.items():
            material = self._material[f"{use}{int(rng.integers(ROOM_CHOICE))}"]
            model.geom_matid[geoms] = material
            if rng.random() < 0.6:
                model.mat_rgba[material, :3] = colour(rng, saturation=0.35, dark=0.7)
        for name, material in self._material.items():
            if name.startswith(("counter-", "sink-", "table-", "tvstand-", "wall-cabinet-")):
                model.mat_rgba[material, :3] *= colour(rng, saturation=0.12, dark=0.8)

    def light(self, rng: np.random.Generator) -> None:
        """Other strength, colour and place of the lights."""
        model = self._model
        strength = float(rng.uniform(0.7, 1.3))
        model.vis.headlight.ambient[:] = rng.uniform(0.32, 0.46) * colour(
            rng, saturation=0.08, dark=0.92
        )
        model.vis.headlight.diffuse[:] = rng.uniform(0.22, 0.42)
        for k in range(model.nlight):
            tint = colour(rng, saturation=0.15, dark=0.9)
            model.light_diffuse[k] = np.clip(
                self._light_colour[k] * strength * rng.uniform(0.7, 1.3) * tint, 0, 1
            )
            model.light_pos[k] = self._light_position[k] + rng.uniform(-0.8, 0.8, 3) * [1, 1, 0.1]
