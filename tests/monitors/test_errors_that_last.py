"""The belief monitor where errors last, mislead or say nothing: whole trials."""

import re
import shutil
from collections.abc import Callable, Iterator
from contextlib import closing
from functools import cache
from pathlib import Path

import pytest

from tests.doubles import configured
from tpvqa.assembly import Trial
from tpvqa.episodes import MemoryWriter
from tpvqa.events import Ended, Limits
from tpvqa.events.events import Decided, Event
from tpvqa.planning import Planner
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.remembering import Remembering

Ran = Callable[[str, str, int], tuple[Ended, list[Event]]]
TRIALS = range(2)
EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def ran() -> Iterator[Ran]:
    """Trials of clean_dishes by their VLM, how the world differs, and number; each run once."""
    with closing(Remembering(FastDownward())) as planner:

        @cache
        def trial(vlm: str, simulation: str, episode: int) -> tuple[Ended, list[Event]]:
            return _run(planner, vlm, simulation, episode)

        yield trial


def _run(planner: Planner, vlm: str, simulation: str, episode: int) -> tuple[Ended, list[Event]]:
    told = dict(each.split("=") for each in simulation.split(","))
    actions = int(told.pop("actions", 80))
    config = configured(
        task="clean_dishes",
        world="symbolic",
        vlm=vlm,
        monitor="belief",
        limits=Limits(actions=actions, replans=None, repeats=None),
        simulation=told,
        episode=episode,
    )
    writer = MemoryWriter()
    with Trial(config, planner=planner) as trial:
        return trial.run(writer), writer.events


@pytest.mark.parametrize(
    ("vlm", "simulation", "least"),
    [
        ("oracle:0.95:0:1", "redo=free", 2),
        ("oracle:0.8:0:0.74", "redo=free", 1),
        ("oracle:0.8:0:1", "redo=risky", 1),
        ("flawed:misread:0.1:0.95", "redo=free", 1),
        ("flawed:biased:on:0.9:0.5:0.8", "redo=free", 1),
        ("oracle:0.8", "redo=free,elsewhere=1", 1),
    ],
)
def test_it_reaches_the_goal(vlm: str, simulation: str, least: int, ran: Ran) -> None:
    """Uncalibrated, on a shipped task; two trials each, so that only what fails outright shows."""
    ends = [ran(vlm, simulation, episode)[0] for episode in TRIALS]
    assert sum(end.completed is True for end in ends) >= least, [
        (end.because, end.actions, end.questions) for end in ends
    ]
    assert sum(end.questions for end in ends) / len(ends) < 500


def test_a_domain_that_is_no_kitchen_and_has_no_world_file(tmp_path: Path) -> None:
    """A plan of 22 steps with facts that nothing shows, nothing known of the VLM."""
    files = {"domain": "domain.pddl", "problem": "problem.pddl", "questions": "questions.yaml"}
    for file in files.values():
        shutil.copy(EXAMPLES / "hospital" / file, tmp_path)
    config = configured(
        task={part: str(tmp_path / file) for part, file in files.items()},
        world="symbolic",
        vlm="oracle:0.9:0:0.74",
        monitor="belief",
        limits=Limits(actions=400, replans=None, repeats=None),
        seed=60,
        episode=1,
    )
    with Trial(config) as trial:
        ended = trial.run(MemoryWriter())
    assert (ended.because, ended.completed) == ("goal", True)
    assert ended.actions < 150
    assert ended.questions < 800


def test_answers_that_say_nothing_are_asked_little_and_the_goal_is_reached_unseen(ran: Ran) -> None:
    ends = [ran("flawed:useless:0.8", "redo=free", episode)[0] for episode in TRIALS]
    assert sum(end.completed is True for end in ends) >= 1
    assert sum(end.questions for end in ends) / len(ends) < 500


def test_a_question_about_what_is_known_is_said_to_check_the_vlm(ran: Ran) -> None:
    """… and no more than a handful of reasons say so where answers are right."""
    said = {
        vlm: [
            event.reason
            for event in ran(vlm, "redo=free", 0)[1]
            if isinstance(event, Decided) and "to see what answers are worth" in event.reason
        ]
        for vlm in ("flawed:useless:0.8", "oracle:0.95:0:1")
    }
    assert len(said["flawed:useless:0.8"]) > len(said["oracle:0.95:0:1"]) >= 1
    known = re.compile(r"answers are worth \(.* (1\.00|0\.99|0\.0[01]), (a|two|no) ")
    assert all(known.search(reason) for each in said.values() for reason in each), said


def test_who_gives_up_in_doubt_says_what_would_settle_it(ran: Ran) -> None:
    doubted = 0
    for episode in range(20):
        if doubted > 1:
            break
        ended, events = ran("oracle:0.7", "failure=0.5,actions=9", episode)
        last = [each for each in events if isinstance(each, Decided)][-1]
        if ended.because == "goal" or "with only" not in last.reason:
            continue
        likely = float(last.reason.split("with only ")[1][:4])
        if 0.06 < likely < 0.94:
            doubted += 1
            assert "would settle it" in last.reason
    assert doubted
