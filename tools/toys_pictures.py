"""Labelled pictures of the toys' table, to teach a VLM: `python tools/toys_pictures.py FOLDER 400`.

A robot that does at random what its skills can do; a picture after every action, labelled by
contacts and poses. Every episode is a table of its own, and a group: one of `--toys` stands on it,
each in its turn, and with `--looks` its wood, its room and its light are drawn. Pictures for a test
come from other episodes: `--first`. Whichever toy it is, the labels call it `toy`, the questions
"toy to collect"; these and the problem with it lie beside the pictures. So what was taught with
some toys can be asked about others, and about any task's toy in a trial with these questions.
"""

import argparse
import json
from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path

import yaml

from tpvqa import Atom, Task, load_task
from tpvqa.chance import chance
from tpvqa.tasks import find_task
from tpvqa_robots import tasks
from tpvqa_robots.mishaps import Mishaps
from tpvqa_robots.world import ToysWorld

LONG = 12
"""Actions in an episode."""
OFTEN_FEASIBLE = 0.8
"""Probability that an action is drawn of those whose preconditions hold, not of all."""
SEED = 77
CALLED = "toy to collect"
TOYS = ("eggplant", "teddy", "rubik", "biplane", "train", "wood")
BRIGHT, TINT, LIGHT = 0.35, 0.12, 0.4
"""By how much a surface's brightness, each of its colours, and a light may differ; a share."""


def main(folder: Path, count: int, first: int, toys: Sequence[str], looks: bool) -> None:
    """Write so many pictures and their manifest."""
    of_toys = [_task(toy) for toy in toys]
    folder.mkdir(parents=True)
    _beside(folder, of_toys[0])
    made: list[dict[str, object]] = []
    episode = first
    while len(made) < count:
        task = of_toys[episode % len(of_toys)]
        made += _episode(folder, task, episode, looks=looks)
        manifest = {"version": 1, "domain": task.domain_name, "pictures": made}
        (folder / "manifest.json").write_text(json.dumps(manifest, indent=1))
        print(f"{len(made)} pictures", flush=True)
        episode += 1


def _task(toy: str) -> Task:
    files = find_task("collect_toys" if toy == "eggplant" else f"collect_{toy}")
    # of two packages with collect_toys the robot's has the words of the table
    domain = Path(tasks.__file__).with_name("domain.pddl")
    return load_task(domain, domain.with_name(files.problem.name))


def _episode(folder: Path, task: Task, episode: int, *, looks: bool) -> list[dict[str, object]]:
    actions, made = task.ground_actions(), []
    seen = [
        _called(atom) for atom in sorted(task.reachable_atoms) if atom.predicate != "hand_empty"
    ]
    world = ToysWorld(task, mishaps=Mishaps(slip=0.15, bad=0.1), seed=SEED, episode=episode)
    if looks:
        _another_look(world, episode)
    drawn = chance(SEED, episode, "what is done")
    for number in range(LONG):
        if number:
            able = [a for a in actions if world.truth.possible(a)]
            some = able if able and drawn.random() < OFTEN_FEASIBLE else actions
            skills = sorted({a.name for a in some})
            skill = drawn.choice(skills)
            world.execute(drawn.choice([a for a in some if a.name == skill]))
        data = next(iter(world.observe().frames.values())).data
        name = f"{episode:04}-{number:02}.jpg"
        (folder / name).write_bytes(data)
        true = [a for a in task.reachable_atoms | task.init if world.truth.holds(a)]
        made.append(
            {
                "file": name,
                "sha256": sha256(data).hexdigest(),
                "state": sorted(map(_called, true)),
                "seen": seen,
                "group": f"episode {episode}",
            }
        )
    world.close()
    return made


def _called(atom: Atom) -> str:
    """A fact as the labels have it: every toy is `toy`."""
    names = ("toy" if name.startswith("toy_") else name for name in atom.arguments)
    return Atom(atom.predicate, tuple(names)).pddl()


def _another_look(world: ToysWorld, episode: int) -> None:
    """Other wood, another room and other light: what tells things apart by colour stays."""
    model, drawn = world.robot.machine.model, chance(SEED, episode, "look")
    for name in ("wood", "tiles", "metal"):
        bright = drawn.uniform(1 - BRIGHT, 1 + BRIGHT)
        tint = [drawn.uniform(1 - TINT, 1 + TINT) for _ in range(3)]
        rgb = model.material(name).rgba[:3] * bright * tint
        model.material(name).rgba[:3] = rgb.clip(0, 1.5)
    for light in range(model.nlight):
        model.light_diffuse[light] *= drawn.uniform(1 - LIGHT, 1 + LIGHT)
    model.vis.headlight.ambient *= drawn.uniform(1 - LIGHT / 2, 1 + LIGHT / 2)


def _beside(folder: Path, task: Task) -> None:
    """The domain, a problem with one toy, and questions that call all toys the same."""
    own = Path(tasks.__file__).parent
    (folder / "problem.pddl").write_text(
        f"(define (problem toys)\n  (:domain {task.domain_name})\n"
        f"  (:objects blue_container cyan_container - container toy - toy)\n"
        "  (:init (found table) (hand_empty) (on blue_container table) (on cyan_container table)\n"
        "         (on toy table))\n  (:goal (hand_empty)))\n"
    )
    (folder / "domain.pddl").write_text((own / "domain.pddl").read_text())
    text = (own / "questions.yaml").read_text()
    questions = yaml.load(text, yaml.BaseLoader)  # where "on" is a word
    questions["objects"] = dict.fromkeys(("toy", *(f"toy_{toy}" for toy in TOYS)), CALLED)
    questions["never_asked"] += [
        {"fact": f"(found {place})", "because": "it is in every image"}
        for place in ("table", "goal_area")
    ]
    (folder / "questions.yaml").write_text(yaml.safe_dump(questions, sort_keys=False))


if __name__ == "__main__":
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("folder", type=Path)
    words.add_argument("count", type=int)
    words.add_argument("--first", type=int, default=0)
    words.add_argument("--toys", nargs="+", choices=TOYS, default=["eggplant"])
    words.add_argument("--looks", action="store_true")
    said = words.parse_args()
    main(said.folder, said.count, said.first, said.toys, said.looks)
