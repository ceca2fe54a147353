"""A small set of plain-coloured pictures for every visible state of a task."""

import json
from collections.abc import Callable, Iterator
from io import BytesIO
from pathlib import Path

import pytest
from PIL import Image

from tpvqa.pddl import Task, load_task
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.tasks import find_task
from tpvqa.worlds.pictures import MANIFEST, digest
from tpvqa.worlds.simulation import Simulation
from tpvqa.worlds.world_file import WorldRules, load_world_file
from tpvqa_household.images.manifest import Manifest, Picture
from tpvqa_household.images.reachable import Reachable, reachable
from tpvqa_household.images.recipe import FACTS, jobs
from tpvqa_household.images.shipped_tasks import all_reachable
from tpvqa_household.images.verify import settled


def task_and_rules(name: str) -> tuple[Task, WorldRules]:
    files = find_task(name)
    task = load_task(files.domain, files.problem)
    return task, load_world_file(files.world, task)


@pytest.fixture(scope="session")
def shipped_reachable() -> list[Reachable]:
    return list(all_reachable())


@pytest.fixture(scope="session")
def planner() -> Iterator[FastDownward]:
    made = FastDownward()
    yield made
    made.close()


@pytest.fixture(scope="session")
def clean_dishes(planner: FastDownward) -> Reachable:
    task, rules = task_and_rules("clean_dishes")
    return reachable(task, rules, planner, "clean_dishes")


@pytest.fixture
def simulate() -> Callable[..., Simulation]:
    def make(task_name: str = "clean_dishes", **options: float) -> Simulation:
        task, rules = task_and_rules(task_name)
        return Simulation(task, rules, **options)  # type: ignore[arg-type]

    return make


@pytest.fixture
def painted(clean_dishes: Reachable, tmp_path: Path) -> Path:
    """A whole set for clean_dishes; its pictures are plain colours, no two alike."""
    pictures = []
    for number, job in enumerate(jobs([clean_dishes])):
        state = job.states[0]
        buffer = BytesIO()
        Image.new("RGB", (8, 8), (number, 40, 90)).save(buffer, "PNG")
        data = buffer.getvalue()
        name = f"{number}.jpg"
        (tmp_path / name).write_bytes(data)
        pictures.append(
            Picture(
                file=name,
                sha256=digest(data),
                width=8,
                height=8,
                renderer="mujoco",
                meshes=job.meshes,
                seed=job.seed,
                visible=job.key[0],
                number=job.number,
                state=tuple(atom.pddl() for atom in sorted(state)),
                seen=frozenset(atom.pddl() for atom in settled(job.states, FACTS)),
                shows=job.shows,
            )
        )
    manifest = Manifest(facts=tuple(a.pddl() for a in FACTS), pictures=tuple(pictures))
    (tmp_path / MANIFEST).write_text(json.dumps(manifest.model_dump(mode="json")))
    return tmp_path
