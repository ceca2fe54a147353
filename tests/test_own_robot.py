"""The robot and the VLM of docs/your-own-domain.md, run as they stand there."""

import asyncio
import importlib
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tpvqa import Trial, TrialConfig
from tpvqa.episodes import EpisodeWriter, read_episode
from tpvqa.errors import PluginError
from tpvqa.events.events import Acted, Acting, Decided, Started
from tpvqa.resuming import resume

PAGE = Path(__file__).parents[1] / "docs/your-own-domain.md"
LAB = """
from pathlib import Path

done = []

def take_picture():
    return b"a JPEG"

def run_skill(name, arguments):
    done.append((name, *arguments))
    return True

def gripper_gap():
    tries = [each for each in done if each[0] == "pick_up"]
    return 0.0 if len(tries) == 1 else 0.02  # the first time it closes on nothing

def probability_of_yes(picture, text):
    return 0.95 if picture == b"a JPEG" else None
"""
Edit = Callable[[str, str, str], None]


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Edit]:
    """Install the package of the page; gives a function that edits one of its files."""
    blocks = re.findall(
        r"```(\w+)\n(?:# my_package/(\w+\.py)\n)?(.*?)```", PAGE.read_text(), re.DOTALL
    )
    folder = tmp_path / "site" / "my_package"
    folder.mkdir(parents=True)
    (folder.parent / "my_lab.py").write_text(LAB)
    for language, name, text in blocks:
        if language == "python":
            (folder / name).write_text(text)
    (points,) = (text for language, _, text in blocks if language == "toml")
    metadata = folder.parent / "my_package-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: my_package\nVersion: 1.0\n")
    told = re.sub(r'\[project\.entry-points\."(.*)"\]', r"[\1]", points).replace('"', "")
    (metadata / "entry_points.txt").write_text(told)
    monkeypatch.syspath_prepend(str(folder.parent))

    def forget() -> None:
        for module in [
            name for name in sys.modules if name.split(".")[0] in ("my_package", "my_lab")
        ]:
            del sys.modules[module]

    def edit(name: str, old: str, new: str) -> None:
        text = (folder / name).read_text()
        assert old in text
        (folder / name).write_text(text.replace(old, new))
        forget()

    forget()
    yield edit
    forget()


CONFIG = TrialConfig(task="clean_dishes", world="my-robot", vlm="my-vlm")


def run(folder: Path, config: TrialConfig = CONFIG) -> None:
    writer = EpisodeWriter(folder)
    try:
        with Trial(config) as trial:
            trial.run(writer, folder=folder)
    finally:
        writer.close()


def test_they_act_and_are_asked(package: Edit, tmp_path: Path) -> None:
    run(tmp_path / "here")
    events = read_episode(tmp_path / "here")
    done = sys.modules["my_lab"].done
    assert done == [
        (event.action.name, *event.action.arguments)
        for event in events
        if isinstance(event, Acting)
    ]
    assert len(done) >= 4
    started = events[0]
    assert isinstance(started, Started)
    assert started.config.simulation is None  # nobody says how often a robot fails
    assert "failure" not in (tmp_path / "here/episode.jsonl").read_text().partition("\n")[0]
    assert {path.read_bytes() for path in (tmp_path / "here/frames").iterdir()} == {b"a JPEG"}


def test_what_it_feels_is_logged_and_decides(package: Edit, tmp_path: Path) -> None:
    """The camera always says yes; the gripper closed on nothing."""
    run(tmp_path / "here", CONFIG.but(world={"spec": "feeling-robot"}))
    events = read_episode(tmp_path / "here")
    felt = [
        (fact.atom, fact.probability) for e in events if isinstance(e, Acted) for fact in e.facts
    ]
    assert felt[:2] == [("(in_hand plate left)", 0.03), ("(in_hand plate left)", 0.97)]
    decided = [e for e in events if isinstance(e, Decided) and "pick_up plate" in e.action]
    assert any("as sensed" in e.reason for e in decided)
    done = [each[:2] for each in sys.modules["my_lab"].done]
    before = done[: done.index(("wash", "plate"))]
    assert before.count(("pick_up", "plate")) >= 2


@pytest.mark.parametrize("way", ["watching", "stepping"])
def test_they_can_be_driven_by_a_program_of_its_own(
    package: Edit, tmp_path: Path, way: str
) -> None:
    folder = tmp_path / "here"
    run(folder)
    writer = EpisodeWriter(tmp_path / "there")
    with Trial(CONFIG) as trial:
        module = importlib.import_module(f"my_package.{way}")
        if way == "watching":
            asyncio.run(module.watch(trial, writer))
        else:
            assert module.step_through(trial, writer).because == "goal"
    writer.close()

    def decided(folder: Path) -> list[tuple[str, int, str]]:
        events = read_episode(folder)
        return [(e.when, e.step, e.decision) for e in events if isinstance(e, Decided)]

    assert decided(tmp_path / "there") == decided(folder)


@pytest.mark.parametrize(
    ("file", "old", "new", "says"),
    [
        (
            "robot.py",
            "take_picture())",
            "camera)",
            r"MyRobot\.observe broke: NameError: .*robot\.py:",
        ),
        (
            "robot.py",
            "return Observation(",
            "return dict(",
            r"observe has to return Observation, not dict",
        ),
        (
            "robot.py",
            "return Execution(",
            "return (",
            r"execute has to return Execution, not tuple",
        ),
        (
            "robot.py",
            "Report.DONE if worked",
            '"finished" if worked',
            "execute returned what cannot be kept: .*no Report: 'finished'",
        ),
        (
            "robot.py",
            "take_picture())",
            "take_picture)",
            "observe returned .*bytes",
        ),
        (
            "vlm.py",
            "p_yes=p)",
            "p_yes=100 * p)",
            "has to give p_yes as a number between 0 and 1, not 9",
        ),
        ("vlm.py", "Reply.YES if", '"maybe" if', "has to give a Reply, and gave 'maybe'"),
        (
            "vlm.py",
            "for question in questions]",
            "for question in ()]",
            r"my-vlm has to give \d Answers",
        ),
        ("vlm.py", "p = probability_of_yes", "return probability_of_yes", r"my-vlm has to give"),
        ("vlm.py", 'frames["front"]', 'frames["back"]', r"MyVLM\.ask broke: KeyError: 'back'"),
    ],
)
def test_what_is_wrong_with_them_is_named_and_can_be_mended(
    package: Edit, tmp_path: Path, file: str, old: str, new: str, says: str
) -> None:
    package(file, old, new)
    with pytest.raises(PluginError, match=says):
        run(tmp_path / "here")
    package(file, new, old)
    assert resume(tmp_path / "here").because in ("goal", "limit of repeats")
