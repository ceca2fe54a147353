"""The appendix's trial as a shipped task: whatever a user types of it does something sensible."""

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Run
from tpvqa.bench.cell import Cell
from tpvqa.bench.grid import Grid
from tpvqa.episodes import read_episode
from tpvqa.events import Started
from tpvqa.tasks import find_task


def test_it_is_told_where_nothing_is_named(tpvqa: Run) -> None:
    code, out, err = tpvqa("run", "collect_toys", "--out", "here")
    assert (code, err) == (0, "")
    assert "new plan find the cyan container" in out
    assert "in truth: the action failed, as the script says" in out
    started = read_episode(Path("here"))[0]
    assert isinstance(started, Started)
    assert (started.world, started.vlm, started.monitor) == ("scripted", "oracle", "belief")


@pytest.mark.parametrize("monitor", ["effectvqa", "palmevqa", "successvqa", "tp", "survey:2"])
@pytest.mark.parametrize("world", ["scripted", "symbolic"])
def test_every_monitor_runs_in_it(tpvqa: Run, monitor: str, world: str) -> None:
    words = ("--monitor", monitor, "--world", world, "--json")
    code, out, _ = tpvqa("run", "collect_toys", *words)
    assert code in (0, 1)
    assert json.loads(out)["ended_because"] not in ("world refused", "planner crashed", "cancelled")


def test_it_is_resumed_with_its_script(tpvqa: Run) -> None:
    tpvqa("run", "collect_toys", "--monitor", "tpvqa", "--out", "here")
    log = Path("here/episode.jsonl")
    lines = log.read_text().splitlines(keepends=True)
    log.write_text("".join(lines[:20]))
    code, out, _ = tpvqa("resume", "here")
    assert code == 0
    assert "goal reached (13 actions, 38 questions, 1 repeat, 1 replan)" in out
    assert len(log.read_text().splitlines()) == len(lines)


def test_it_is_planned_asked_about_and_listed(tpvqa: Run) -> None:
    assert "find the blue container" in tpvqa("questions", "collect_toys")[1]
    assert tpvqa("plan", "collect_toys")[0] == 0
    listed = tpvqa("tasks")[1]
    assert any(line.startswith("collect_toys") for line in listed.splitlines())


def test_many_episodes_of_it_are_left_to_chance() -> None:
    (cell,) = Grid(tasks=["collect_toys"], monitors=["tpvqa"]).cells()
    assert cell == Cell("collect_toys", "tpvqa", "oracle", "symbolic")
    named = Grid(tasks=["collect_toys"], monitors=["tpvqa"], worlds=["scripted"]).cells()
    assert [each.world for each in named] == ["scripted"]


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("--world", "images"), "Run other domains with --world symbolic"),
        (("--vlm", "embedded"), "looks at pictures, and the world 'scripted' has none"),
        (("--world", "scripted:none.yaml"), "none.yaml: cannot be read"),
    ],
)
def test_it_has_no_pictures(tpvqa: Run, words: tuple[str, ...], says: str) -> None:
    code, _, err = tpvqa("run", "collect_toys", *words)
    assert code == 2
    assert says in err
    assert find_task("collect_toys").pictures is None
