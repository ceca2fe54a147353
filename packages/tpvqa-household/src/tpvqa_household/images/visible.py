"""What of a true state the robot's first-person camera shows.

Two true states with the same visible state may share their pictures. The camera looks at the one
thing that the robot is near, with what lies on it and what it lies on (at the place where it
usually lies, while the robot holds it), and the robot's grippers are in view with what they hold;
a picture does not say which of the hands holds it. What lies in a container is hidden until the
robot looks for it there, and what else lies beside the thing looked at stays out of the picture.
"""

from functools import lru_cache

from tpvqa.pddl import Atom, State
from tpvqa_household.kitchen.household import ITEMS, Household

VisibleState = frozenset[Atom]
"""The facts shown that hold, without hands. A fact about a thing in view that is not in it is
shown not to hold."""

HANDS = {"in_hand": 1}
"""Predicates that name a hand, with the position of that argument."""

CONTAINERS = frozenset({"fridge"})
"""Things that hide what lies in them while they are closed."""

OF_NO_CAMERA = frozenset({"free"})
"""Predicates that no picture shows."""


def without_hands(atom: Atom) -> Atom:
    """The atom as a picture shows it: `in_hand(plate, left)` becomes `in_hand(plate)`."""
    position = HANDS.get(atom.predicate)
    if position is None or len(atom.arguments) <= position:
        return atom
    kept = atom.arguments[:position] + atom.arguments[position + 1 :]
    return Atom(atom.predicate, kept)


def mirrored(atom: Atom) -> Atom:
    """The same fact of the other hand."""
    other = {"left": "right", "right": "left"}
    return Atom(atom.predicate, tuple(other.get(name, name) for name in atom.arguments))


@lru_cache(maxsize=4096)
def visible_state(state: State) -> VisibleState:
    """What the camera shows of a true state.

    Args:
        state: The atoms that hold, of the household domain.

    Raises:
        WorldError: It is not a state of the household.
    """
    household = Household.read(state)
    subject = household.subject
    in_view = {household.near, subject, *household.hand_of}
    below: str | None = subject
    while below in ITEMS:
        below = household.where.get(below)
        if below is not None:
            in_view.add(below)
    if subject == household.near and subject not in CONTAINERS:
        in_view.update(household.upon(subject))
    # Of a thing behind a closed door nothing shows but where the robot looks for it.
    hidden = {subject} if in_view & CONTAINERS and not household.opened else set()
    return frozenset(
        without_hands(atom)
        for atom in state
        if atom.predicate not in OF_NO_CAMERA
        and atom.arguments[0] in in_view
        and (atom.predicate in ("near", "on") or atom.arguments[0] not in hidden)
    )


def describe(visible: VisibleState) -> str:
    """A visible state in one line, always in the same order: `near(plate), on(plate, table)`."""
    return ", ".join(map(str, sorted(visible)))
