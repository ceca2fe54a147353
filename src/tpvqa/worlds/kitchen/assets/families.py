"""The list of all families, kind by kind."""

from tpvqa.worlds.kitchen.assets import crockery
from tpvqa.worlds.kitchen.assets.family import Family

FAMILIES: tuple[Family, ...] = (
    Family("plate", "plate-lathe", crockery.plate, fixed=6),
    Family("plate", "plate-deep", crockery.deep_plate, held_out=True, fixed=4),
)
