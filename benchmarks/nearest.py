"""How long the nearest consistent state of many facts takes: `python benchmarks/nearest.py`.

Every object is in one of six places. One of them turns out to be at another one, and whatever that
contradicts has to move.

- roomy: a table and a floor where any number of things may be, two hands for all of them, and two
  slots for one thing each, shared with neighbours.
- full: six slots for one thing each, drawn from 1.05 slots an object. Nothing but slots.
- tied: the same, and one pair of facts in twenty facts that cannot both hold, drawn at random.
"""

import statistics
import time
from random import Random

from tpvqa.belief.states.constraints import Constraints
from tpvqa.belief.states.nearest import Facts, Nearest
from tpvqa.pddl import Atom, State

RUNS = 100


def at(number: int, place: str) -> Atom:
    """That an object is at a place."""
    return Atom("at", (f"o{number}", place))


def places_of(number: int, objects: int, random: Random, *, full: bool) -> list[str]:
    """The six places where an object can be; one of the slots is its own."""
    if full:
        drawn = [f"slot{slot}" for slot in random.sample(range(int(objects * 1.05)), 6)]
        return drawn if f"slot{number}" in drawn else [f"slot{number}", *drawn[1:]]
    return ["left", "right", f"slot{number}", f"slot{(number + 1) % objects}", "table", "floor"]


def problem(objects: int, *, kind: str, seed: int) -> tuple[Constraints, State, list[Facts]]:
    """Constraints, a state that keeps them, and for each run what turns out to be otherwise."""
    random, full = Random(seed), kind != "roomy"
    choices = [places_of(n, objects, random, full=full) for n in range(objects)]
    by_place: dict[str, set[Atom]] = {}
    for number, places in enumerate(choices):
        for place in places:
            by_place.setdefault(place, set()).add(at(number, place))
    state = set[Atom]()
    for number, places in enumerate(choices):
        free = [p for p in places if p in ("table", "floor") or state.isdisjoint(by_place[p])]
        state.add(at(number, f"slot{number}" if full else random.choice(free)))
    pairs = set[frozenset[Atom]]()
    if kind == "tied":
        loose = sorted(frozenset[Atom]().union(*by_place.values()) - state)
        pairs = {frozenset(random.sample(loose, 2)) for _ in range(len(loose) // 20)}
    constraints = Constraints(
        tuple(frozenset(at(n, place) for place in places) for n, places in enumerate(choices)),
        tuple(frozenset(by_place[p]) for p in sorted(by_place) if p not in ("table", "floor")),
        frozenset(pairs),
    )
    wishes = list[Facts]()
    while len(wishes) < RUNS:
        number = random.randrange(objects)
        (here,) = (place for place in choices[number] if at(number, place) in state)
        there = random.choice([place for place in choices[number] if place != here])
        wishes.append({at(number, here): False, at(number, there): True})
    return constraints, frozenset(state), wishes


def seconds(facts: int, kind: str) -> list[float]:
    """What each run took."""
    constraints, state, wishes = problem(facts // 6, kind=kind, seed=1)
    assert not constraints.violated(state)  # lists the groups of the constraints once
    found = []
    for wish in wishes:
        began = time.perf_counter()
        after = Nearest(constraints, state).where(wish)
        found.append(time.perf_counter() - began)
        assert not constraints.violated(after)
    return found


def main() -> None:
    """Print medians, 95% quantiles and the worst."""
    print(f"{RUNS} runs each, in ms     median     95 %    worst")
    for kind in ("roomy", "full", "tied"):
        for facts in (500, 12_000):
            taken = sorted(1000 * each for each in seconds(facts, kind))
            late = taken[int(0.95 * (len(taken) - 1))]
            print(
                f"{facts:6,} facts, {kind:6} {statistics.median(taken):11.2f} {late:8.2f} "
                f"{taken[-1]:8.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
