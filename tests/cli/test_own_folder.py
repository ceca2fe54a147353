"""A task of one's own that is named by the folder it lies in."""

import json
import shutil
from pathlib import Path

import pytest

from tests.cli.conftest import Run

HOSPITAL = Path(__file__).parents[2] / "examples" / "hospital"
PROGRAMS = HOSPITAL.parent / "programs"


@pytest.fixture
def ward(tmp_path: Path) -> Path:
    """A copy of the hospital in a folder with a space in its name."""
    return Path(shutil.copytree(HOSPITAL, tmp_path / "my ward"))


def test_a_folder_plans_as_its_files_do(tpvqa: Run, ward: Path) -> None:
    (ward / "older.pddl").mkdir()
    files = [str(ward / name) for name in ("domain.pddl", "problem.pddl")]
    code, by_folder, _ = tpvqa("plan", str(ward), "--json")
    again, by_files, _ = tpvqa("plan", *files, "--json")
    assert code == again == 0
    assert json.loads(by_folder)["plan"] == json.loads(by_files)["plan"]


def test_a_folder_runs_with_what_lies_beside(tpvqa: Run, ward: Path, tmp_path: Path) -> None:
    out = tmp_path / "episode"
    code, _, told = tpvqa(
        "run", str(ward), "--vlm", "oracle", "--monitor", "tpvqa", "--out", str(out)
    )
    assert code in (0, 1), told
    assert "questions.yaml is used" in " ".join(told.split())
    assert (out / "episode.jsonl").exists()


def test_a_folder_of_one_program_is_that(tpvqa: Run, tmp_path: Path) -> None:
    shutil.copy(PROGRAMS / "eat_apple.lp", tmp_path)
    code, _, told = tpvqa("plan", str(tmp_path))
    assert code == 0, told


@pytest.mark.parametrize(
    ("files", "says"),
    [
        ((), "holds no problem"),
        (("domain.pddl",), "holds no problem"),
        (("problem.pddl",), "holds no domain.pddl"),
        (("domain.pddl", "problem.pddl", "other.pddl"), "several problems (other.pddl, problem"),
    ],
)
def test_a_folder_that_holds_no_single_task_is_refused(
    tpvqa: Run, ward: Path, tmp_path: Path, files: tuple[str, ...], says: str
) -> None:
    folder = tmp_path / "other"
    folder.mkdir()
    for name in files:
        shutil.copy(ward / ("problem.pddl" if name == "other.pddl" else name), folder / name)
    code, _, told = tpvqa("plan", str(folder))
    assert code == 2
    assert says in " ".join(told.split())


def test_of_a_folder_of_folders_these_are_named(tpvqa: Run, ward: Path) -> None:
    code, _, told = tpvqa("plan", str(ward.parent))
    assert code == 2
    assert "Name one of its folders: my ward" in " ".join(told.split())


def test_a_shipped_task_goes_before_a_folder_of_its_name(
    tpvqa: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "eat_apple").mkdir()
    monkeypatch.chdir(tmp_path)
    assert tpvqa("plan", "eat_apple")[0] == 0
