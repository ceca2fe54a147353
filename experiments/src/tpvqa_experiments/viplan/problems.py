"""ViPlan's problems, read from the folder in which they lie as published."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from importlib import resources
from pathlib import Path

from tpvqa.bench.own_task import OwnTask
from tpvqa.errors import BenchError
from tpvqa.tasks import TaskFiles

FILES = Path(str(resources.files(__package__))) / "files"
SPLITS = ("simple", "medium", "hard")


class Environment(StrEnum):
    """Where ViPlan's robot works."""

    BLOCKSWORLD = "blocksworld"
    IGIBSON = "igibson"

    @property
    def problems(self) -> str:
        """Where the splits' folders lie beside the domain."""
        return "problems" if self is Environment.BLOCKSWORLD else "."


@dataclass(frozen=True, slots=True)
class Problem:
    """One problem.

    Attributes:
        environment: Where it is.
        split: How hard it is.
        task: Its files.
    """

    environment: Environment
    split: str
    task: OwnTask


def problems_in(
    folder: Path, environment: Environment, splits: Sequence[str] = SPLITS
) -> dict[str, Problem]:
    """The problems of an environment, by the names of their files, in order.

    Args:
        folder: Holds `blocksworld/domain.pddl` and `blocksworld/problems/SPLIT/*.pddl`, or
            `igibson/domain.pddl` and `igibson/SPLIT/*.pddl`.
        environment: Which of the two.
        splits: Of which splits.

    Raises:
        BenchError: There are none, or a file cannot be read.
    """
    found = {}
    for split in splits:
        inside = folder / environment / environment.problems / split
        paths = sorted(inside.glob("*.pddl"), key=_in_order)
        if not paths:
            raise BenchError(
                f"{inside} holds no problem: *.pddl. Name the folder of ViPlan's problems with "
                "--problems"
            )
        for path in paths:
            found[path.stem] = Problem(environment, split, _read(folder, environment, path))
    return found


def _read(folder: Path, environment: Environment, problem: Path) -> OwnTask:
    return OwnTask.read(
        TaskFiles(
            name=problem.stem,
            domain=(folder / environment / "domain.pddl").resolve(),
            problem=problem.resolve(),
            questions=FILES / f"{environment}-questions.yaml",
            world=FILES / "world.yaml",
        )
    )


def _in_order(path: Path) -> list[tuple[int, str]]:
    """By the numbers in a name."""
    return [(int(part or 0), part) for part in re.split(r"\D+", path.stem)] + [(0, path.stem)]
