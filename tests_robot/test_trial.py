"""The trial of the paper's appendix, from the command line to the film."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests_robot.bag_reading import check_bag
from tpvqa import Task, TpvqaError, load_task
from tpvqa.tasks import find_task
from tpvqa_robots.film.writing import GIF_BYTES
from tpvqa_robots.mishaps import Mishaps
from tpvqa_robots.world import ToysWorld


def run(*words: object) -> subprocess.CompletedProcess[str]:
    command = [str(Path(sys.executable).parent / "tpvqa"), *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_the_appendix_is_filmed_and_bagged(tmp_path: Path) -> None:
    """One container slips and falls, the other is placed; one grasp goes wrong and is repeated."""
    done = run("film", "--speed", 50, "--out", tmp_path / "made")
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    text = (tmp_path / "made" / "episode.jsonl").read_text()
    events = [json.loads(line) for line in text.splitlines()]
    kinds = [(e["kind"], e.get("decision"), e.get("action")) for e in events]
    started = events[0]  # labels of what was asked are worked out from here
    assert "(found blue_container)" in set(started["true_start"]) - set(started["initial"])
    assert ("decided", "replan", "(place blue_container goal_area)") in kinds
    assert ("decided", "repeat", "(pick_up toy_eggplant)") in kinds
    ended = events[-1]
    assert (ended["completed"], ended["repeats"], ended["replans"]) == (True, 1, 1)
    assert (tmp_path / "made" / "film.mp4").stat().st_size > 50_000
    assert 50_000 < (tmp_path / "made" / "film.gif").stat().st_size <= GIF_BYTES
    bagged = run("bag", tmp_path / "made")
    assert bagged.returncode == 0, bagged.stderr
    found = check_bag(tmp_path / "made", tmp_path / "made" / "bag")
    assert len(found["/tpvqa/overhead/depth"]) == sum(e["kind"] == "observed" for e in events)
    again = run("bag", tmp_path / "made")
    assert again.returncode == 2
    assert "--out" in again.stderr


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("slip", "takes slip from 0 to 1, not ''"),
        ("slip=2", "takes slip from 0 to 1, not '2'"),
        ("bad=x", "takes bad from 0 to 1, not 'x'"),
        ("noise=-1", "takes noise from 0 to 10, not '-1'"),
        ("fra=1", "toys:slip=0.2:bad=0.1:noise=1"),
        ("appendix:slip=1", "toys:slip=0.2:bad=0.1:noise=1"),
    ],
)
def test_words_that_are_not_understood_are_named(words: str, told: str) -> None:
    done = run("run", "collect_toys", "--world", f"toys:{words}", "--vlm", "oracle")
    assert done.returncode == 2
    assert told in " ".join(done.stderr.split())
    assert "Traceback" not in done.stderr


def test_a_task_about_something_else_is_refused() -> None:
    files = find_task("build_tower")
    with pytest.raises(TpvqaError, match="cannot tell when"):
        ToysWorld(load_task(files.domain, files.problem))


@pytest.mark.parametrize("rate", [0.2, 0.5])
def test_mishaps_happen_as_often_as_is_said(task: Task, rate: float) -> None:
    from tpvqa_robots.mishaps import Drawn

    mishaps = Mishaps(slip=rate, bad=rate)
    drawn = [Drawn(mishaps, 7, episode) for episode in range(600)]
    slips = sum(each.slips() for each in drawn) / len(drawn)
    bad = sum(each.is_bad("toy_eggplant") for each in drawn) / len(drawn)
    assert slips == pytest.approx(rate, abs=0.08)
    assert bad == pytest.approx(rate, abs=0.08)
