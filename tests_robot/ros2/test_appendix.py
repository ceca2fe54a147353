"""The trial of the paper's appendix as three processes over DDS, one of which is killed in it."""

import json
import subprocess
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path

import pytest

from tests_robot.ros2.conftest import BY_ACTION, change, wait_for
from tests_robot.ros2.looks import check_looks, stamps, until_next_action
from tests_robot.ros2.test_run_task import Client, offered, offered_loop
from tpvqa.episodes import read_episode
from tpvqa.events import Ended, Event
from tpvqa.events.events import Acted, Acting, Answered, Asked, Decided
from tpvqa.worlds import Report
from tpvqa_robots.ros2.link import said

pytest.importorskip("tpvqa_interfaces")

PATIENT = (
    BY_ACTION,
    ("deadline: 10", "deadline: 300"),
    ("age: 1.0", "age: 30"),
    ("wait: 8", "wait: 120"),
    ("gone: 1.5", "gone: 60"),
    ("grace: 0.5", "grace: 30"),
    (" depth: /tpvqa/overhead/depth,", ""),  # nobody here looks at it
)
"""Other tests take the cores as well; the robot's physics is then as slow as everything."""
KILLED = "(pick_up cyan_container)"
"""The skill in which the server is killed: after the slip, before the bad grasp."""


@contextmanager
def offered_toys(kept: Path) -> "Iterator[subprocess.Popen[str]]":
    """`tpvqa skill-server` on the toys' table, once its topics are offered."""
    words = ["--world", "toys:appendix", "--seed", "1", "--rate", "0.5", "--keep", str(kept)]
    with offered("skill-server", "collect_toys", *words) as server:
        yield server


def at_work(client: Client) -> list[str]:
    """What the skill server says that it is at, as it goes on."""
    from tpvqa_interfaces.msg import SkillServer

    heard: list[str] = []
    client.link.listen(
        SkillServer,
        "/tpvqa/execute_skill/server",
        lambda message: heard.append(message.running),
        said(),
    )
    return heard


def test_the_appendix_over_dds_goes_on_after_its_robot_was_killed(
    setup_file: Path, tmp_path: Path
) -> None:
    kept = tmp_path / "world.json"
    change(setup_file, *PATIENT)
    with offered_loop(setup_file, tmp_path / "episodes", "tpvqa"):
        client = Client()
        try:
            with offered_toys(kept) as robot:
                running = at_work(client)
                got = client.send().get_result_async()
                wait_for(lambda: KILLED in running[-1:], 300)
                robot.kill()
                robot.wait()
            restarted = time.time()
            with offered_toys(kept):
                result = client.result(None, got, 300).result
        finally:
            client.link.close()

    assert (result.because, result.completed) == ("goal", True), result.message
    events = read_episode(result.episode)
    check_the_appendix(events)
    check_the_restart(events, restarted)
    check_looks(events)
    # The robot itself did no more than the log says, though another one had to go on for it.
    done = [pddl for pddl, acted in actions(events) if acted.report is not Report.FAILED]
    grasped = json.loads(kept.read_text())["grasps"]
    assert grasped == {
        thing: done.count(f"(pick_up {thing})")
        for thing in ("blue_container", "cyan_container", "toy_eggplant")
    }
    assert grasped["toy_eggplant"] == 2


def check_the_appendix(events: list[Event]) -> None:
    """The goal is true, one container slipped and another was taken, one grasp was repeated."""
    decided = [(e.decision, e.action) for e in events if isinstance(e, Decided)]
    assert ("replan", "(place blue_container goal_area)") in decided
    assert ("repeat", "(pick_up toy_eggplant)") in decided
    ended = events[-1]
    assert isinstance(ended, Ended)
    assert (ended.completed, ended.believed_goal) == (True, True)
    assert (ended.replans, ended.repeats) == (1, 2)


def check_the_restart(events: list[Event], restarted: float) -> None:
    """The skill that broke off is reported failed, and seen to be so before anything else."""
    (at,) = (n for n, e in enumerate(events) if isinstance(e, Acted) and "went away" in e.message)
    broken, acting = events[at], events[at - 1]
    assert isinstance(broken, Acted)
    assert isinstance(acting, Acting)
    assert (acting.action.pddl(), broken.report) == (KILLED, Report.FAILED)
    looked = until_next_action(events, at)
    assert stamps(looked)
    assert min(stamps(looked)) > restarted
    assert ("(in_hand cyan_container)", "no") in answers(looked)


def answers(events: Sequence[Event]) -> list[tuple[str | None, str]]:
    """Which facts were asked about, and what was answered."""
    found: list[tuple[str | None, str]] = []
    for asked, answered in pairwise(events):
        if isinstance(asked, Asked) and isinstance(answered, Answered):
            pairs = zip(asked.questions, answered.answers, strict=True)
            found += [(question.atom, answer.reply) for question, answer in pairs]
    return found


def actions(events: list[Event]) -> list[tuple[str, Acted]]:
    """Every action with what came of it."""
    return [
        (acting.action.pddl(), acted)
        for acting, acted in pairwise(events)
        if isinstance(acting, Acting) and isinstance(acted, Acted)
    ]
