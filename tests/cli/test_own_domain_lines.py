"""The single commands of docs/your-own-domain.md, each run as it stands there."""

import re
import shlex
import shutil
from pathlib import Path

import pytest

from tests import ward
from tests.cli.conftest import Run
from tests.test_own_robot import PAGE, package
from tests.vlm.chat_server import ChatServer
from tpvqa.episodes import read_episode
from tpvqa.events.events import Acted, Ended, PlanMade, Started

__all__ = ["package"]
TOYS = Path(__file__).parents[1] / "fixtures" / "toys"
ELSEWHERE = ("## In ten minutes", "## 5. What your VLM's answers are worth")
"""Sections whose commands other tests run."""


def commands() -> list[str]:
    """The commands of the page's blocks, without those of `ELSEWHERE`."""
    found = list[str]()
    for section in re.split(r"^(?=## )", PAGE.read_text(), flags=re.MULTILINE):
        if not section.startswith(ELSEWHERE):
            blocks = re.findall(r"```sh\n(.*?)```", section, re.DOTALL)
            found += [line for block in blocks for line in block.splitlines()]
    return found


def block(language: str, holding: str) -> str:
    """The page's only block of a language that holds something."""
    found = re.findall(rf"```{language}\n(.*?)```", PAGE.read_text(), re.DOTALL)
    (one,) = (each for each in found if holding in each)
    return str(one)


@pytest.fixture
def toys(tmp_path: Path) -> None:
    """The domain of the paper's appendix, in the names of the page."""
    for name, called in {"domain.pddl": "domain.pddl", "collect.pddl": "problem.pddl"}.items():
        shutil.copy(TOYS / name, tmp_path / called)
    shutil.copy(TOYS / "questions.yaml", tmp_path)


@pytest.mark.usefixtures("toys", "package")
def test_every_command_of_a_block_works(tpvqa: Run) -> None:
    ran = list[str]()
    for line in commands():
        program, *words = shlex.split(
            line.replace("…", "{}").format("domain.pddl", "problem.pddl"), comments=True
        )
        assert program == "tpvqa"
        with ChatServer(lambda _pictures, _question: 0.97) as server:
            words = [server.url if "localhost" in word else word for word in words]
            kept = words.index(">") if ">" in words else len(words)
            code, out, err = tpvqa(*words[:kept])
        assert code in (0, 1) if words[0] == "run" else code == 0, (line, out, err)
        assert "Traceback" not in err
        for file in words[kept + 1 :]:
            Path(file).write_text(out)
        ran.append(words[0])
    assert ran == ["plan", "questions", "run", "run", "config", "run"]


@pytest.mark.usefixtures("toys")
@pytest.mark.parametrize(
    "option", ["--planner fast-downward:optimal", "--optimal", "--planner fast-downward:lama"]
)
def test_other_planners(option: str, tpvqa: Run) -> None:
    assert option.removeprefix("--planner ") in PAGE.read_text()
    task = "--domain domain.pddl --problem problem.pddl"
    code, out, err = tpvqa("plan", *shlex.split(task), *shlex.split(option))
    assert code == 0, err
    assert "place(toy_eggplant" in out


@pytest.mark.usefixtures("toys")
def test_the_story_of_the_page_is_told(tpvqa: Run) -> None:
    Path("story.yaml").write_text(block("yaml", "script:"))
    words = "run --domain domain.pddl --problem problem.pddl --world scripted:story.yaml"
    assert "--world scripted:story.yaml" in PAGE.read_text()
    code, out, err = tpvqa(*words.split(), "--vlm", "oracle:1", "--out", "told")
    assert code == 0, (out, err)
    told = [
        (each.truth.failure, each.truth.added)
        for each in read_episode(Path("told"))
        if isinstance(each, Acted) and each.truth
    ]
    assert any(failure is not None for failure, _ in told)


@pytest.mark.parametrize("option", ["--priors priors.yaml", "--start unknown"])
def test_what_is_not_known_at_first(option: str, tpvqa: Run) -> None:
    assert option in PAGE.read_text()
    opened = block("pddl", "(oneof").replace("(:init (at hall) (free) (lies anna theatre)", "")
    *lines, last = opened.rstrip().splitlines()
    Path("domain.pddl").write_text(ward.DOMAIN)
    Path("problem.pddl").write_text(ward.PROBLEM.replace(ward.OPEN, "\n".join([*lines, last[:-1]])))
    Path("priors.yaml").write_text(block("yaml", "elsewhere:"))
    words = "run domain.pddl problem.pddl --vlm oracle:1 --failure 0 --out one"
    code, out, err = tpvqa(*words.split(), *option.split())
    assert code == 0, (out, err)
    started, *events = read_episode(Path("one"))
    assert isinstance(started, Started)
    assert any(isinstance(each, PlanMade) for each in events)
    ended = events[-1]
    assert isinstance(ended, Ended)
    assert ended.because == "goal"


@pytest.mark.usefixtures("toys")
def test_a_calibration_of_simulated_trials(tpvqa: Run) -> None:
    (line,) = re.findall(r"`(tpvqa calibrate --trials[^`]*)`", PAGE.read_text())
    words = shlex.split(line.replace("--trials 60", "--trials 6"))[1:]
    code, out, err = tpvqa(*words, "--out", "calibration.json")
    assert code == 0, (out, err)
    assert Path("calibration.json").exists()


@pytest.mark.usefixtures("toys")
def test_a_skill_that_notices(tpvqa: Run) -> None:
    (option,) = re.findall(r"`(--monitor belief:notices[^`]*)`", PAGE.read_text())
    words = "run domain.pddl problem.pddl --vlm oracle:0.95 --out one"
    code, out, err = tpvqa(*words.split(), *option.split())
    assert code in (0, 1), (out, err)
    started, *_ = read_episode(Path("one"))
    assert isinstance(started, Started)
    assert started.config.monitor.spec == option.split()[1]
