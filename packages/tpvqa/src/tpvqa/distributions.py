"""What other distributions bring: for a name that is missing here, a message says what to install.

Names only: nothing here is imported, and whatever is installed is found by its entry points.
"""

from collections.abc import Mapping

HOUSEHOLD = "tpvqa-household"
ROBOTS = "tpvqa-robots"
EXPERIMENTS = "tpvqa-experiments"

_FOLDERS: Mapping[str, str] = {
    "tpvqa": "packages/tpvqa",
    HOUSEHOLD: "packages/tpvqa-household",
    ROBOTS: "packages/tpvqa-robots",
    EXPERIMENTS: "experiments",
}
_BROUGHT: Mapping[str, Mapping[str, str]] = {
    "task": dict.fromkeys(
        ("clean_dishes", "collect_toys", "eat_apple", "serve_breakfast"), HOUSEHOLD
    ),
    "VLM": {"embedded": HOUSEHOLD, "paper-table": EXPERIMENTS, "recorded-scenes": EXPERIMENTS},
    "world": {"images": HOUSEHOLD, "kitchen": HOUSEHOLD, "toys": ROBOTS, "ros2": ROBOTS},
    "command": {
        "dataset": HOUSEHOLD,
        "film": ROBOTS,
        "skill-server": ROBOTS,
        "bench paper": EXPERIMENTS,
        "bench belief": EXPERIMENTS,
        "bench viplan": EXPERIMENTS,
    },
}


def how_to_install(distribution: str, extra: str = "") -> str:
    """The command that installs a distribution, or it with an extra.

    Those of this repository lie in no package index: they are installed from a clone.
    """
    folder = _FOLDERS.get(distribution)
    if folder is None:
        return f"pip install '{distribution}[{extra}]'" if extra else f"pip install {distribution}"
    target = f"'{folder}[{extra}]'" if extra else folder
    return f"in a clone of the repository, pip install -e {target}"


def remedy(kind: str, name: str) -> str:
    """What to install for a missing task, VLM, world or command, as a sentence.

    Empty where no distribution of this repository brings it.
    """
    distribution = _BROUGHT.get(kind, {}).get(name)
    if distribution is None:
        return ""
    return f"{name} comes with {distribution}. Install it: {how_to_install(distribution)}."
