"""The list of all families, kind by kind."""

from tpvqa.worlds.kitchen.assets import apple, bread, crockery, fridge, knives, television
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
    Family("knife", "knife-chef", knives.chef),
    Family("knife", "knife-paring", knives.paring),
    Family("knife", "knife-santoku", knives.santoku),
    Family("knife", "knife-bread", knives.bread_knife),
    Family("knife", "knife-table", knives.table_knife),
    Family("knife", "knife-cleaver", knives.cleaver, held_out=True),
    Family("knife", "knife-steel", knives.steel_knife, held_out=True),
    Family("tv", "tv-flat", television.flat, fixed=6),
    Family("tv", "tv-tube", television.tube_set, held_out=True),
    Family("tv", "tv-easel", television.easel, held_out=True),
    Family("fridge", "fridge-door", fridge.fridge, fixed=6),
    Family("fridge", "fridge-side-by-side", fridge.side_by_side, held_out=True),
    Family("fridge", "fridge-retro", fridge.retro, held_out=True),
)
