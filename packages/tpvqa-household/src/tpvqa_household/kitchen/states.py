"""Random states of the household, for training pictures."""

import numpy as np

from tpvqa.pddl import State
from tpvqa_household.kitchen.household import FIXTURES, HANDS, HOMES, ITEMS, Household

PLACES = ("table", "counter", "floor", "sink", "fridge")


def sample_state(rng: np.random.Generator, *, wild: float = 0.5) -> State:
    """A random state.

    Args:
        rng: Decides.
        wild: Share of states in which anything can be anywhere. The others are near those that
            a task leads through: most things lie where they usually do.
    """
    anywhere = bool(rng.random() < wild)
    near = str(rng.choice([*ITEMS, *FIXTURES]))
    held: dict[str, str] = {}
    hands = [str(h) for h in rng.permutation(HANDS)]
    # What the robot looks for is in its hand about as often as not.
    wanted = [near] if near in ITEMS and rng.random() < 0.4 else []
    others = [str(x) for x in rng.permutation(ITEMS) if x != near]
    number = int(rng.choice(3, p=[0.4, 0.4, 0.2]))
    for item in (wanted + others)[: max(number, len(wanted))]:
        held[hands.pop()] = item
    where: dict[str, str] = {}
    for item in ITEMS:
        if item not in held.values():
            where[item] = _place(item, near, rng, anywhere=anywhere)
    plate_under = [x for x in where if x != "plate" and where[x] == "plate"]
    if len(plate_under) > 1 and rng.random() < 0.7:  # mostly one thing on the plate
        for item in plate_under[1:]:
            where[item] = HOMES[item]
    return Household(
        near=near,
        held=held,
        where=where,
        opened=_opened(near, where, rng),
        turned_on=bool(rng.random() < 0.5),
        clean=bool(rng.random() < 0.5),
        halved=bool(rng.random() < 0.4),
    ).state()


def _place(item: str, near: str, rng: np.random.Generator, *, anywhere: bool) -> str:
    draw = rng.random()
    if near in PLACES and near != "fridge" and draw < 0.3:
        return near
    if item != "plate" and near == "plate" and draw < 0.3:
        return "plate"
    if not anywhere:
        if draw < 0.7:
            return HOMES[item]
        if item == near or draw < 0.85:
            return "floor"
        return "plate" if item == "bread" else HOMES[item]
    if item != "plate" and draw < 0.45:
        return "plate"
    return str(rng.choice(PLACES, p=[0.26, 0.26, 0.2, 0.14, 0.14]))


def _opened(near: str, where: dict[str, str], rng: np.random.Generator) -> bool:
    inside = where.get(near) == "fridge" or where.get(where.get(near, "")) == "fridge"
    return bool(rng.random() < (0.85 if inside else 0.5))
