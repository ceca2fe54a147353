"""Whatever a file holds, it is read, or refused in a sentence: never another exception."""

import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from itertools import islice
from pathlib import Path
from typing import Any

import pytest

from tests.mutants import mutant
from tests.pddl import fuzzing
from tpvqa.belief import Calibration
from tpvqa.belief.answers.trust import GRID
from tpvqa.belief.learning.experience import Experience
from tpvqa.config.layers import as_yaml, combined, file_layer
from tpvqa.config.model import TrialConfig
from tpvqa.errors import PDDLError, PlacedError, TpvqaError
from tpvqa.pddl import Task, load_task, task_from_text
from tpvqa.pddl.state_file import read_state
from tpvqa.questions import QuestionBook
from tpvqa.worlds.script_file import load_script
from tpvqa.worlds.world_file import load_world_file

ROOT = Path(__file__).parents[1]
TOYS = ROOT / "tests/fixtures/toys"
SEED = 13


@pytest.mark.slow
def test_mutants_of_pddl_are_read_or_refused() -> None:
    """In a process of their own, as the translator is never imported into this one."""
    done = subprocess.run(
        [sys.executable, "-m", "tests.pddl.fuzzing", str(SEED), "1000"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert (done.returncode, done.stdout) == (0, ""), done.stderr
    read, _, refused, _ = done.stderr.split()
    assert int(read) > 10
    assert int(refused) > 500


@pytest.mark.slow
def test_mutants_of_pddl_that_go_through_the_worker() -> None:
    for seed in range(SEED, SEED + 100):
        try:
            task = task_from_text(*fuzzing.texts(seed))
        except PDDLError as error:
            assert error.line is not None, seed  # noqa: PT017
        else:
            QuestionBook(task)
            task.ground_actions()


@pytest.fixture(scope="module")
def toys() -> Task:
    return load_task(TOYS / "domain.pddl", TOYS / "collect.pddl")


def _configured(path: Path) -> None:
    layer = file_layer(path)
    as_yaml(combined([layer]), [layer])


def _questions(path: Path, task: Task) -> None:
    book = QuestionBook.load(path, task)
    state = task.init
    for action in islice(task.ground_actions(), 5):
        book.preconditions(action, state)
        book.effects(action, state)
        book.possible(action)
        book.done(action)


def _kinds(task: Task) -> dict[str, tuple[str, Callable[[Path], Any]]]:
    """What is mutated, and how it is read."""
    config = TrialConfig(task="eat_apple", vlm="oracle:0.8", options={"depth": 3})
    experience = Experience(
        failure=(1, 3), disturbance=(2, 2), trust=(1.0,) * len(GRID), vlm="oracle"
    )
    atoms = [atom.pddl() for atom in sorted(task.init)]
    tasks = ROOT / "packages/tpvqa-household/src/tpvqa_household/tasks"
    return {
        "questions": (
            (TOYS / "questions.yaml").read_text(),
            lambda path: _questions(path, task),
        ),
        "household questions": (
            (tasks / "questions.yaml").read_text(),
            lambda path: _questions(path, load_kitchen()),
        ),
        "script": ((TOYS / "script.yaml").read_text(), lambda path: load_script(path, task)),
        "world": (
            (tasks / "world.yaml").read_text(),
            lambda path: load_world_file(path, load_kitchen()),
        ),
        "configuration": (as_yaml(config, []), _configured),
        "state": ("\n".join(atoms), lambda path: read_state(path, task)),
        "state in JSON": (str(atoms).replace("'", '"'), lambda path: read_state(path, task)),
        "calibration": (
            Calibration.default("oracle").model_dump_json(indent=1),
            Calibration.load,
        ),
        "experience": (experience.model_dump_json(indent=1), Experience.load),
    }


def load_kitchen() -> Task:
    """The household's task, read once."""
    if not _KITCHEN:
        _KITCHEN.append(load_task("eat_apple"))
    return _KITCHEN[0]


_KITCHEN: list[Task] = []


@pytest.mark.slow
def test_mutants_of_yaml_and_json_are_read_or_refused(toys: Task, tmp_path: Path) -> None:
    path, ended = tmp_path / "file", Counter[str]()
    kinds = _kinds(toys)
    for seed in range(SEED, SEED + 1000):
        kind = list(kinds)[seed % len(kinds)]
        text, read = kinds[kind]
        path.write_text(mutant(text, seed // len(kinds)), encoding="utf-8", errors="replace")
        try:
            read(path)
            ended["read"] += 1
        except TpvqaError as error:
            assert "\n" not in str(error), (kind, seed, str(error))  # noqa: PT017
            assert len(str(error)) < 2000, (kind, seed)  # noqa: PT017
            if isinstance(error, PlacedError):
                assert str(path) in str(error)  # noqa: PT017
            ended["refused"] += 1
        except Exception as error:  # noqa: BLE001
            pytest.fail(f"{kind}, seed {seed}: {type(error).__name__}: {error}")
    assert min(ended["read"], ended["refused"]) > 100
