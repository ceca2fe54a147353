"""Draws a folder of labelled pictures: every state that a task can come to, some looks at each.

python -m tpvqa_benchtop.pictures DOMAIN PROBLEM WORLD FOLDER [--looks N] [--seed N]
"""

import argparse
from pathlib import Path

from tpvqa.chance import chance
from tpvqa.pddl import Atom, State, Task, load_task
from tpvqa.worlds.pictures import MANIFEST, Manifest, Picture, digest
from tpvqa.worlds.simulation import Simulation
from tpvqa.worlds.world_file import WorldRules, load_world_file
from tpvqa_benchtop.scenes import picture

HIDDEN = frozenset({"filled", "empty"})
"""Predicates that no picture shows: what is in the watering can."""


def states(task: Task, rules: WorldRules) -> list[State]:
    """Every state that actions and disturbances lead to, in an order that is always the same."""
    found, waiting = {task.init}, [task.init]
    simulation = Simulation(task, rules, failure=0, disturbance=0)
    while waiting:
        here = waiting.pop()
        after = {task.apply(here, a) for a in task.ground_actions() if task.applicable(here, a)}
        simulation.state = here
        for results in simulation.undoable().values():
            after |= {state for _, state in results}
        waiting += after - found
        found |= after
    return sorted(found, key=sorted)


def write(task: Task, rules: WorldRules, folder: Path, *, looks: int, seed: int) -> int:
    """Draw and label the pictures; returns how many."""
    folder.mkdir(parents=True, exist_ok=True)
    told = [atom.pddl() for atom in facts_of(task) if atom.predicate not in HIDDEN]
    entries, shown = [], set()
    for state in states(task, rules):
        visible = frozenset(atom for atom in state if atom.predicate not in HIDDEN)
        if visible in shown:
            continue  # it looks like another
        shown.add(visible)
        for look in range(looks):
            name = f"{len(shown):02}-{look}.jpg"
            data = picture(task.domain_name, state, chance(seed, 0, "labelled", len(shown), look))
            (folder / name).write_bytes(data)
            facts = tuple(atom.pddl() for atom in sorted(visible))
            entries.append(
                Picture(file=name, sha256=digest(data), state=facts, seen=frozenset(told))
            )
    manifest = Manifest[Picture](domain=task.domain_name, pictures=tuple(entries))
    (folder / MANIFEST).write_text(manifest.model_dump_json(indent=1), encoding="utf-8")
    return len(entries)


def facts_of(task: Task) -> list[Atom]:
    """The facts that a picture may be labelled with."""
    return sorted(task.reachable_atoms | {a for a in task.init if a.predicate in task.fluents})


def main() -> None:
    """Draw what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("domain", "problem", "world", "folder"):
        parser.add_argument(name, type=Path)
    parser.add_argument("--looks", type=int, default=4)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    task = load_task(given.domain, given.problem)
    rules = load_world_file(given.world, task)
    count = write(task, rules, given.folder, looks=given.looks, seed=given.seed)
    print(f"{count} pictures in {given.folder}")


if __name__ == "__main__":
    main()
