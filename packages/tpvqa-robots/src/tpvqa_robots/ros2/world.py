"""The world `ros2`: a robot behind topics, watched so closely that it can be stopped."""

import threading
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from pathlib import Path
from threading import Event
from time import monotonic
from typing import Any

from tpvqa.errors import ConfigError, UnknownNameError, WorldError
from tpvqa.observation import Frame, Observation, SensedFact
from tpvqa.pddl import Action, Task
from tpvqa.worlds.protocol import Execution, Report
from tpvqa_robots.ros2.action_client import ActionClient
from tpvqa_robots.ros2.client import Client, Doing, TopicClient, new_name
from tpvqa_robots.ros2.eyes import open_eyes
from tpvqa_robots.ros2.feeling import Joints
from tpvqa_robots.ros2.link import Link, said
from tpvqa_robots.ros2.setup import Server, Setup, load_setup
from tpvqa_robots.ros2.truth import PublishedTruth

TICK = 0.02
"""Seconds between two looks at what has changed."""
ENDS = 1.0
"""Seconds in which a cancelled skill has to say that it ended."""
FEELS = 0.1
"""Seconds in which a robot that is told to stand may say where its joints are then."""
AHEAD = 0.5
"""Seconds by which a skill may have ended in the future: clocks differ."""
DEPTH = 1.0
"""Seconds that a picture waits for its depth; then it counts without."""


class Ros2World:
    """A robot behind ROS 2 topics, as a setup file says.

    No skill starts but on a picture taken after the last action ended; where there is none within
    `wait` seconds, where the robot is another's, stopped or gone, or where an action would leave
    the workspace, it is refused and the trial ends there, saying why.

    Args:
        task: The task.
        setup: Topics, servers and bounds.

    Raises:
        MissingExtraError: ROS 2 is not installed.
        TpvqaError: A server is an action's, and its messages are not built.
    """

    def __init__(self, task: Task, setup: Setup):
        from std_msgs.msg import Bool, String

        self._task, self._setup = task, setup
        self._link = Link("tpvqa_loop", sim_time=setup.sim_time)
        self._changed = threading.Condition()
        self._eyes = open_eyes(self._link, setup, self._changed)
        try:
            self._clients = self._found(setup)
        except BaseException:
            self._link.close()
            raise
        self._joints: Joints | None = None
        if setup.joints is not None:
            self._joints = Joints(self._link, setup.joints, setup.sensed, self._notify)
        self._published: PublishedTruth | None = None
        if setup.truth is not None:
            self._published = PublishedTruth(task, setup.truth)
            self._link.listen(String, setup.truth, self._hear_truth, said(1))
        self._stop = ""
        self._link.heed(Bool, setup.stop, self._hear_stop)
        self._start = self._link.now()
        self._ended, self._loose = -1.0, False
        self._looked: float | None = None
        self._told: tuple[SensedFact, ...] = ()
        self._link.start()

    @classmethod
    def from_spec(cls, arguments: str, *, task: Task) -> "Ros2World":
        """The world of `ros2:FILE`.

        Raises:
            ConfigError: The file is missing or broken, or does not fit the task.
        """
        if not arguments:
            raise ConfigError("The world 'ros2' needs its file: --world ros2:robot.yaml")
        setup = load_setup(Path(arguments), task)
        return cls(task, setup) if setup.truth is None else SimulatedRos2World(task, setup)

    def _found(self, setup: Setup) -> dict[Server, Client]:
        found: dict[Server, Client] = {}
        me = new_name()
        for server in dict.fromkeys(skill.server for skill in setup.skills.values()):
            make = ActionClient if server.is_action else TopicClient
            found[server] = make(self._link, server.name, self._changed, setup.gone, me)
        return found

    def views(self) -> Sequence[str]:
        """The cameras of the setup file."""
        return tuple(self._eyes)

    def senses(self) -> Collection[str]:
        """What joints tell, and what skills tell of themselves."""
        rules = (rule.atom.predicate for rule in self._setup.sensed)
        return tuple(dict.fromkeys((*rules, *self._setup.told)))

    def observe(self, view: str | None = None) -> Observation:
        """Wait for a picture taken after the last action ended.

        Where none comes in time the look shows nothing, and `detail` says why.

        Raises:
            UnknownNameError: There is no such view.
        """
        view = next(iter(self._eyes)) if view is None else view
        if view not in self._eyes:
            raise UnknownNameError("view", view, tuple(self._eyes))
        frame, why = self._picture(view)
        now = self._link.now()
        facts = self._facts(self._told, later=True)
        if frame is None or frame.stamp is None:
            return Observation(time=now - self._start, detail={"no picture": why}, facts=facts)
        self._looked = frame.stamp
        time = frame.stamp - self._start
        shown = replace(frame, stamp=time)
        return Observation(
            time=time, frames={view: shown}, detail={"stamp": frame.stamp}, facts=facts
        )

    def refuses(self, action: Action) -> str:
        """Why an action would leave the workspace; empty where it would not."""
        bounds = self._setup.workspace
        outside = None if bounds is None else bounds.left_by(action.arguments)
        if bounds is None or outside is None:
            return ""
        at = ", ".join(f"{x:g}" for x in bounds.places[outside])
        return f"{action.pddl()} would leave the workspace: {outside} is at {at} m"

    def execute(
        self, action: Action, *, deadline: float | None = None, cancel: Event | None = None
    ) -> Execution:
        """Have a skill server carry out an action; seconds are of the clock on the wall."""
        began = monotonic()
        skill = self._setup.skills.get(action.name)
        if skill is None:
            known = ", ".join(self._setup.skills)
            return _refused(began, f"no skill server is named for {action.name!r}; for {known}")
        if outside := self.refuses(action):
            return _refused(began, outside)
        client = self._clients[skill.server]
        why = self._not_ready(client, cancel)
        if why:
            return _refused(began, why)
        if self._loose:  # whatever did not say that it ended may have gone on until now
            self._ended, self._loose = self._link.now(), False
        if self._looked is None or self._looked <= self._ended:
            shown = self.observe()
            if stopped := self._stopped(client):
                return _refused(began, f"{stopped}; {self._where()}")
            if self._looked is None or self._looked <= self._ended:
                return _refused(
                    began,
                    f"no skill starts without a picture of after the last action: "
                    f"{shown.detail.get('no picture', 'none came')}",
                )
        if cancel is not None and cancel.is_set():
            return Execution(Report.CANCELLED, 0.0, "cancelled before it began")
        seconds = skill.deadline if deadline is None else min(deadline, skill.deadline)
        for eye in self._eyes.values():
            eye.acted()
        began, asked = monotonic(), self._link.now()
        doing = client.do(action.pddl(), seconds, self._looked)
        self._told = ()
        try:
            return self._await(client, doing, action, began, asked, seconds, cancel)
        except BaseException:
            client.cancel(doing)
            self._ended = self._link.now()
            raise

    def halted(self) -> str:
        """Whether there was an emergency stop, and where things are; empty where there was none."""
        return f"{self._stop}; {self._where()}" if self._stop else ""

    def close(self) -> None:
        """Give the robot back and end the node. Can be called twice."""
        for client in self._clients.values():
            client.release()
        self._clients = {}
        self._link.close()

    def _await(
        self,
        client: Client,
        doing: Doing,
        action: Action,
        began: float,
        asked: float,
        seconds: float,
        cancel: Event | None,
    ) -> Execution:
        """What comes of a skill that was asked for, by the clock on the wall and that of stamps."""
        cancelled: float | None = None
        while True:
            with self._changed:
                if not doing.over:
                    self._changed.wait(TICK)
            took = monotonic() - began
            stopped = self._stopped(client)
            if stopped:
                client.cancel(doing)
                self._loose = not doing.over
                self._feel_again()
                said, facts = f"{stopped} in {action.pddl()}; {self._where()}", self._facts(())
                self._ended = self._link.now()
                return Execution(Report.UNAVAILABLE, monotonic() - began, said, facts)
            result = doing.result
            if result is not None:
                now, self._told = self._link.now(), tuple(result.facts)
                self._ended = result.ended if asked <= result.ended <= now + AHEAD else now
                facts = self._facts(self._told)
                return Execution(result.report, took, result.message, facts)
            if doing.refused:
                return _refused(began, doing.refused)
            what = _broke(client, doing)
            if what:
                client.cancel(doing)
                self._ended, self._loose = self._link.now(), True
                said = f"the skill server {client.prefix} {what} in the middle of {action.pddl()}"
                return Execution(Report.FAILED, took, f"{said}: what came of it is for a new look")
            if cancelled is None and cancel is not None and cancel.is_set():
                cancelled = took
                client.cancel(doing)
            if cancelled is not None and took - cancelled > ENDS:
                self._ended, self._loose = self._link.now(), True
                said = "cancelled, but the skill server did not say that it stopped"
                return Execution(Report.CANCELLED, took, said, self._facts(()))
            if took > seconds + self._setup.grace:
                client.cancel(doing)
                self._ended, self._loose = self._link.now(), True
                said = f"{action.pddl()} did not return within {seconds:g} s, and was cancelled"
                return Execution(Report.LATE, took, said, self._facts(()))

    def _not_ready(self, client: Client, cancel: Event | None) -> str:
        """Wait until a server is there and this controller has it; why not, in the end."""

        def over() -> bool:
            given_up = cancel is not None and cancel.is_set()
            return given_up or bool(self._stopped(client)) or (client.holds and not client.busy)

        self._wait(over)
        if cancel is not None and cancel.is_set() and not self._stopped(client):
            return ""
        return self._kept_from(client)

    def _kept_from(self, client: Client) -> str:
        """Why no skill may begin now; empty where one may."""
        stopped = self._stopped(client)
        if stopped:
            return f"{stopped}; {self._where()}"
        waited = f"for {self._setup.wait:g} s"
        if not client.there:
            return f"the skill server {client.prefix} was not heard {waited}: is it running?"
        if not client.holds:
            return f"the robot of {client.prefix} is held by another controller, {client.holder}"
        if client.busy:
            return f"the skill server {client.prefix} is still at {client.busy} {waited}"
        return ""

    def _picture(self, view: str) -> tuple[Frame | None, str]:
        eye, age = self._eyes[view], self._setup.age
        found: tuple[Frame | None, str] = (None, "")
        flat: float | None = None

        def over() -> bool:
            nonlocal found, flat
            found = eye.frame(self._link.now(), self._ended, age)
            frame, true = found[0], self._published
            if self._stop:
                return True
            if frame is None or (true is not None and true.stamp <= self._ended):
                return False
            flat = monotonic() if flat is None else flat
            return eye.whole(frame) or monotonic() - flat > DEPTH

        self._wait(over)
        return found

    def _wait(self, over: Callable[[], bool]) -> None:
        until = monotonic() + self._setup.wait
        with self._changed:
            while not over() and monotonic() < until:
                self._changed.wait(TICK)

    def _facts(
        self, told: tuple[SensedFact, ...], *, later: bool = False
    ) -> tuple[SensedFact, ...]:
        """What skill and joints tell. Where both speak, the skill's word counts as it ends, and the
        joints' later: what was held may have slipped."""
        felt: tuple[SensedFact, ...] = ()
        if self._joints is not None:
            felt = self._joints.facts(self._link.now(), self._ended, self._setup.age)
        first, second = (felt, told) if later else (told, felt)
        own = {fact.atom for fact in first}
        return (*first, *(fact for fact in second if fact.atom not in own))

    def _where(self) -> str:
        """Where things are, as far as the robot feels it, and how long ago it did."""
        said = "its joints are not known"
        if self._joints is not None:
            said = self._joints.said(self._link.now())
        felt = ", ".join(f"{f.atom.pddl()} {f.probability:.2f}" for f in self._facts(()))
        return f"the robot is told to stand; {said}" + (f"; it feels {felt}" if felt else "")

    def _feel_again(self) -> None:
        """Wait a moment for joints of after now."""
        joints, now, until = self._joints, self._link.now(), monotonic() + FEELS
        with self._changed:
            while joints is not None and joints.stamp <= now and monotonic() < until:
                self._changed.wait(TICK)

    def _stopped(self, client: Client) -> str:
        return self._stop or client.stopped

    def _hear_stop(self, message: Any) -> None:
        if message.data:
            self._stop = f"emergency stop on {self._setup.stop}"
            self._notify()

    def _hear_truth(self, message: Any) -> None:
        if self._published is not None:
            self._published.hear(message)
            self._notify()

    def _notify(self) -> None:
        with self._changed:
            self._changed.notify_all()


class SimulatedRos2World(Ros2World):
    """A simulated robot behind topics, which says what is true."""

    def check(self) -> None:
        """Wait until it says so: without it no trial can be judged.

        Raises:
            WorldError: Nothing comes within `wait` seconds.
        """
        self._wait(lambda: self.truth.state is not None)
        if self.truth.state is None:
            raise WorldError(
                f"Nothing came on {self._setup.truth} within {self._setup.wait:g} s: is the skill "
                "server running, in the same ROS_DOMAIN_ID? Leave 'truth' out for a real robot."
            )

    @property
    def truth(self) -> PublishedTruth:
        """What is true now."""
        assert self._published is not None
        return self._published


def _broke(client: Client, doing: Doing) -> str:
    """What keeps a skill that was begun from being watched to its end; empty for nothing."""
    if doing.malformed:
        return "answered what is not understood"
    if not client.there or client.server != doing.server:
        return "went away"
    if client.holder not in (None, client.me):
        return f"came to be held by another controller, {client.holder},"
    return "did not take the goal" if doing.untaken else ""


def _refused(began: float, why: str) -> Execution:
    return Execution(Report.UNAVAILABLE, monotonic() - began, why)
