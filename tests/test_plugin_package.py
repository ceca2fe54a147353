"""The package in examples/plugin, installed by pip, and the small projects that it looks at."""

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from random import Random

import pytest

from tests.cli.conftest import Run, tpvqa
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Literal, Task, load_task
from tpvqa.planning import Plan, Planner
from tpvqa.planning.making import make_planner
from tpvqa.plugins import Kind, names
from tpvqa.questions import QuestionBook
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.making import make_vlm

__all__ = ["tpvqa"]
ROOT = Path(__file__).parents[1]
PROJECTS = sorted(each.parent for each in ROOT.glob("examples/projects/*/domain.pddl"))
OFFERED = {
    Kind.VLM: "nearest",
    Kind.WORLD: "drawn",
    Kind.PLANNER: "breadth",
    Kind.MONITOR: "twice",
}
PAGE = ROOT / "docs/your-own-domain.md"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that pip has put the package into, without asking any index."""
    folder = tmp_path_factory.mktemp("site")
    source = tmp_path_factory.mktemp("source") / "plugin"
    shutil.copytree(ROOT / "examples/plugin", source)
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    alone = ["--no-deps", "--no-index", "--no-build-isolation", "--target", str(folder)]
    done = subprocess.run([*pip, *alone, str(source)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture(params=PROJECTS, ids=lambda folder: str(folder.name))
def project(
    request: pytest.FixtureRequest, site: Path, tpvqa: Run, monkeypatch: pytest.MonkeyPatch
) -> Path:
    """A copy of a small project, with the package installed; it is where commands are run."""
    monkeypatch.syspath_prepend(str(site))
    folder = Path.cwd() / "project"
    shutil.copytree(request.param, folder)
    monkeypatch.chdir(folder)
    return folder


def _task(folder: Path) -> Task:
    return load_task(folder / "domain.pddl", folder / "problem.pddl")


def test_there_are_two_small_projects_and_their_pages_name_their_files() -> None:
    assert [each.name for each in PROJECTS] == ["greenhouse", "sorting"]
    for folder in PROJECTS:
        page = (folder / "README.md").read_text()
        for file in ("questions.yaml", "world.yaml", "pictures", "calibration.json"):
            assert (folder / file).exists()
            assert file in page


@pytest.mark.parametrize("kind", OFFERED)
def test_each_of_its_parts_is_there_by_name(
    kind: Kind, site: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert OFFERED[kind] not in names(kind)
    monkeypatch.syspath_prepend(str(site))
    assert OFFERED[kind] in names(kind)


def test_all_of_its_parts_run_a_trial_together(project: Path, tpvqa: Run) -> None:
    parts = "--world drawn --vlm nearest:pictures --planner breadth --monitor twice --failure 0"
    code, out, err = tpvqa("run", "domain.pddl", "problem.pddl", *parts.split(), "--out", "one")
    assert code == 0, (out, err)
    assert "goal reached" in out
    assert len(list(Path("one/frames").iterdir())) >= 3


def test_the_commands_of_the_projects_pages_work(project: Path, tpvqa: Run) -> None:
    block = re.findall(r"```sh\n(.*?)```", (project / "README.md").read_text(), re.DOTALL)[0]
    ran = 0
    for line in block.splitlines():
        program, *words = shlex.split(line, comments=True)
        if program == "tpvqa":
            code, out, err = tpvqa(*words)
            assert code == 0, (line, out, err)
            ran += 1
    assert ran >= 3


def test_nothing_is_wrong_with_the_projects(project: Path, tpvqa: Run) -> None:
    code, out, _ = tpvqa("check", "domain.pddl", "problem.pddl", "--strict")
    assert code == 0, out


def test_the_vlm_tells_pictures_that_it_has_not_learnt_from(project: Path) -> None:
    """A picture is never compared with itself, so that the labelled ones are new to it."""
    from tpvqa_benchtop.nearest import Nearest
    from tpvqa_benchtop.pictures import facts_of

    task = _task(project)
    book = QuestionBook.load(project / "questions.yaml", task)
    vlm, _ = make_vlm("nearest:pictures", {})
    assert isinstance(vlm, Nearest)
    right = asked = 0
    for each in vlm._known:
        data = (project / "pictures" / each.file).read_bytes()
        questions = [book.fact(Literal(a)) for a in facts_of(task) if each.shows_fact(a)]
        answers: list[Answer] = vlm.ask(
            Observation(time=0.0, frames={"front": Frame("front", "front", data)}), questions
        )
        for question, answer in zip(questions, answers, strict=True):
            asked += 1
            right += (answer.reply is Reply.YES) == each.holds(question.atom)
            assert answer.p_yes is not None
            assert 0 < answer.p_yes < 1
    assert right / asked > 0.97
    action = task.ground_actions()[0]
    (answer,) = vlm.ask(
        Observation(time=0.0, frames={"front": Frame("front", "front", data)}), [book.did(action)]
    )
    assert answer.reply is Reply.UNKNOWN


def test_the_planner_finds_plans_as_short_as_an_optimal_one(project: Path) -> None:
    task, chance = _task(project), Random(5)
    breadth, other = make_planner("breadth"), make_planner("fast-downward:optimal")
    state = task.init
    try:
        for _ in range(8):
            assert _length(breadth, task, state) == _length(other, task, state)
            able = [each for each in task.ground_actions() if task.applicable(state, each)]
            state = task.apply(state, chance.choice(able)) if able else task.init
    finally:
        other.close()


def _length(planner: Planner, task: Task, state: frozenset[object]) -> int:
    found = planner.plan(task, state)  # type: ignore[arg-type]
    assert isinstance(found, Plan)
    return len(found.actions)


def test_the_labelled_pictures_show_every_state_that_can_be_seen(project: Path) -> None:
    from tpvqa.worlds.pictures import load_set
    from tpvqa.worlds.world_file import load_world_file
    from tpvqa_benchtop.pictures import HIDDEN, states

    task = _task(project)
    wanted = {
        frozenset(atom for atom in state if atom.predicate not in HIDDEN)
        for state in states(task, load_world_file(project / "world.yaml", task))
    }
    shown = {each.true_state for each in load_set(project / "pictures").manifest.pictures}
    assert shown == wanted


def ten_minutes() -> list[list[str]]:
    """The commands of the page's first section."""
    section = PAGE.read_text().partition("## In ten minutes")[2].partition("\n## ")[0]
    blocks = re.findall(r"```sh\n(.*?)```", section, re.DOTALL)
    lines = [line for block in blocks for line in block.splitlines()]
    return [shlex.split(line, comments=True) for line in lines if line.startswith("tpvqa")]


def test_ten_minutes_lead_from_pddl_and_pictures_to_a_calibrated_run(
    project: Path, tpvqa: Run
) -> None:
    edited = Path("questions.yaml").read_text()
    for file in ("questions.yaml", "calibration.json"):
        Path(file).unlink()
    done = []
    for _, *words in ten_minutes():
        code, out, err = tpvqa(*words)
        assert code == 0, (words, out, err)
        done.append(words[0])
        if "--draft" in words:
            assert Path("questions.yaml").exists()
            Path("questions.yaml").write_text(edited)  # what a person makes of it
    assert done == ["check", "questions", "check", "questions", "run", "calibrate", "run", "report"]
    page = Path("episodes/2/report.html").read_text()
    assert "goal reached" in page.lower() or "completed" in page.lower()
    assert Path("episodes/2/frames").exists()
