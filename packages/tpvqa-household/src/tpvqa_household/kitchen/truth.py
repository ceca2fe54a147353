"""Which facts a picture shows: from how many pixels of each thing are in it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from tpvqa.pddl import Atom
from tpvqa_household.kitchen.household import FIXTURES, HANDS, ITEMS, SUPPORTS, Household

ENOUGH: Mapping[str, int] = {
    "plate": 120,
    "bread": 100,
    "apple": 45,
    "knife": 40,
    "table": 1500,
    "counter": 1500,
    "floor": 1500,
    "sink": 900,
    "fridge": 3000,
    "tv": 900,
    "screen": 600,
    "dirt": 100,
    "inside": 350,
    "hand": 60,
}
"""Pixels of a 224 × 224 picture from which a person knows the thing.

Of less dirt, the rim of a stain beside a loaf, a person looking at such pictures is not sure.
"""
CLEARLY: Mapping[str, int] = {"plate": 900, "bread": 700, "apple": 400, "knife": 220}
"""As many of a held thing in a good picture; less is still known."""
CONTEXT: Mapping[str, tuple[str, ...]] = {
    "table": ("floor", "room", "counter"),
    "counter": ("floor", "room"),
    "floor": ("room", "table", "counter", "fridge", "sink", "tv"),
}
"""What tells a level surface from others: what is seen beyond its edge."""
MAINLY = 0.2
"""Share of a good picture of a surface that the surface takes."""
SURROUNDINGS = 0.05
"""Share of a good picture that shows it."""
NOTHING = 3
"""Up to this many pixels nobody sees."""
REFERENCE = 224


@dataclass(frozen=True, slots=True)
class Shown:
    """Whether a fact is true, and whether a picture shows if it is."""

    true: bool
    visible: bool


def shown(
    household: Household, pixels: Mapping[str, int], *, size: int, first_person: bool = True
) -> dict[Atom, Shown]:
    """Judge every fact of the household by one picture.

    Args:
        household: The true state.
        pixels: How many pixels show each thing: items, fixtures, "screen", "dirt",
            "inside" (of the fridge) and the hands.
        size: Height of the picture that was counted.
        first_person: False for a camera that is not the robot's own.
    """
    scale = (size / REFERENCE) ** 2

    def seen(thing: str, least: str | None = None) -> bool:
        return pixels.get(thing, 0) >= ENOUGH[least or thing] * scale

    def absent(thing: str) -> bool:
        return pixels.get(thing, 0) <= NOTHING * scale

    found: dict[Atom, Shown] = {}
    for thing in (*ITEMS, *FIXTURES):
        near = household.near == thing
        visible = first_person and (seen(thing) if near else absent(thing))
        found[Atom("near", (thing,))] = Shown(near, visible)
    hand_seen = {hand: first_person and seen(hand, "hand") for hand in HANDS}
    for item in ITEMS:
        holder = household.hand_of.get(item)
        for hand in HANDS:
            # A person sees what the hands hold, and that they do not hold what lies elsewhere.
            visible = all(hand_seen.values()) if holder is None else seen(item)
            found[Atom("in_hand", (item, hand))] = Shown(holder == hand, visible)
    for hand in HANDS:
        held = household.held.get(hand)
        visible = hand_seen[hand] and (held is None or seen(held))
        found[Atom("free", (hand,))] = Shown(held is None, visible)
    for item in ITEMS:
        for place in SUPPORTS:
            if place != item:
                found[Atom("on", (item, place))] = _on(household, item, place, seen, first_person)
    fridge_seen = seen("fridge") and (not household.opened or seen("inside"))
    dirt_seen = seen("plate") and (household.clean or seen("dirt"))
    return found | {
        Atom("opened", ("fridge",)): Shown(household.opened, fridge_seen),
        Atom("turned_on", ("tv",)): Shown(household.turned_on, seen("screen")),
        Atom("clean", ("plate",)): Shown(household.clean, dirt_seen),
        Atom("halved", ("apple",)): Shown(household.halved, seen("apple")),
    }


def objections(household: Household, pixels: Mapping[str, int], *, size: int) -> float:
    """What a picture of a state lacks or shows too much: 0 is a good picture.

    Args:
        household: The true state.
        pixels: As for `shown`.
        size: Height of the picture that was counted.
    """
    scale = (size / REFERENCE) ** 2
    near, subject = household.near, household.subject
    wanted = {subject: 2.0, **dict.fromkeys(household.held.values(), 2.0)}
    support = household.support(subject) if subject in ITEMS else None
    if support == "fridge" and not household.opened:
        wanted = {**{x: w for x, w in wanted.items() if x != subject}, "fridge": 2.0}
    allowed = {near, subject, *household.held.values()}
    for item in household.held.values():
        allowed |= set(household.upon(item))
    if near != "fridge":
        allowed |= set(household.upon(near))
        wanted |= dict.fromkeys(household.upon(near), 1.0)
    place = household.where.get(subject) if support != "fridge" or household.opened else None
    while place in (*ITEMS, "sink", "fridge"):  # what shares so small a place is seen with it
        allowed |= {place, *household.upon(place)}
        place = household.where.get(place)
    if "plate" in wanted and not household.clean and not household.upon("plate"):
        wanted["dirt"] = 1.0
    lacking = sum(w for x, w in wanted.items() if pixels.get(x, 0) < ENOUGH[x] * scale)
    lacking += sum(0.5 for x in household.held.values() if pixels.get(x, 0) < CLEARLY[x] * scale)
    if "fridge" in wanted and household.opened:
        lacking += float(pixels.get("inside", 0) < 3 * ENOUGH["inside"] * scale)
    level = support or subject
    around = sum(pixels.get(x, 0) for x in CONTEXT.get(level, ()))
    if level in CONTEXT and around < SURROUNDINGS * size * size:
        lacking += 0.6
    if near in CONTEXT and pixels.get(near, 0) < MAINLY * size * size:
        lacking += 1.0
    surplus = sum(
        1.0
        for x in (*ITEMS, "tv", "sink", "fridge")
        if x not in allowed and x != support and pixels.get(x, 0) > NOTHING * scale
    )
    return lacking + surplus


def _on(
    household: Household, item: str, place: str, seen: Callable[..., bool], first_person: bool
) -> Shown:
    true = household.where.get(item) == place
    if seen(item):
        return Shown(true, True)
    if true or not first_person:
        return Shown(true, False)
    if place in ITEMS:  # on a plate that is seen whole there is nothing
        return Shown(False, seen(place))
    # The robot looks at the whole of what lies on the surface before it.
    whole = household.subject == place == household.near and place != "fridge"
    whole = whole and all(seen(other) for other in household.upon(place)) and seen(place)
    return Shown(False, whole)
