"""The things in the kitchen: meshes, materials and textures in many variants."""

from tpvqa.worlds.kitchen.assets.library import Split, draw, families, kinds, models
from tpvqa.worlds.kitchen.assets.model import (
    Grasp,
    Joint,
    Model,
    Paint,
    Part,
    Solid,
    Surface,
)

__all__ = [
    "Grasp",
    "Joint",
    "Model",
    "Paint",
    "Part",
    "Solid",
    "Split",
    "Surface",
    "draw",
    "families",
    "kinds",
    "models",
]
