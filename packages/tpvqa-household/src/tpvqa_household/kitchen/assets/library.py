"""The library of things: every kind in many variants, some of them kept from training.

    model = draw("plate", rng, split="train")
    xml = "<asset>" + "".join(model.mjcf_assets()) + "</asset>…<body>" + model.mjcf_inside("plate_")
    MjModel.from_xml_string(xml, assets=model.files)

A scene lists the assets and files of each distinct `Model.name` once. A family of variants
belongs to one split for good, so what is held out has shapes, and not only colours, that
training never sees.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Literal

from numpy.random import Generator

from tpvqa.chance import chance_array
from tpvqa.errors import UnknownNameError
from tpvqa_household.kitchen.assets.families import FAMILIES
from tpvqa_household.kitchen.assets.family import Family
from tpvqa_household.kitchen.assets.model import Model

Split = Literal["train", "held_out", "all"]

MAIN = (
    "plate",
    "bread",
    "apple",
    "apple_half",
    "knife",
    "tv",
    "fridge",
    "sink",
    "table",
    "counter",
    "wall_cabinet",
    "tvstand",
    "gripper",
)
"""What a kitchen is made of and what the tasks are about; all other kinds just stand about."""

LOOKALIKES = {
    "plate": ("lid", "saucer", "bowl", "pan", "tray"),
    "bread": ("box", "croissant", "sponge", "potato", "cake", "pencil_case"),
    "apple": ("orange", "tomato", "lemon", "ball", "pear", "potato"),
    "knife": ("spoon", "fork", "spatula", "remote", "peeler", "whisk"),
}
"""For each thing that is handled, kinds that a careless eye takes for it."""


def kinds() -> tuple[str, ...]:
    """All kinds of things, in the library's order."""
    return tuple(dict.fromkeys(family.kind for family in FAMILIES))


def distractors(*, split: Split = "all") -> tuple[str, ...]:
    """The kinds that just stand about and have variants in this split."""
    return tuple(kind for kind in kinds() if kind not in MAIN and families(kind, split=split))


def lookalikes(kind: str, *, split: Split = "all") -> tuple[str, ...]:
    """The kinds that may be taken for this one, and have variants in this split."""
    return tuple(other for other in LOOKALIKES.get(kind, ()) if families(other, split=split))


def families(kind: str, *, split: Split = "all") -> tuple[Family, ...]:
    """The ways of making a thing of this kind.

    Raises:
        UnknownNameError: There is no such kind.
    """
    found = tuple(family for family in FAMILIES if family.kind == kind)
    if not found:
        raise UnknownNameError("kind of thing", kind, kinds())
    return tuple(f for f in found if split == "all" or f.held_out == (split == "held_out"))


def models(kind: str, *, split: Split = "all") -> Sequence[Model]:
    """A fixed list of variants: the scanned ones and a few of each procedural family.

    Raises:
        UnknownNameError: There is no such kind.
    """
    return [
        _fixed(family, number)
        for family in families(kind, split=split)
        for number in range(family.fixed)
    ]


def draw(kind: str, rng: Generator, *, split: Split) -> Model:
    """A random variant, a function of the generator's state.

    Raises:
        UnknownNameError: There is no such kind, or none of it in this split.
    """
    choice = families(kind, split=split)
    if not choice:
        raise UnknownNameError(f"{split} kind of thing", kind, kinds())
    total = sum(family.weight for family in choice)
    at = float(rng.random()) * total
    for family in choice:
        at -= family.weight
        if at < 0:
            break
    number = int(rng.integers(2**40))
    return _made(family, chance_array(number, 0, "asset", family.name), f"{number:010x}")


@lru_cache(maxsize=256)
def _fixed(family: Family, number: int) -> Model:
    return _made(family, chance_array(number, 0, "fixed asset", family.name), f"{number}")


def _made(family: Family, rng: Generator, number: str) -> Model:
    model = family.make(rng)
    return _placed(model, family).named(f"{family.name}-{number}")


def _placed(model: Model, family: Family) -> Model:
    half = model.half and replace(
        model.half, kind="apple_half", family=family.name, held_out=family.held_out
    )
    return replace(model, kind=family.kind, family=family.name, held_out=family.held_out, half=half)
