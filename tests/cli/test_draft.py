"""`tpvqa questions --draft`: it writes, and never over somebody's work."""

import json
import os
import shutil
from pathlib import Path

import pytest

from tests.cli.conftest import Run
from tests.labelling.robot import WARD
from tpvqa.drafting.actions import Actions
from tpvqa.drafting.clauses import Phrases
from tpvqa.drafting.things import Things
from tpvqa.pddl import load_task

ROOT = Path(__file__).parents[2]
DRAFT = ("questions", "--draft", "domain.pddl", "problem.pddl")


@pytest.fixture
def ward(tpvqa: Run) -> Path:
    """A domain without questions, where the commands are run."""
    for name in ("domain.pddl", "problem.pddl"):
        shutil.copy(WARD / name, name)
    return Path.cwd()


def test_it_is_written_beside_the_problem_and_then_used(ward: Path, tpvqa: Run) -> None:
    code, out, err = tpvqa(*DRAFT)
    assert code == 0, err
    assert "questions.yaml is written: 5 questions to read." in out
    code, out, err = tpvqa("questions", "domain.pddl", "problem.pddl")
    assert code == 0
    assert "No question is given" not in err
    assert "Is the robot in room 1? yes" in out


def test_a_domain_of_any_name_gets_a_file_that_can_be_read(ward: Path, tpvqa: Run) -> None:
    for file in ward.glob("*.pddl"):
        said = file.read_text().replace("(domain ward)", "(domain w\x1b[31m)")
        file.write_text(said.replace("(:domain ward)", "(:domain w\x1b[31m)"))
    assert "\x1b" in (ward / "problem.pddl").read_text()
    assert tpvqa(*DRAFT)[0] == 0
    code, _, err = tpvqa("questions", "domain.pddl", "problem.pddl")
    assert code == 0, err


def test_a_file_that_is_there_is_left_alone_without_force(ward: Path, tpvqa: Run) -> None:
    mine = Path("questions.yaml")
    mine.write_text("# mine\n")
    code, _, err = tpvqa(*DRAFT)
    assert code == 2
    assert "--force" in err
    assert mine.read_text() == "# mine\n"
    assert tpvqa(*DRAFT, "--force")[0] == 0
    assert "predicates:" in mine.read_text()
    code, out, _ = tpvqa(*DRAFT, "--questions", "other.yaml", "--json")
    assert code == 0
    assert json.loads(out) == {"written": "other.yaml", "to_look_at": 0, "notices": []}


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_nothing_is_left_where_it_cannot_be_written(ward: Path, tpvqa: Run) -> None:
    Path("closed").mkdir(mode=0o500)
    assert tpvqa(*DRAFT, "--questions", "closed/questions.yaml")[0] == 6
    assert not list(Path("closed").iterdir())


def test_a_folder_that_is_not_there_is_told(ward: Path, tpvqa: Run) -> None:
    code, _, err = tpvqa(*DRAFT, "--questions", "nowhere/questions.yaml")
    assert code == 6
    assert "nowhere" in err


def test_a_shipped_task_has_its_questions(tpvqa: Run) -> None:
    code, _, err = tpvqa("questions", "--draft", "eat_apple")
    assert code == 2
    assert "--questions" in err
    assert not list(Path.cwd().glob("*.yaml"))


SAID = {
    "hospital": {
        "go": "go from {from.the} to {to.the}",
        "throw_away": "throw away the {i} into the {b}",
        "clean_gripper": "clean the gripper in {r.the}",
        "take": "take the {m} from the {c}",
    },
    "store": {
        "load": "load the {g} into the {s}",
        "open_door": "open the door of the {c}",
        "weigh": "weigh the {g}",
    },
    "workshop": {
        "cover": "cover the {h} with the {l}",
        "set_screw": "set {w.the} in the {l}",
        "insert": "insert the {s} into the {h}",
        "put_down": "put down {p.the} on the {tray}",
    },
}


@pytest.mark.parametrize("example", SAID)
def test_actions_are_said_by_what_they_do(example: str) -> None:
    folder = ROOT / "examples" / example
    task = load_task(folder / "domain.pddl", folder / "problem.pddl")
    actions = Actions(Phrases(Things(task)))
    said = {schema.name: actions.said(schema).say for schema in task.schemas}
    for name, wanted in SAID[example].items():
        assert said[name] == wanted


@pytest.mark.parametrize("name", ["problem.pddl", "./domain.pddl", "linked.pddl"])
def test_no_draft_takes_the_place_of_what_it_is_made_from(
    ward: Path, tpvqa: Run, name: str
) -> None:
    Path("linked.pddl").symlink_to("problem.pddl")
    before = {file: file.read_bytes() for file in ward.iterdir()}
    code, _, err = tpvqa(*DRAFT, "--questions", name, "--force")
    assert (code, f"{Path(name)} is read by this command" in err) == (2, True)
    assert {file: file.read_bytes() for file in ward.iterdir()} == before
