"""What the shipped tasks of the household can lead to."""

from functools import cache

from tpvqa.pddl import load_task
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.tasks import find_task
from tpvqa.worlds.world_file import load_world_file
from tpvqa_household.images.reachable import Reachable, reachable

TASKS = ("clean_dishes", "serve_breakfast", "eat_apple")
"""The paper's, which the pictures are made for."""


@cache
def all_reachable() -> tuple[Reachable, ...]:
    """Enumerate the visible states of all tasks; takes some seconds, the first time."""
    found = []
    planner = FastDownward()
    try:
        for name in TASKS:
            files = find_task(name)
            task = load_task(files.domain, files.problem)
            found.append(reachable(task, load_world_file(files.world, task), planner, name))
    finally:
        planner.close()
    return tuple(found)
