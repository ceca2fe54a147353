"""The list of all families, kind by kind."""

from tpvqa.worlds.kitchen.assets import apple, bread, crockery
from tpvqa.worlds.kitchen.assets.family import Family

FAMILIES: tuple[Family, ...] = (
    Family("plate", "plate-lathe", crockery.plate, fixed=6),
    Family("plate", "plate-deep", crockery.deep_plate, held_out=True, fixed=4),
    Family("bread", "bread-tin", bread.tin_loaf),
    Family("bread", "bread-round", bread.round_loaf),
    Family("bread", "bread-baguette", bread.baguette),
    Family("bread", "bread-roll", bread.roll),
    Family("bread", "bread-sliced", bread.sliced_loaf, held_out=True),
    Family("bread", "bread-plaited", bread.plaited_loaf, held_out=True),
    Family("apple", "apple-lathe", apple.apple, fixed=6),
    Family("apple", "apple-tall", apple.tall_apple, held_out=True, fixed=4),
    Family("apple_half", "apple-half-lathe", apple.half, fixed=4),
    Family("apple_half", "apple-half-tall", apple.tall_half, held_out=True),
)
