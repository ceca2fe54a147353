"""The performer for PlanSys2, against a stand-in of its executor; no PlanSys2 was there."""

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests_robot.ros2.conftest import BY_ACTION, Start, change, wait_for
from tests_robot.ros2.test_world import done
from tpvqa_robots.plansys2.hub import COMMITTED, Kind, Performer, Said, Work
from tpvqa_robots.ros2.link import Link, said

FIND = ("find", ("blue_container", "table"))


class Executor:
    """Asks for one action at a time, as PlanSys2's ActionExecutor does: the first who answers is
    confirmed, whoever answers later is rejected."""

    def __init__(self) -> None:
        from plansys2_msgs.msg import ActionExecution, ActionPerformerStatus

        self.kind = ActionExecution
        self.link = Link("executor")
        self.heard: list[Any] = []
        self.statuses: list[Any] = []
        self.performer = ""
        self.wanted: tuple[str, list[str]] = ("", [])
        self.hub = self.link.speaker(ActionExecution, "actions_hub", said(100))
        self.link.listen(ActionExecution, "actions_hub", self.hear, said(100))
        self.link.listen(
            ActionPerformerStatus, "performers_status", self.statuses.append, said(100)
        )
        self.link.start()

    def say(self, kind: int, node: str) -> None:
        action, arguments = self.wanted
        self.hub.publish(self.kind(type=kind, node_id=node, action=action, arguments=arguments))

    def hear(self, message: Any) -> None:
        if (message.action, list(message.arguments)) != self.wanted:
            return
        self.heard.append(message)
        if message.type == self.kind.RESPONSE:
            first = not self.performer
            self.performer = self.performer or message.node_id
            self.say(self.kind.CONFIRM if first else self.kind.REJECT, message.node_id)

    def request(self, action: str, *arguments: str) -> None:
        """Ask, again and again as PlanSys2 does, until somebody answers."""
        self.heard, self.performer, self.wanted = [], "", (action, list(arguments))

        def answered() -> bool:
            if not self.performer:
                self.say(self.kind.REQUEST, "executor")
                threading.Event().wait(0.3)
            return bool(self.performer)

        wait_for(answered)

    def finished(self) -> Any:
        wait_for(lambda: any(each.type == self.kind.FINISH for each in self.heard))
        return next(each for each in self.heard if each.type == self.kind.FINISH)


@pytest.fixture
def executor(domain: int) -> Iterator[Executor]:
    pytest.importorskip("plansys2_msgs")
    made = Executor()
    yield made
    made.link.close()


def test_actions_are_performed_denied_cancelled_and_ended(
    start: Start, executor: Executor, setup_file: Path, state: Path
) -> None:
    start(seconds=0.6)
    change(setup_file, BY_ACTION)
    command = [str(Path(sys.executable).parent / "tpvqa"), "plansys2-performer", "collect_toys"]
    performer = subprocess.Popen(
        [*command, "--world", f"ros2:{setup_file}", "--vlm", "oracle"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env=os.environ.copy(),
    )
    try:
        executor.request("pick_up", "blue_container")  # it is not found yet
        denied = executor.finished()
        assert not denied.success
        assert "denied" in denied.status
        assert not state.exists() or not done(state)

        executor.request("find", "blue_container", "table")
        ended = executor.finished()
        assert (ended.success, ended.status) == (True, "seen")
        assert ended.node_id == executor.performer == "tpvqa"
        told = [each.status for each in executor.heard if each.type == executor.kind.FEEDBACK]
        assert any(text.startswith("acts: ") for text in told)
        wait_for(lambda: any(each.state == each.READY for each in executor.statuses))

        executor.request("pick_up", "blue_container")
        wait_for(lambda: len(done(state)) == 3)
        executor.say(executor.kind.CANCEL, "tpvqa")
        wait_for(lambda: done(state)[-1][1] == "stood")
        executor.request("pick_up", "blue_container")  # free again, and the first was not told of
        assert executor.finished().success

        executor.request("find", "goal_area", "blue_container")
        wait_for(lambda: done(state)[-1][1] == "begins")
        performer.send_signal(signal.SIGINT)
        said, _ = performer.communicate(timeout=60)
        assert "Traceback" not in said
        assert performer.returncode == 130
        wait_for(lambda: done(state)[-1][1] == "stood")
        assert not executor.finished().success
    finally:
        performer.kill()
        performer.wait()


class Hub:
    """One performer without ROS."""

    def __init__(self) -> None:
        self.now, self.works = 0.0, list[Work]()
        self.heard: list[Said] = []
        self.performer = Performer(
            "me",
            lambda action, _: action == "find",
            self.works.append,
            self.heard.append,
            lambda: self.now,
        )

    def say(self, kind: Kind, node: str = "me", wanted: Any = FIND) -> list[Kind]:
        before = len(self.heard)
        self.performer.hear(Said(kind, node, *wanted))
        return [each.kind for each in self.heard[before:]]


def test_what_was_not_offered_is_not_begun() -> None:
    hub = Hub()
    assert hub.say(Kind.CONFIRM) == [Kind.FINISH]
    assert not hub.heard[-1].success
    assert hub.say(Kind.REQUEST, "executor", ("fly", ())) == []
    assert hub.say(Kind.REQUEST, "executor") == [Kind.RESPONSE]
    assert hub.say(Kind.REQUEST, "executor", ("find", ("cup", "table"))) == []  # dealing
    assert hub.say(Kind.REJECT) == []
    assert hub.say(Kind.CONFIRM) == [Kind.FINISH]  # it was rejected
    assert hub.say(Kind.REQUEST, "executor") == [Kind.RESPONSE]
    hub.now += COMMITTED + 1
    assert hub.say(Kind.CONFIRM) == [Kind.FINISH]  # too late
    assert hub.works == []


def test_a_confirmation_that_comes_twice_is_done_once() -> None:
    hub = Hub()
    hub.say(Kind.REQUEST, "executor")
    assert hub.say(Kind.CONFIRM, "another") == []
    assert hub.say(Kind.CONFIRM) == hub.say(Kind.CONFIRM) == []
    assert len(hub.works) == 1
    assert hub.say(Kind.REQUEST, "executor") == []  # busy
    hub.performer.finish(success=True, status="")
    assert hub.heard[-1].kind is Kind.FINISH
    assert hub.say(Kind.CONFIRM) == [Kind.FINISH]
    assert not hub.heard[-1].success
    assert len(hub.works) == 1


@given(st.lists(st.tuples(st.sampled_from(Kind), st.sampled_from(["me", "you"]), st.booleans())))
def test_every_work_was_offered_once(heard: list[tuple[Kind, str, bool]]) -> None:
    hub = Hub()
    for kind, node, finish in heard:
        hub.now += 1.0
        hub.say(kind, node)
        offers = sum(each.kind is Kind.RESPONSE for each in hub.heard)
        assert len(hub.works) <= offers
        if finish:
            hub.performer.finish(success=True, status="")
    ended = sum(each.kind is Kind.FINISH and each.success for each in hub.heard)
    assert ended <= len(hub.works)
