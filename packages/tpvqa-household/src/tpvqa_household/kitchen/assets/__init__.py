"""The things in the kitchen: meshes, materials and textures in many variants."""

from tpvqa_household.kitchen.assets.dirt import soiled
from tpvqa_household.kitchen.assets.library import (
    Split,
    distractors,
    draw,
    families,
    kinds,
    lookalikes,
    models,
)
from tpvqa_household.kitchen.assets.model import (
    Grasp,
    Joint,
    Model,
    Paint,
    Part,
    Solid,
    Surface,
)
from tpvqa_household.kitchen.assets.television import OFF, ON
from tpvqa_household.kitchen.assets.textures import Texture, draw_texture

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
