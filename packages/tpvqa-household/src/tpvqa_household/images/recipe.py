"""Which pictures a set consists of, and which kitchens they may come from."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from tpvqa.pddl import Atom, State
from tpvqa_household.images.manifest import Meshes, Shows
from tpvqa_household.images.reachable import Reachable
from tpvqa_household.images.verify import PER_OUTCOME, PER_STATE, observations, settled
from tpvqa_household.images.visible import VisibleState, describe, without_hands
from tpvqa_household.kitchen.household import atoms_of_interest

TEST_SEEDS = 1_000_000_000
"""Kitchens from this seed on are for the test pictures: training uses lower ones only."""

MOST = 10
"""Pictures of one visible state at most: as many as one outcome of an action needs."""

SHARING = 5
"""Pictures of different states that share a kitchen: making one takes as long as some pictures."""

FACTS = atoms_of_interest()


@dataclass(frozen=True, slots=True)
class Job:
    """A picture to be made.

    Attributes:
        visible: What it shows.
        number: Tells it from others that show the same, from 0.
        meshes: Which objects; every other picture of a state has held-out ones.
        seed: Its first kitchen; further tries take the following ones.
        turn: Which of the pictures of that kitchen it is: has colours and looks of its own.
        states: The true states that look like this.
        shows: The actions that it is an observation of.
    """

    visible: VisibleState
    number: int
    meshes: Meshes
    seed: int
    turn: int
    states: tuple[State, ...] = field(repr=False)
    shows: tuple[Shows, ...] = field(repr=False)

    @property
    def key(self) -> tuple[str, int]:
        """What it is called while the set is made."""
        return describe(self.visible), self.number


TRIES = 100
"""Kitchens kept for one picture."""


def jobs(tasks: Sequence[Reachable]) -> list[Job]:
    """All pictures of a set, in an order in which every beginning is spread evenly."""
    classes: dict[VisibleState, set[State]] = defaultdict(set)
    counts: dict[VisibleState, int] = defaultdict(lambda: PER_STATE)
    for task in tasks:
        for visible, states in task.classes().items():
            classes[visible].update(states)
        for kind in task.nominal:
            for outcome in (task.after_success(kind), task.after_failure(kind)):
                for visible in outcome:  # its states share the observations of an outcome
                    counts[visible] = max(counts[visible], -(-PER_OUTCOME // len(outcome)))
    made = []
    for place, visible in enumerate(sorted(classes, key=describe)):
        shows = observations(visible, tasks)
        made += [
            Job(
                visible=visible,
                number=number,
                meshes="known" if number % 2 == 0 else "held_out",
                seed=TEST_SEEDS + (place // SHARING * MOST + number) * TRIES,
                turn=place % SHARING,
                states=tuple(sorted(classes[visible], key=sorted)),
                shows=shows,
            )
            for number in range(counts[visible])
        ]
    return sorted(made, key=lambda job: (job.number, job.seed, job.turn))


def objection(
    job: Job, state: State, true: Mapping[Atom, bool], seen: Mapping[Atom, bool]
) -> str | None:
    """Why a view of a kitchen cannot serve a job; None where it can.

    It must show everything that tells its visible state from others, and nothing that differs
    between the true states that it stands for.

    Args:
        job: What is wanted.
        state: The true state that was arranged.
        true: Of every fact, whether it holds in the arranged kitchen.
        seen: Of every fact, whether the view shows if it holds.
    """
    for atom in FACTS:
        if true[atom] != (atom in state):
            return f"{atom} could not be arranged"
    sure = settled(job.states, FACTS)
    for atom in FACTS:
        if seen[atom] and atom not in sure:
            return f"{atom} is in view, which not all states behind the picture share"
    told = {without_hands(atom) for atom in FACTS if seen[atom]}
    hidden = [atom for atom in sorted(needed(job.visible)) if atom not in told]
    return f"{hidden[0]} cannot be seen" if hidden else None


def needed(visible: VisibleState) -> frozenset[Atom]:
    """The facts that every picture of a visible state must show, true or false."""
    near = next(atom.arguments[0] for atom in visible if atom.predicate == "near")
    inside = Atom("on", (near, "fridge"))
    opened = Atom("opened", ("fridge",))
    if inside in visible and opened not in visible:  # it lies behind the closed door
        return visible - {inside, Atom("near", (near,))} | {opened}
    wanted = set(visible)
    things = {name for atom in visible for name in atom.arguments} | {near}
    for thing, fact in (
        ("plate", Atom("clean", ("plate",))),
        ("apple", Atom("halved", ("apple",))),
        ("fridge", opened),
        ("tv", Atom("turned_on", ("tv",))),
    ):
        if thing in things:
            wanted.add(fact)
    return frozenset(wanted)
