"""Random states of the household, so that every answer to every question occurs."""

import numpy as np

from tpvqa.pddl import State
from tpvqa_household.kitchen.household import FIXTURES, HANDS, HOMES, ITEMS, SUPPORTS, Household

_NEAR = {"table": 0.9, "counter": 1.2, "floor": 1.0, "sink": 1.3, "fridge": 1.6, "tv": 1.3}
_PLACES = {"table": 1.0, "counter": 1.0, "floor": 0.8, "sink": 0.7, "fridge": 0.8, "plate": 1.0}


def random_household(rng: np.random.Generator) -> Household:
    """A state that the robot may meet: things at home, elsewhere, in a hand, dropped."""
    count = int(rng.choice(3, p=[0.35, 0.4, 0.25]))
    items = [str(item) for item in rng.permutation(ITEMS)]
    hands = [str(hand) for hand in rng.permutation(HANDS)]
    held = dict(zip(hands[:count], items, strict=False))
    where: dict[str, str] = {}
    for item in ITEMS:
        if item in held.values():
            continue
        places = [place for place in SUPPORTS if place != item]
        weights = np.array([_PLACES[place] for place in places])
        if rng.random() < 0.35:
            where[item] = HOMES[item]
        else:
            where[item] = str(rng.choice(places, p=weights / weights.sum()))
    things = (*ITEMS, *FIXTURES)
    weights = np.array([_NEAR.get(thing, 1.7) for thing in things])
    near = str(rng.choice(things, p=weights / weights.sum()))
    support = Household(near=near, held=held, where=where).support(near) if near in ITEMS else None
    return Household(
        near=near,
        held=held,
        where=where,
        # What lies in a closed fridge cannot be stood before.
        opened=bool(support == "fridge" or rng.random() < 0.5),
        turned_on=bool(rng.random() < 0.5),
        clean=bool(rng.random() < 0.5),
        halved=bool(rng.random() < 0.45),
    )


def random_state(rng: np.random.Generator) -> State:
    """The facts of a `random_household`."""
    return random_household(rng).state()
