"""The list of all families, kind by kind."""

from tpvqa.worlds.kitchen.assets import (
    apple,
    bread,
    crockery,
    fridge,
    furniture,
    grippers,
    knives,
    sinks,
    television,
)
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
    Family("table", "table-legs", furniture.table, fixed=4),
    Family("table", "table-round", furniture.round_table),
    Family("table", "table-trestle", furniture.trestle_table, held_out=True, fixed=3),
    Family("counter", "counter-plain", furniture.counter, fixed=4),
    Family("counter", "counter-bold", furniture.bold_counter, held_out=True, fixed=3),
    Family("wall_cabinet", "wall-cabinet", furniture.wall_cabinet),
    Family("tvstand", "tvstand-board", furniture.tvstand, fixed=4),
    Family("tvstand", "tvstand-bench", furniture.tv_bench, held_out=True, fixed=3),
    Family("sink", "sink-basin", sinks.sink, fixed=6),
    Family("sink", "sink-trough", sinks.trough, held_out=True, fixed=4),
    *(Family("gripper", f"gripper-{name}", make) for name, make in grippers.TRAIN.items()),
    *(
        Family("gripper", f"gripper-{name}", make, held_out=True)
        for name, make in grippers.HELD_OUT.items()
    ),
)
