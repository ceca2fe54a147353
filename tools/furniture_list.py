"""Which models of Sweet Home 3D's packs are taken, for what, and in which split.

`turn` (degrees about the upright axis) makes fronts face -y and long things lie along x;
`groups` picks some of the objects in the file, by a regular expression.
"""

from dataclasses import dataclass

CC0 = "BlendSwap-CC-0"
CCBY = "BlendSwap-CC-BY"
KATOR = "KatorLegaz"
SCOPIA = "Scopia"


@dataclass(frozen=True, slots=True)
class Item:
    """One thing to convert.

    Attributes:
        kind: What it is in the library.
        name: Its id in the library.
        pack: Which pack.
        model: Name of the model's folder in the pack.
        held_out: Kept from training.
        turn: Degrees about the upright axis.
        tip: Degrees about the x axis, before turning: to lay upright things down.
        groups: Regular expression over the file's object names.
        size: Length of its longest side in metres, where the catalogue's does not fit.
        flat: Lay it down: its longest direction along x, its shortest upright.
        both_sides: Show faces from behind too.
        screen: Regular expression over material names: the part that is the screen.
    """

    kind: str
    name: str
    pack: str
    model: str
    held_out: bool = False
    turn: float = 0.0
    tip: float = 0.0
    groups: str = ""
    size: float | None = None
    flat: bool = False
    both_sides: bool = False
    screen: str = ""


ITEMS: tuple[Item, ...] = (
    Item("plate", "plate-kator", KATOR, "bread-plate"),
    Item("plate", "plate-oval", KATOR, "dinner-plate", held_out=True),
    Item(
        "plate",
        "plate-gold",
        SCOPIA,
        "ensemble-assiette-couteau-fourchette-cuillere-verre",
        held_out=True,
        groups="^dish",
    ),
    Item("bread", "bread-yd", CC0, "bread"),
    Item("apple", "apple-scopia", SCOPIA, "apples", groups="^apple2_Tube.002", size=0.082),
    Item("knife", "knife-country", CCBY, "kitchenKnife", turn=-90),
    Item("knife", "knife-stand-a", SCOPIA, "kitchenKnifeStandSet", groups="^knife_Cube", flat=True),
    Item("knife", "knife-dinner", CCBY, "knife", turn=-90, held_out=True),
    Item(
        "knife",
        "knife-flatware",
        KATOR,
        "plate-and-ustensils",
        groups="^table_knife",
        turn=-90,
        held_out=True,
    ),
    Item("tv", "tv-led", CC0, "led_tv", screen="^screen"),
    Item("tv", "tv-wall", SCOPIA, "wall-flat-tv", screen="screen-tv", held_out=True),
    Item("tv", "tv-scopia", SCOPIA, "tv", screen="tvblack", held_out=True),
    Item("sink", "sink-vladoffsky", CC0, "sinkCabinet"),
    Item("sink", "sink-country", CCBY, "kitchenSink", held_out=True),
    Item("counter", "counter-vladoffsky", CC0, "lowerCabinet"),
    Item("counter", "counter-drawers", CC0, "drawersCabinet"),
    Item("counter", "counter-country", CCBY, "kitchenLowerCabinet", held_out=True),
    Item("wall_cabinet", "wall-cabinet-vladoffsky", CC0, "upperCabinet"),
    Item("wall_cabinet", "wall-cabinet-country", CCBY, "kitchenUpperCabinet", held_out=True),
    Item("table", "table-country", CCBY, "table"),
    Item("table", "table-four", SCOPIA, "table4"),
    Item("table", "table-white", SCOPIA, "white_kitchen_table"),
    Item("table", "table-alder", SCOPIA, "wooden_office_alder_table", held_out=True),
    Item("table", "table-leaning", SCOPIA, "table-with-leaning-feet", held_out=True),
    Item("tvstand", "tvstand-leximumxii", CCBY, "tvStand"),
    Item("toaster", "toaster-scopia", SCOPIA, "toaster"),
    Item("milk", "milk-tetrapak", CC0, "tetrapak"),
    Item("fruits", "fruits-scopia", SCOPIA, "bowlWithFruits", groups="^(?!apple)", size=0.32),
    Item("teddy", "teddy-manitislate", CC0, "teddyBear"),
    Item("train", "train-toy", CCBY, "toyTrain"),
    Item("ball", "ball-soccer", CCBY, "ballonFoot", size=0.15),
    Item("rubik", "rubik-farcgs", CCBY, "rubix2"),
    Item("biplane", "biplane-toy", CC0, "cartoon_biplane", held_out=True),
    Item("pear", "pear-scopia", SCOPIA, "bowlWithFruits", groups="^pear$", size=0.1, held_out=True),
    Item("orange", "orange-scopia", SCOPIA, "bowlWithFruits", groups="^orange_Cube$", size=0.08),
    Item("mug", "mug-kator", KATOR, "coffee-mug"),
    Item("mug", "mug-paper", CCBY, "coffee_cup", held_out=True),
    Item("saucer", "saucer-reduno", CC0, "caffe_final"),
    Item("saucer", "saucer-scopia", SCOPIA, "cup", held_out=True),
    Item("bowl", "bowl-salad", SCOPIA, "bowlWithSalad", held_out=True),
    Item("bottle", "bottle-beer", CCBY, "beer_bottle"),
    Item("bottle", "bottle-wine", SCOPIA, "wine_bottle", held_out=True),
    Item("bottle", "bottle-yogurt", CC0, "yogurtBottle"),
    Item("fork", "fork-country", CCBY, "fork", turn=-90),
    Item(
        "fork",
        "fork-flatware",
        KATOR,
        "plate-and-ustensils",
        groups="^fork",
        turn=-90,
        held_out=True,
    ),
    Item("spoon", "spoon-country", CCBY, "spoon", turn=-90),
    Item(
        "spoon",
        "spoon-flatware",
        KATOR,
        "plate-and-ustensils",
        groups="^teaspoon",
        turn=180,
        held_out=True,
    ),
    Item("board", "board-country", CCBY, "choppingBoard"),
    Item("kettle", "kettle-country", CCBY, "boiler"),
    Item("kettle", "kettle-espresso", CCBY, "espressokettle", held_out=True),
    Item("microwave", "microwave-country", CCBY, "microwave"),
    Item("coffee_maker", "coffee-maker-kator", KATOR, "coffee-maker"),
    Item("coffee_maker", "coffee-press", CCBY, "coffeePress", held_out=True),
    Item("scale", "scale-oldtimer", CCBY, "kitchenScale", held_out=True),
    Item("radio", "radio-country", CCBY, "radio"),
    Item("teapot", "teapot-scopia", SCOPIA, "teapot", held_out=True),
    Item("cake", "cake-birthday", SCOPIA, "birthday_cake", held_out=True),
    Item("hotdog", "hotdog-erickfree", CC0, "hotDog"),
    Item("hamburger", "hamburger-saizyca", CCBY, "hamburger", held_out=True),
    Item("cupcake", "cupcake-dvachib", CC0, "cupcake"),
    Item("butter", "butter-bmf", CC0, "butter"),
    Item("toy", "toy-wood", CC0, "woodToy"),
    Item("creamer", "creamer-scopia", SCOPIA, "creamer"),
    Item("utensils", "utensils-pot", CCBY, "utensilsPot"),
    Item("remote", "remote-scopia", SCOPIA, "tv-remote-control", turn=90, held_out=True),
)
