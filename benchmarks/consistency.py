"""How long the most probable consistent state of many facts takes.

python benchmarks/consistency.py

Every object is in one of six places, as noisy answers say: one to three looks a fact, each right
with 0.8.

- roomy: a table and a floor where any number of things may be, two hands for all of them, and two
  slots for one thing each, shared with neighbours. Everything hangs together by the hands.
- full: six slots for one thing each, drawn from 1.05 slots an object. Nothing but slots.
- tied: the same, and one pair of facts in twenty facts that cannot both hold, drawn at random.
"""

import statistics
import time
from collections.abc import Iterator
from math import log
from random import Random

from tpvqa.belief.choosing import Solver
from tpvqa.belief.consistency import Consistent, Constraints, most_probable
from tpvqa.errors import TpvqaError
from tpvqa.pddl import Atom

RUNS = 7
RIGHT = 0.8

Answers = dict[Atom, float]


def places_of(number: int, objects: int, random: Random, *, full: bool) -> list[str]:
    """The six places where an object can be; the first ones hold one thing each."""
    if full:
        return [f"slot{slot}" for slot in random.sample(range(int(objects * 1.05)), 6)]
    return ["left", "right", f"slot{number}", f"slot{(number + 1) % objects}", "table", "floor"]


def problem(objects: int, *, kind: str, seed: int) -> tuple[Constraints, list[Answers]]:
    """Constraints, and the answers of each run: log odds from one look, two, or three."""
    random, full = Random(seed), kind != "roomy"
    choices = [places_of(n, objects, random, full=full) for n in range(objects)]
    if full:  # so that a consistent truth exists: one slot each is the object's own
        for number, places in enumerate(choices):
            own = f"slot{number}"
            if own not in places:
                places[0] = own
    groups = [
        frozenset(Atom("at", (f"o{n}", place)) for place in places)
        for n, places in enumerate(choices)
    ]
    by_place: dict[str, set[Atom]] = {}
    for group in groups:
        for atom in group:
            by_place.setdefault(atom.arguments[1], set()).add(atom)
    shared = [
        frozenset(atoms)
        for place, atoms in sorted(by_place.items())
        if place not in ("table", "floor") and len(atoms) > 1
    ]
    pairs = set()
    if kind == "tied":
        true = {Atom("at", (f"o{n}", f"slot{n}")) for n in range(objects)}
        free = sorted(frozenset[Atom]().union(*groups) - true)
        pairs = {frozenset(random.sample(free, 2)) for _ in range(len(free) // 20)}
    constraints = Constraints(tuple(groups), tuple(shared), frozenset(pairs))
    return constraints, [dict(answers(choices, random, full=full)) for _ in range(RUNS)]


def answers(
    choices: list[list[str]], random: Random, *, full: bool
) -> Iterator[tuple[Atom, float]]:
    """Noisy log odds of every fact."""
    taken: set[str] = set()
    for number, places in enumerate(choices):
        here = [f"slot{number}"] if full else [place for place in places if place not in taken]
        true = random.choice(here)
        if true not in ("table", "floor"):
            taken.add(true)
        for place in places:
            looks = random.choice([1, 2, 3])
            right = sum(random.random() < RIGHT for _ in range(looks))
            value = (2 * right - looks) * log(RIGHT / (1 - RIGHT))
            yield Atom("at", (f"o{number}", place)), value if place == true else -value


def measured(constraints: Constraints, runs: list[Answers], solver: Solver) -> str:
    """Median and best wall time, median processor time, and what solved the runs."""
    wall, cpu, results = [], [], list[Consistent]()
    for log_odds in runs:
        began, worked = time.perf_counter(), time.process_time()
        try:
            results.append(most_probable(log_odds, constraints, solver=solver))
        except TpvqaError as error:
            return str(error)
        wall.append(1000 * (time.perf_counter() - began))
        cpu.append(1000 * (time.process_time() - worked))
    assert all(not constraints.violated(result.state) for result in results)
    used = ", ".join(sorted({result.solver for result in results}))
    unproven = sum(not result.proven for result in results)
    return (
        f"{statistics.median(wall):8.1f} {min(wall):8.1f} {statistics.median(cpu):8.1f}   {used}"
        + (f", out of time in {unproven} of {len(runs)}" if unproven else "")
    )


def main() -> None:
    """Print medians, one way of solving beside the other."""
    print(f"{RUNS} runs each, in ms                wall     best      cpu   solved by")
    solvers: tuple[Solver, ...] = ("auto", "direct", "cp_sat")
    for kind in ("roomy", "full", "tied"):
        for facts in (500, 12_000):
            constraints, runs = problem(facts // 6, kind=kind, seed=1)
            most_probable(runs[0], constraints)  # the arrays of the constraints are made once
            for solver in solvers:
                said = measured(constraints, runs, solver)
                print(f"{facts:6,} facts, {kind:5} {solver:7} {said}", flush=True)


if __name__ == "__main__":
    main()
