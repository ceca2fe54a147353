"""The things in the kitchen: meshes, materials and textures in many variants."""

from tpvqa.worlds.kitchen.assets.dirt import soiled
from tpvqa.worlds.kitchen.assets.library import (
    Split,
    distractors,
    draw,
    families,
    kinds,
    lookalikes,
    models,
)
from tpvqa.worlds.kitchen.assets.model import (
    Grasp,
    Joint,
    Model,
    Paint,
    Part,
    Solid,
    Surface,
)
from tpvqa.worlds.kitchen.assets.television import OFF, ON
from tpvqa.worlds.kitchen.assets.textures import Texture, draw_texture

__all__ = [
    "OFF",
    "ON",
    "Grasp",
    "Joint",
    "Model",
    "Paint",
    "Part",
    "Solid",
    "Split",
    "Surface",
    "Texture",
    "distractors",
    "draw",
    "draw_texture",
    "families",
    "kinds",
    "lookalikes",
    "models",
    "soiled",
]
