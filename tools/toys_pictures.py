"""Labelled pictures of the toys' table, to teach a VLM: `python tools/toys_pictures.py FOLDER 400`.

A robot that does at random what its skills can do; a picture after every action, labelled by
contacts and poses. Every episode is a table of its own, and a group. Pictures for a test come from
other episodes: give the number of the first as a third argument.
"""

import json
import sys
from hashlib import sha256
from pathlib import Path

from tpvqa import load_task
from tpvqa.chance import chance
from tpvqa.tasks import find_task
from tpvqa_robots.mishaps import Mishaps
from tpvqa_robots.world import ToysWorld

LONG = 12
"""Actions in an episode."""
OFTEN_FEASIBLE = 0.8
"""Probability that an action is drawn of those whose preconditions hold, not of all."""


def main(folder: Path, count: int, first: int) -> None:
    """Write so many pictures and their manifest."""
    files = find_task("collect_toys")
    task = load_task(files.domain, files.problem)
    folder.mkdir(parents=True)
    actions, made, episode = task.ground_actions(), [], first
    seen = [atom.pddl() for atom in sorted(task.reachable_atoms) if atom.predicate != "hand_empty"]
    while len(made) < count:
        world = ToysWorld(task, mishaps=Mishaps(slip=0.15, bad=0.1), seed=77, episode=episode)
        drawn = chance(77, episode, "what is done")
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
                    "state": sorted(atom.pddl() for atom in true),
                    "seen": seen,
                    "group": f"episode {episode}",
                }
            )
        world.close()
        manifest = {"version": 1, "domain": task.domain_name, "pictures": made}
        (folder / "manifest.json").write_text(json.dumps(manifest, indent=1))
        print(f"{len(made)} pictures", flush=True)
        episode += 1


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 0)
