"""How many trials are completed where physics decides: monitors and answers side by side.

.venv-robot/bin/python -m benchmarks.physics toys|far|bins|door FILE [TRIALS]  runs, writes rows
.venv/bin/python -m benchmarks.physics toys|far|bins|door FILE --table  prints what is in the file

python -m benchmarks.physics tables|strangers FILE TRIALS TAUGHT asks a network that was taught with
pictures of these toys on other tables, or of other toys: TAUGHT has its questions.yaml, the folder
network and calibration.json, see docs/robots.md. The household's package has to be installed, too.

Every cell meets the same tables, slips and bad grasps by its seeds; a seed is run in all cells
before the next. No limit but five times the actions of the plan.
"""

import gc
import json
import sys
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tpvqa.assembly import Trial
from tpvqa.bench.statistics import wilson
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.events import Event
from tpvqa.events.events import Acted, Acting, Asked, Ended
from tpvqa.tasks import tasks_in

TAUGHT = "embedded"
FOLDERS = ("tasks", "bins/task", "door/task")
"""Where the robots' package has its tasks."""
ANSWERS = ("oracle:0.95:0:0.74", "oracle:0.8:0:0.74")


@dataclass(frozen=True)
class Bench:
    """What is run.

    Attributes:
        tasks: The tasks, one after the other by the seed.
        world: The world, with how often something is made to go wrong.
        cells: Monitors and VLMs.
        actions: Actions in a trial, at most.
    """

    tasks: Sequence[str]
    world: str
    cells: Sequence[tuple[str, str]]
    actions: int


BENCHES = {
    "toys": Bench(
        ("collect_toys",),
        "toys:slip=0.25:bad=0.25",
        (
            *((monitor, "oracle") for monitor in ("none", "blind:2", "blind:3", "tpvqa")),
            *((monitor, vlm) for vlm in ANSWERS for monitor in ("tpvqa", "tpvqa:5", "belief")),
        ),
        45,
    ),
    "far": Bench(
        ("collect_toys",),
        "toys:far=1:slip=0.1:bad=0.1",
        (("tpvqa", "oracle"), *((monitor, ANSWERS[0]) for monitor in ("tpvqa", "belief"))),
        45,
    ),
    "tables": Bench(
        ("collect_toys",),
        "toys:slip=0.25:bad=0.25",
        (("tpvqa", TAUGHT), ("belief", TAUGHT)),
        45,
    ),
    "strangers": Bench(
        ("collect_rubik", "collect_biplane"),
        "toys:slip=0.25:bad=0.25",
        (("tpvqa", TAUGHT), ("belief", TAUGHT)),
        45,
    ),
    "bins": Bench(
        ("sort_groceries",),
        "bins:slip=0.1:bad=0.1",
        (
            *((monitor, "oracle") for monitor in ("none", "blind:2", "tpvqa")),
            *((monitor, ANSWERS[0]) for monitor in ("tpvqa", "belief")),
        ),
        40,
    ),
    "door": Bench(
        ("open_door",),
        "door:slip=0.25:bad=0.25",
        (
            *((monitor, "oracle") for monitor in ("none", "blind:2", "tpvqa")),
            *((monitor, vlm) for vlm in ANSWERS for monitor in ("tpvqa", "belief")),
        ),
        20,
    ),
}


def trial(bench: Bench, monitor: str, vlm: str, seed: int, taught: Path = Path()) -> dict[str, Any]:
    """One trial, as a row."""
    said: dict[str, dict[str, Any]] = {
        "task": _files(bench.tasks[seed % len(bench.tasks)]),
        "world": {"spec": bench.world},
        "monitor": {"spec": monitor},
        "vlm": {"spec": vlm},
        "limits": dict.fromkeys(("actions", "repeats", "replans"), bench.actions),
    }
    if vlm == TAUGHT:
        said["vlm"]["spec"] = f"{TAUGHT}:{taught / 'network'}"
        said["task"]["questions"] = str(taught / "questions.yaml")
        if monitor == "belief":
            said["monitor"]["calibration"] = str(taught / "calibration.json")
    config = TrialConfig.model_validate({"seed": seed, **said})
    writer = MemoryWriter()
    with Trial(config) as made:
        made.run(writer)
        believed = list(_believed(made.monitor))
    end = writer.events[-1]
    assert isinstance(end, Ended)
    acted = [event for event in writer.events if isinstance(event, Acted)]
    return {
        "monitor": monitor,
        "vlm": vlm,
        "seed": seed,
        "completed": end.completed,
        "believed_goal": end.believed_goal,
        "because": end.because,
        "actions": len(acted),
        "questions": sum(len(e.questions) for e in writer.events if isinstance(e, Asked)),
        "robot_seconds": sum(each.seconds for each in acted),
        "tried": [list(each) for each in _tried(writer.events)],
        "believed": believed,
    }


def _files(task: str) -> dict[str, str]:
    """A task of the robot's own package: the household may be installed, and brings one of the
    same name with questions of its own."""
    import tpvqa_robots  # the table is printed without it

    here = Path(tpvqa_robots.__file__).parent
    found = (each for folder in FOLDERS for each in tasks_in(here / folder))
    files = next(each for each in found if each.name == task)
    return {
        "domain": str(files.domain),
        "problem": str(files.problem),
        "questions": str(files.questions),
        "world_file": str(files.world),
    }


def _tried(events: list[Event]) -> Iterator[tuple[str, str]]:
    """Every action with what came of it, in truth."""
    action = ""
    for event in events:
        if isinstance(event, Acting):
            action = event.action.pddl()
        elif isinstance(event, Acted) and event.truth is not None:
            failure = event.truth.failure
            yield action, "done" if failure is None else f"{failure.value}: {event.message}"


def _believed(monitor: object) -> Iterator[tuple[str, float, float]]:
    """Of every skill how often it was tried and failed, as a belief monitor reckons."""
    chances = getattr(monitor, "chances", None)
    if chances is None:
        return
    skills = chances.likeliest.skills
    for action in skills.all():
        tried = skills.tried(action)
        yield action.pddl(), tried.times, tried.failed


def table(bench: Bench, rows: list[dict[str, Any]]) -> None:
    """Print completion by cell, and failure rates by skill and object."""
    for monitor, vlm in bench.cells:
        of = [row for row in rows if (row["monitor"], row["vlm"]) == (monitor, vlm)]
        if not of:
            continue
        rate = wilson(sum(row["completed"] for row in of), len(of))
        wrongly = sum(bool(row["believed_goal"]) and not row["completed"] for row in of)
        ends = Counter(row["because"] for row in of if not row["completed"])
        mean = {
            name: sum(row[name] for row in of) / len(of)
            for name in ("actions", "questions", "robot_seconds")
        }
        print(
            f"| `{monitor}` | {vlm} | {rate.rate:.2f} ({rate.low:.2f}–{rate.high:.2f}) of "
            f"{len(of)} | {wrongly} | {mean['actions']:.1f} | {mean['questions']:.0f} "
            f"| {mean['robot_seconds'] / 60:.1f} | {dict(ends)}"
        )
    truly: dict[str, Counter[str]] = defaultdict(Counter)
    for row in rows:
        for action, came in row["tried"]:
            truly[action]["tried"] += 1
            truly[action]["failed"] += came != "done"
            truly[action][came] += came != "done"
    for action, count in sorted(truly.items()):
        reasons = {k: n for k, n in count.items() if k not in ("tried", "failed") and n}
        print(f"{action}: failed {count['failed']} of {count['tried']}", reasons)
    print("as the belief monitor reckons, and in truth in the same trials:")
    reckoned: dict[str, list[float]] = defaultdict(lambda: [0.0, 0.0])
    for row in rows:
        if row["monitor"] != "belief":
            continue
        for skill, times, failed in row["believed"]:
            reckoned[skill][0] += times
            reckoned[skill][1] += failed
    for skill in sorted(reckoned):
        times, failed = reckoned[skill]
        # An action without the arguments that its skill does not take: its last ones here.
        same = [
            came
            for row in rows
            for action, came in row["tried"]
            if row["monitor"] == "belief" and f"{action[:-1]} ".startswith(f"{skill[:-1]} ")
        ]
        fails = sum(came != "done" for came in same)
        print(f"| `{skill}` | {failed:.1f} of {times:.1f} | {fails} of {len(same)} |")


def main(bench: Bench, file: Path, trials: int, taught: Path) -> None:
    """Run what is missing in a file."""
    rows = read(file)
    done = {(row["monitor"], row["vlm"], row["seed"]) for row in rows}
    with file.open("a") as out:
        for seed in range(1, trials + 1):
            for monitor, vlm in bench.cells:
                if (monitor, vlm, seed) not in done:
                    row = trial(bench, monitor, vlm, seed, taught)
                    gc.collect()  # Python does not see how much MuJoCo's models take
                    out.write(json.dumps(row) + "\n")
                    out.flush()
                    print(
                        seed,
                        monitor,
                        vlm,
                        row["completed"],
                        row["because"],
                        row["actions"],
                        flush=True,
                    )


def read(file: Path) -> list[dict[str, Any]]:
    """The whole rows of a file."""
    lines = file.read_text().splitlines() if file.exists() else []
    return [json.loads(line) for line in lines if line.endswith("}")]


if __name__ == "__main__":
    chosen, rows_file = BENCHES[sys.argv[1]], Path(sys.argv[2])
    if "--table" in sys.argv:
        table(chosen, read(rows_file))
    else:
        words = dict(enumerate(sys.argv))
        main(chosen, rows_file, int(words.get(3, 100)), Path(words.get(4, ".")))
