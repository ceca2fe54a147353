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
_BROUGHT: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    HOUSEHOLD: {
        "task": ("clean_dishes", "collect_toys", "eat_apple", "serve_breakfast"),
        "VLM": ("embedded",),
        "trainer": ("embedded",),
        "world": ("images", "kitchen"),
        "command": ("dataset",),
    },
    ROBOTS: {
        "task": (
            *("collect_biplane", "collect_rubik", "collect_teddy", "collect_toys"),
            *("collect_train", "collect_wood", "open_door", "sort_groceries"),
        ),
        "world": ("bins", "door", "ros2", "toys"),
        "monitor": ("commanded",),
        "command": (
            *("bag", "build-interfaces", "film", "plansys2-performer"),
            *("ros2-run", "skill-server"),
        ),
    },
    EXPERIMENTS: {
        "VLM": ("paper-table", "recorded-scenes"),
        "command": tuple(
            f"bench {part}" for part in ("abroad", "belief", "paper", "scenes", "viplan")
        ),
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


def brought(distribution: str) -> Mapping[str, tuple[str, ...]]:
    """The names that a distribution of this repository brings, by kind."""
    return _BROUGHT[distribution]


def remedy(kind: str, name: str) -> str:
    """What to install for a task, a command or a plug-in that is missing, as a sentence.

    Empty where no distribution of this repository brings it; of two that do the first one.
    """
    bringing = (each for each, kinds in _BROUGHT.items() if name in kinds.get(kind, ()))
    distribution = next(bringing, None)
    if distribution is None:
        return ""
    return f"{name} comes with {distribution}. Install it: {how_to_install(distribution)}."
