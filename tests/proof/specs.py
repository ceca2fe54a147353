"""Sixty trials that together meet every task, monitor, world and VLM, and every way to end.

Whatever has a default that could change is written out, so that a trial stays the same trial.
"""

import shlex
from dataclasses import dataclass
from pathlib import Path

GIVEN = Path(__file__).parent / "given"
"""Files that trials name. Each trial runs in a copy of this folder, as some write into it."""
TOYS = Path(__file__).parents[1] / "fixtures" / "toys"

DISHES, BREAKFAST, APPLE, TOWER = "clean_dishes", "serve_breakfast", "eat_apple", "build_tower"
COLLECT = f"'{TOYS}/domain.pddl' '{TOYS}/collect.pddl'"
WORDED = f"{COLLECT} --questions '{TOYS}/questions.yaml'"
STUCK = f"'{TOYS}/domain.pddl' unreachable.pddl --questions '{TOYS}/questions.yaml'"
CALIBRATED = "--calibration calibration.json"
EXPERIENCED = "--experience experience.json"
FAULTY = "--failure 0.5 --disturbance 0.9"

DEFAULTS = {
    "--episode": 0,
    "--failure": 0.25,
    "--disturbance": 0.25,
    "--spontaneous": 0.0,
    "--max-actions": 60,
    "--max-repeats": 10,
    "--max-replans": 10,
}


@dataclass(frozen=True, slots=True)
class Spec:
    """One trial.

    Attributes:
        name: What it is called in the record.
        arguments: Of `tpvqa run`, without `--out`.
    """

    name: str
    arguments: tuple[str, ...]

    @property
    def rendered(self) -> bool:
        """Whether its pictures are drawn as it runs."""
        return "kitchen" in self.arguments

    @property
    def monitor(self) -> str:
        """The specification of its monitor."""
        return self.arguments[self.arguments.index("--monitor") + 1]


def _trial(name: str, task: str, world: str, vlm: str, monitor: str, seed: int, more: str) -> Spec:
    given = shlex.split(more)
    rest = [
        word
        for option, value in DEFAULTS.items()
        if option not in given
        for word in (option, str(value))
    ]
    chosen = ["--world", world, "--vlm", vlm, "--monitor", monitor, "--seed", str(seed)]
    return Spec(name, (*shlex.split(task), *chosen, *given, *rest))


# fmt: off
_TRIALS = (
    # Pictures, the embedded network.
    ("dishes-belief", DISHES, "images", "embedded", "belief", 1, "--failure 0.6 --disturbance 0.8"),
    ("dishes-tpvqa", DISHES, "images", "embedded", "tpvqa", 6, ""),
    ("dishes-tpvqa-3", DISHES, "images", "embedded", "tpvqa:3", 2, ""),
    ("dishes-success", DISHES, "images", "embedded", "successvqa", 6, ""),
    ("dishes-survey", DISHES, "images", "embedded", "survey:3", 1, ""),
    ("breakfast-belief", BREAKFAST, "images", "embedded", "belief", 1, ""),
    ("breakfast-costs", BREAKFAST, "images", "embedded", "belief:question=0.05", 1, ""),
    ("breakfast-tpvqa", BREAKFAST, "images", "embedded", "tpvqa", 3, ""),
    ("breakfast-effects", BREAKFAST, "images", "embedded", "effectvqa", 3, ""),
    ("breakfast-none", BREAKFAST, "images", "embedded", "none", 1, "--failure 0.3"),
    ("breakfast-noise", BREAKFAST, "images", "oracle:0.8", "effectvqa", 4, ""),
    ("apple-belief", APPLE, "images", "embedded", "belief", 1, ""),
    ("apple-person", APPLE, "images", "embedded", "belief:person=0.05:look=0.05:question=0.05", 1,
     ""),
    ("apple-tpvqa", APPLE, "images", "embedded", "tpvqa", 3, ""),
    ("apple-palme", APPLE, "images", "embedded", "palmevqa", 1, ""),
    ("apple-palme-hidden", APPLE, "images", "embedded", "palmevqa", 5, ""),
    ("apple-late", APPLE, "images", "embedded", "tp", 1, "--action-deadline 1e-9"),
    # Other pictures, the other simulator.
    ("apple-known", APPLE, "images:known", "embedded", "tpvqa:strict", 8, ""),
    ("apple-held-out-strict", APPLE, "images:held_out", "embedded", "tpvqa", 5,
     "--majority strict"),
    ("breakfast-held-out", BREAKFAST, "images:held_out", "embedded", "tpvqa", 1, ""),
    ("breakfast-held-out-belief", BREAKFAST, "images:held_out", "embedded", "belief:look=0.1", 5,
     ""),
    ("breakfast-held-out-person", BREAKFAST, "images:held_out", "embedded", "belief:person=0.1", 1,
     ""),
    ("breakfast-held-out-paper", BREAKFAST, "images:held_out:paper", "embedded",
     "palmevqa:start-over", 3, ""),
    ("breakfast-paper", BREAKFAST, "images:paper", "embedded", "belief", 3, ""),
    ("apple-paper", APPLE, "images:paper", "embedded", "tpvqa", 2, FAULTY),
    ("breakfast-simulator", BREAKFAST, "images", "embedded", "belief", 1,
     f"--simulator paper {FAULTY}"),
    # The live kitchen.
    ("dishes-kitchen", DISHES, "kitchen", "embedded", "tpvqa", 5, ""),
    ("apple-kitchen", APPLE, "kitchen", "embedded", "belief", 2, ""),
    ("breakfast-kitchen", BREAKFAST, "kitchen", "oracle:0.8", "effectvqa", 3, ""),
    # Without pictures: noise models.
    ("dishes-certain", DISHES, "symbolic", "oracle", "belief", 2, ""),
    ("dishes-paper-table", DISHES, "symbolic", "paper-table", "palmevqa", 2, ""),
    ("dishes-recorded", DISHES, "symbolic", "recorded:gpt-4.1-nano:fresh", "belief", 3, ""),
    ("breakfast-paper-table", BREAKFAST, "symbolic", "paper-table", "successvqa", 2, ""),
    ("breakfast-spontaneous", BREAKFAST, "symbolic", "oracle", "tpvqa", 2, "--spontaneous 0.5"),
    ("apple-recorded", APPLE, "symbolic", "recorded:internvl3-8b:1:fresh", "tpvqa", 1, ""),
    ("apple-repeating", APPLE, "symbolic", "oracle:0.7:0.5", "tpvqa:3", 3, ""),
    ("apple-strict", APPLE, "symbolic", "oracle:0.8", "tpvqa", 1, "--majority strict"),
    ("tower-belief", TOWER, "symbolic", "oracle:0.8", "belief", 1, ""),
    ("tower-recorded", TOWER, "symbolic", "recorded:qwen2.5-vl-72b:fresh", "belief", 2, ""),
    ("tower-tpvqa", TOWER, "symbolic", "oracle:0.8", "tpvqa", 2, "--episode 7"),
    ("tower-palme", TOWER, "symbolic", "oracle:0.8", "palmevqa", 2, ""),
    ("tower-blind", TOWER, "symbolic", "oracle", "tp", 1, ""),
    # The belief monitor: without parts, calibrated, experienced.
    ("breakfast-relevance", BREAKFAST, "symbolic", "oracle:0.8", "belief:without=relevance", 1, ""),
    ("apple-model", APPLE, "symbolic", "oracle:0.9", "belief:without=model", 1, ""),
    ("apple-rates", APPLE, "symbolic", "oracle:0.95",
     "belief:failure_rate=0.1:question=0.1", 1, "--failure 0.4"),
    ("apple-dear", APPLE, "symbolic", "oracle:0.7", "belief:question=3", 2, CALIBRATED),
    ("breakfast-experience", BREAKFAST, "symbolic", "oracle:0.7", "belief", 2,
     f"{CALIBRATED} {EXPERIENCED}"),
    ("breakfast-undone", BREAKFAST, "symbolic", "oracle:0.9", "belief", 2,
     "--experience new.json --spontaneous 0.3"),
    # Limits.
    ("dishes-repeats", DISHES, "symbolic", "oracle:0.9", "tpvqa", 1, "--failure 1"),
    ("apple-actions", APPLE, "symbolic", "oracle:0.9", "tpvqa", 1, "--max-actions 5"),
    ("apple-too-few", APPLE, "symbolic", "oracle:0.9", "belief", 1, "--max-actions 6"),
    ("apple-cornered", APPLE, "symbolic", "oracle:0.9", "belief", 1,
     "--failure 0.6 --max-repeats 1 --max-replans 1"),
    ("apple-replans", APPLE, "symbolic", "oracle:0.6", "tpvqa", 2, "--max-replans 2"),
    # Told by a script; a domain of one's own.
    ("breakfast-script", BREAKFAST, "scripted:drops.yaml", "oracle", "belief", 1, ""),
    ("toys-script", WORDED, f"scripted:{TOYS}/script.yaml", "oracle", "tpvqa", 1, ""),
    ("toys-lost", WORDED, "scripted:lost.yaml", "oracle", "tpvqa", 1, ""),
    ("toys-lost-belief", WORDED, "scripted:lost.yaml", "oracle", "belief:question=0.1", 1,
     "--max-actions 12"),
    ("toys-belief", WORDED, "symbolic", "oracle:0.9", "belief:question=0.1", 2,
     "--world-file toys-world.yaml --max-actions 20"),
    ("toys-unworded", COLLECT, "symbolic", "oracle:0.8", "tpvqa:strict", 1,
     "--world-file toys-world.yaml"),
    ("toys-stuck", STUCK, "symbolic", "oracle", "belief", 1, ""),
)
# fmt: on

SPECS = tuple(_trial(*each) for each in _TRIALS)
