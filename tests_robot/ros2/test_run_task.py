"""The loop as an action: robot, loop and whoever wants a task done are three processes over DDS."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from tests_robot.bag_reading import check_bag
from tests_robot.ros2.conftest import BY_ACTION, Start, change, transition, wait_for
from tests_robot.ros2.looks import check_looks, stamps, until_next_action
from tests_robot.ros2.test_world import done
from tpvqa import Task
from tpvqa.episodes import read_episode
from tpvqa.events import Ended, TrialState
from tpvqa.events.events import Acting, Decided, Resumed
from tpvqa_robots.ros2.link import Link, said
from tpvqa_robots.ros2_trial.bag import messages_of
from tpvqa_robots.ros2_trial.bag_writing import write_bag

pytest.importorskip("tpvqa_interfaces")


class Client:
    """Sends goals to the loop, and keeps what it tells."""

    def __init__(self) -> None:
        from rclpy.action import ActionClient
        from tpvqa_interfaces.action import RunTask
        from tpvqa_interfaces.msg import Belief, Episode
        from tpvqa_interfaces.srv import Ask

        self.link = Link("somebody")
        self.goal, self.question = RunTask.Goal, Ask.Request
        self.episodes: list[Any] = []
        self.beliefs: list[Any] = []
        self.feedback: list[Any] = []
        self.action = ActionClient(self.link.node, RunTask, "/tpvqa/run_task")
        self.asks = self.link.node.create_client(Ask, "/tpvqa/ask")
        self.link.listen(Episode, "/tpvqa/episode", self.episodes.append, said(200))
        self.link.listen(Belief, "/tpvqa/belief", self.beliefs.append, said(200))
        self.link.start()
        wait_for(lambda: self.action.server_is_ready() and self.asks.service_is_ready())

    def send(self, **goal: Any) -> Any:
        """A goal's handle, once the server has answered."""
        sent = self.action.send_goal_async(
            self.goal(**{"seed": -1, **goal}), feedback_callback=self.feedback.append
        )
        wait_for(sent.done)
        return sent.result()

    def result(self, handle: Any, got: Any = None, seconds: float = 120) -> Any:
        got = got or handle.get_result_async()
        wait_for(got.done, seconds)
        return got.result()

    def ask(self, fact: str, view: str = "") -> Any:
        asked = self.asks.call_async(self.question(fact=fact, view=view))
        wait_for(asked.done)
        return asked.result()


@pytest.fixture
def client(domain: int) -> Iterator[Client]:
    made: list[Client] = []

    class Late:
        """Made when it is first wanted: the server is there then."""

        def __getattr__(self, name: str) -> Any:
            if not made:
                made.append(Client())
            return getattr(made[0], name)

    yield Late()  # type: ignore[misc]
    for each in made:
        each.link.close()


@contextmanager
def offered_loop(setup_file: Path, out: Path, monitor: str) -> "Iterator[subprocess.Popen[str]]":
    """`tpvqa ros2-run` on the robot of a setup file, once its action is offered."""
    words = ["--world", f"ros2:{setup_file}", "--vlm", "oracle", "--monitor", monitor]
    with offered("ros2-run", "collect_toys", *words, "--out", str(out)) as server:
        yield server


@contextmanager
def offered(*words: str) -> "Iterator[subprocess.Popen[str]]":
    """A server of `tpvqa`, once it says that something is offered; killed in the end."""
    server = subprocess.Popen(
        [str(Path(sys.executable).parent / "tpvqa"), *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env=os.environ.copy(),
    )
    try:
        assert server.stdout is not None
        assert any("offered" in line for line in server.stdout)
        yield server
    finally:
        server.kill()
        server.wait()


@pytest.fixture
def loop(setup_file: Path, tmp_path: Path) -> "Iterator[subprocess.Popen[str]]":
    """The loop on the robot of the setup file."""
    change(setup_file, BY_ACTION)
    with offered_loop(setup_file, tmp_path / "episodes", "belief") as server:
        yield server


def test_a_task_is_run_told_of_and_asked_about(
    start: Start, loop: "subprocess.Popen[str]", client: Client, state: Path
) -> None:
    from lifecycle_msgs.msg import Transition

    start(seconds=0.3)
    asked = client.ask("(found blue_container)")
    assert asked.answered, asked.message
    assert (asked.reply, asked.question != "") == ("no", True)
    assert asked.seen.sec > 0

    handle = client.send()
    assert handle.accepted
    wait_for(lambda: bool(client.feedback) and bool(done(state)))
    assert not client.send().accepted  # one at a time
    wait_for(lambda: any(each.kind == "observed" for each in client.episodes))
    during = client.ask("(found blue_container)", view="overhead")
    assert during.answered, during.message
    assert not client.ask("(on nothing nowhere)").answered
    assert "shows overhead" in client.ask("(hand_empty)", view="wrist").message

    ended = client.result(handle)
    result = ended.result
    assert (result.because, result.completed) == ("goal", True), result.message
    events = read_episode(result.episode)
    assert isinstance(events[-1], Ended)
    assert result.actions == events[-1].actions
    wait_for(lambda: client.episodes[-1].kind == "ended")
    assert [each.event for each in client.episodes] == list(range(len(events)))
    at, believed = TrialState(), {}
    for event, told in zip(events, client.episodes, strict=True):
        at = at.after(event)
        assert json.loads(told.line)["kind"] == event.kind == told.kind
        assert told.plan == ([] if at.plan is None else [step.pddl() for step in at.plan.plan])
        assert (told.step, told.actions, told.questions) == (at.index, at.actions, at.questions)
        if isinstance(event, Decided):
            acted_on = {atom.pddl(): 1.0 for atom in at.believed}
            believed[event.number] = event.belief or acted_on
    assert any(0 < p < 1 for belief in believed.values() for p in belief.values())
    assert [each.event for each in client.beliefs] == list(believed)
    for each in client.beliefs:
        facts = {fact.fact: fact.probability for fact in each.facts}
        assert facts == pytest.approx(believed[each.event])
    bag = Path(result.episode) / "bag"
    write_bag(bag, messages_of(Path(result.episode)))
    check_bag(Path(result.episode), bag)

    assert transition(client.link, "tpvqa_run_task", Transition.TRANSITION_DEACTIVATE)
    assert not client.send().accepted
    assert transition(client.link, "tpvqa_run_task", Transition.TRANSITION_INACTIVE_SHUTDOWN)
    assert loop.wait(60) == 0


def test_a_task_is_cancelled_refused_and_ended_by_ctrl_c(
    start: Start, loop: "subprocess.Popen[str]", client: Client, state: Path, task: Task
) -> None:
    from action_msgs.msg import GoalStatus

    start("endless")
    unknown = client.result(client.send(task="collect_toyz"))
    assert unknown.status == GoalStatus.STATUS_ABORTED
    assert "collect_toys" in unknown.result.message
    broken = client.result(client.send(problem="(define (problem"))
    assert broken.status == GoalStatus.STATUS_ABORTED
    assert broken.result.message

    own = task.problem_text.replace("problem collect_toys", "problem mine")
    handle = client.send(problem=own, seed=7)
    wait_for(lambda: state.exists() and bool(done(state)), 90)
    handle.cancel_goal_async()
    ended = client.result(handle)
    assert ended.status == GoalStatus.STATUS_CANCELED
    assert ended.result.because == "cancelled"
    assert "seed7" in ended.result.episode
    wait_for(lambda: done(state)[-1][1] == "stood")

    handle = client.send()
    assert handle.accepted
    got = handle.get_result_async()  # a server that has ended cannot be asked any more
    wait_for(lambda: len(done(state)) == 3, 90)
    loop.send_signal(signal.SIGINT)
    ended = client.result(handle, got)
    assert ended.result.because == "cancelled"
    said, _ = loop.communicate(timeout=60)
    assert "Traceback" not in said
    assert loop.returncode == 130
    last = read_episode(ended.result.episode)[-1]
    assert isinstance(last, Ended)
    assert last.because == "cancelled"
    wait_for(lambda: done(state)[-1][1] == "stood")


def test_a_trial_goes_on_after_its_loop_was_killed(
    start: Start, setup_file: Path, client: Client, state: Path, tmp_path: Path
) -> None:
    """Killed in a skill, and the episode resumed: a look comes before anything else."""
    start(seconds=0.5)
    change(setup_file, BY_ACTION)
    with offered_loop(setup_file, tmp_path / "episodes", "tpvqa"):
        assert client.send().accepted
        wait_for(lambda: state.exists() and len(done(state)) >= 3)
    (episode,) = (tmp_path / "episodes").iterdir()
    restarted = time.time()
    command = [str(Path(sys.executable).parent / "tpvqa"), "resume", str(episode)]
    command += ["--world", f"ros2:{setup_file}", "--vlm", "oracle"]
    resumed = subprocess.run(command, capture_output=True, text=True, check=False)
    assert resumed.returncode == 0, resumed.stdout + resumed.stderr
    events = read_episode(episode)
    assert isinstance(events[-1], Ended)
    assert events[-1].completed
    at = next(n for n, event in enumerate(events) if isinstance(event, Resumed))
    assert min(stamps(until_next_action(events, at))) > restarted
    check_looks(events)
    begun = [action for action, what in done(state) if what == "begins"]
    assert begun == [event.action.pddl() for event in events if isinstance(event, Acting)]
