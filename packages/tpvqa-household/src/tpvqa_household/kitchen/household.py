"""The state of the household, read from its atoms."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from tpvqa.errors import WorldError
from tpvqa.pddl import Atom, State

ITEMS = ("plate", "bread", "apple", "knife")
"""Small things that can be carried."""
FIXTURES = ("table", "counter", "floor", "sink", "fridge", "tv")
"""Things that stay where they are."""
SUPPORTS = ("table", "counter", "floor", "sink", "fridge", "plate")
"""What an item can lie on or in."""
HANDS = ("left", "right")
HOMES: Mapping[str, str] = {
    "plate": "table",
    "bread": "counter",
    "apple": "fridge",
    "knife": "counter",
}
"""Where each item usually lies: the robot looks there when it looks for a thing it holds."""


@dataclass(frozen=True, slots=True)
class Household:
    """What the facts say, by thing.

    Attributes:
        near: What the robot stands before.
        held: The item in each hand that holds one.
        where: What each item that is not held lies on or in.
    """

    near: str
    held: Mapping[str, str] = field(default_factory=dict)
    where: Mapping[str, str] = field(default_factory=dict)
    opened: bool = False
    turned_on: bool = False
    clean: bool = False
    halved: bool = False

    @property
    def hand_of(self) -> Mapping[str, str]:
        """The hand that holds an item, by item."""
        return {item: hand for hand, item in self.held.items()}

    def support(self, item: str) -> str | None:
        """The fixture under an item, through whatever it lies on; None where a hand carries it."""
        place = self.where.get(item)
        while place in ITEMS:
            place = self.where.get(place)
        return place

    def upon(self, thing: str) -> tuple[str, ...]:
        """The items that lie on or in a thing, directly or through another item."""
        direct = [item for item in ITEMS if self.where.get(item) == thing]
        return tuple(x for item in direct for x in (item, *self.upon(item)))

    @property
    def subject(self) -> str:
        """The fixture or item that the robot looks at: the near thing, or its home while held."""
        return HOMES[self.near] if self.near in self.hand_of else self.near

    @classmethod
    def read(cls, state: State) -> "Household":
        """Read a state of the household domain.

        Raises:
            WorldError: The facts contradict each other, or one has no place in a kitchen.
        """
        near: list[str] = []
        held: dict[str, str] = {}
        where: dict[str, str] = {}
        flags = {"opened": False, "turned_on": False, "clean": False, "halved": False}
        for atom in sorted(state):
            match atom.predicate, atom.arguments:
                case "near", (thing,) if thing in ITEMS or thing in FIXTURES:
                    near.append(thing)
                case "in_hand", (item, hand) if item in ITEMS and hand in HANDS:
                    if hand in held:
                        raise WorldError(f"{hand} holds both {held[hand]} and {item}.")
                    held[hand] = item
                case "free", (hand,) if hand in HANDS:
                    pass
                case "on", (item, place) if item in ITEMS and place in SUPPORTS and item != place:
                    if item in where:
                        raise WorldError(f"{item} lies on both {where[item]} and {place}.")
                    where[item] = place
                case (("opened", ("fridge",)) | ("turned_on", ("tv",))) as fact:
                    flags[fact[0]] = True
                case (("clean", ("plate",)) | ("halved", ("apple",))) as fact:
                    flags[fact[0]] = True
                case _:
                    raise WorldError(
                        f"The kitchen cannot show {atom}. It has the objects {', '.join(ITEMS)}, "
                        f"{', '.join(FIXTURES)} and the hands {' and '.join(HANDS)}. Run other "
                        "domains with --world symbolic, or with a world of your own."
                    )
        if len(near) != 1:
            raise WorldError(
                f"The robot is near {len(near)} things ({near}); it must be exactly one."
            )
        lost = [x for x in ITEMS if (x in where) == (x in held.values())]
        if lost:
            raise WorldError(f"{', '.join(lost)}: each must be in one hand or on one thing.")
        return cls(near=near[0], held=held, where=where, **flags)

    def state(self) -> State:
        """The facts again."""
        atoms = {Atom("near", (self.near,))}
        atoms |= {Atom("in_hand", (item, hand)) for hand, item in self.held.items()}
        atoms |= {Atom("free", (hand,)) for hand in HANDS if hand not in self.held}
        atoms |= {Atom("on", (item, place)) for item, place in self.where.items()}
        if self.opened:
            atoms.add(Atom("opened", ("fridge",)))
        if self.turned_on:
            atoms.add(Atom("turned_on", ("tv",)))
        if self.clean:
            atoms.add(Atom("clean", ("plate",)))
        if self.halved:
            atoms.add(Atom("halved", ("apple",)))
        return frozenset(atoms)


def atoms_of_interest() -> tuple[Atom, ...]:
    """Every atom of the household that a question can be about."""
    atoms = [Atom("near", (x,)) for x in (*ITEMS, *FIXTURES)]
    atoms += [Atom("in_hand", (x, h)) for x in ITEMS for h in HANDS]
    atoms += [Atom("free", (h,)) for h in HANDS]
    atoms += [Atom("on", (x, p)) for x in ITEMS for p in SUPPORTS if x != p]
    return (
        *atoms,
        Atom("opened", ("fridge",)),
        Atom("turned_on", ("tv",)),
        Atom("clean", ("plate",)),
        Atom("halved", ("apple",)),
    )
