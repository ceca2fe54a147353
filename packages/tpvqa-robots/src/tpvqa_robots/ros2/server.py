"""The skill server: offers a `Robot` on topics and as an action, to one controller at a time.

The robot is moved and looked at by one thread alone, that of `run`; what is heard meanwhile cancels
and stops it from the node's thread.
"""

import json
import queue
import threading
import uuid
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from time import monotonic
from typing import Any, TypeVar

from tpvqa.errors import PDDLError, TpvqaError, WorldError
from tpvqa.observation import Frame
from tpvqa.pddl import Atom, State, Task
from tpvqa.worlds import Execution, Report
from tpvqa_robots.ros2 import typed, wire
from tpvqa_robots.ros2.by_action import ByAction
from tpvqa_robots.ros2.by_topics import ByTopics
from tpvqa_robots.ros2.job import Job, Standing, Teller, Wanted
from tpvqa_robots.ros2.lease import Lease
from tpvqa_robots.ros2.lifecycle import Stages, begin
from tpvqa_robots.ros2.link import Link, said
from tpvqa_robots.ros2.pictures import depth_message, info_message, picture_message, set_stamp
from tpvqa_robots.skills.protocol import Robot

T = TypeVar("T")
AHEAD = 0.5
"""Seconds by which a picture may be of the future: clocks differ."""
ACTION = "execute_skill"
"""What the action is called, under the prefix."""


class SkillServer:
    """Offers a robot on PREFIX/command, PREFIX/status, PREFIX/VIEW/… and PREFIX/joints; where
    `tpvqa_interfaces` is built, as the action PREFIX/execute_skill, too.

    Args:
        robot: The robot.
        task: Names its actions.
        views: Its cameras.
        prefix: Of the topics.
        stop: The topic of emergency stops.
        rate: Pictures a second and camera.
        truth: Tells the true state, where the robot is simulated.
        managed: Whether its node waits to be configured and activated by somebody else.
        sim_time: Whether stamps are of the clock on /clock.

    Raises:
        MissingExtraError: ROS 2 is not installed.
    """

    def __init__(
        self,
        robot: Robot,
        task: Task,
        views: Sequence[str],
        *,
        prefix: str = "/tpvqa",
        stop: str = "/tpvqa/stop",
        rate: float = 5.0,
        truth: Callable[[], State] | None = None,
        managed: bool = False,
        sim_time: bool = False,
    ):
        self._robot, self._task, self._views, self._truth = robot, task, views, truth
        self._prefix, self._stop_topic, self._period = prefix, stop, 1 / rate
        self._me, self._lease = f"server-{uuid.uuid4().hex[:12]}", Lease()
        self._jobs: queue.Queue[Job] = queue.Queue()
        self._job: Job | None = None
        self._stop, self._active, self._over = "", False, threading.Event()
        self._lock = threading.RLock()
        self._cameras: Mapping[str, Sequence[tuple[Any, Callable[..., Any]]]] = {}
        self._fronts: list[ByTopics | ByAction] = []
        stages = Stages(
            self._configure, self._activate, self._deactivate, self._cleanup, self.close
        )
        self._link = Link("tpvqa_skill_server", stages=stages, sim_time=sim_time)
        self._ended = self._link.now()
        if not managed:
            begin(self._link.node)

    def run(self) -> None:
        """Serve until `close` is called, or Ctrl-C."""
        self._link.start()
        try:
            while not self._over.is_set():
                if self._active:
                    self._show()
                try:
                    job = self._jobs.get(timeout=self._period)
                except queue.Empty:
                    continue
                self._perform(job)
        finally:
            self._robot.stop()
            self._link.close()

    def close(self) -> None:
        """Stop the robot and end; from any thread, or a signal's handler."""
        self._over.set()
        job = self._job
        if job is not None:
            job.cancelled.set()

    def _configure(self) -> None:
        from sensor_msgs.msg import CameraInfo, CompressedImage, Image, JointState
        from std_msgs.msg import Bool, String

        link, prefix = self._link, self._prefix
        self._string: Callable[..., Any] = String
        self._joint_state: Callable[[], Any] = JointState
        self._joints = link.speaker(JointState, f"{prefix}/{wire.JOINTS}", said(1))
        self._true = link.speaker(String, f"{prefix}/{wire.TRUTH}", said(1))
        self._cameras = {
            view: (
                (link.speaker(Image, f"{prefix}/{view}/depth", said(1)), depth_message),
                (link.speaker(CameraInfo, f"{prefix}/{view}/camera_info", said(1)), info_message),
                (link.speaker(CompressedImage, f"{prefix}/{view}/image", said(1)), picture_message),
            )
            for view in self._views
        }
        link.heed(Bool, self._stop_topic, self._hear_stop)
        if typed.built():
            self._fronts.append(ByAction(link, f"{prefix}/{ACTION}", self))
        self._fronts.append(ByTopics(link, prefix, self))
        link.every(wire.BEAT / 2, self._tick)

    def _activate(self) -> None:
        with self._lock:  # what was seen before it is old
            self._ended, self._active = self._link.now(), True

    def _deactivate(self) -> None:
        with self._lock:
            self._active = False
            self._halt()
        self._tick()

    def _cleanup(self) -> None:
        if self._job is not None:
            raise WorldError("a skill is still ending: clean up once it has")
        self._cameras, self._fronts = {}, []
        self._link.clear()

    def _show(self) -> None:
        """Publish what the robot sees and feels now; what nobody hears is not even drawn."""
        for view, camera in self._cameras.items():
            heard = [each for each in camera if each[0].get_subscription_count()]
            if not heard:
                continue
            stamp = self._link.now()
            frame = self._unless_broken(partial(self._look, view))
            for speaker, made_of in heard if frame is not None else ():
                message = made_of(frame, stamp, view)
                if message is not None:
                    speaker.publish(message)
        self._feel()
        stamp = self._link.now()
        if self._truth is not None:
            facts = sorted(atom.pddl() for atom in self._truth())
            text = json.dumps({"stamp": stamp, "facts": facts})
            self._true.publish(self._string(data=text))

    def _look(self, view: str) -> Frame:
        return self._robot.look(view).frames[view]

    def _unless_broken(self, do: Callable[[], T]) -> T | None:
        """What the robot gives; None where it breaks, which must not end its server."""
        try:
            return do()
        except Exception as error:  # noqa: BLE001
            self._link.node.get_logger().error(f"{type(error).__name__}: {error}")
            return None

    def _feel(self) -> None:
        """Publish where the joints are."""
        stamp, felt = self._link.now(), self._unless_broken(self._robot.state)
        if felt is None:
            return
        joints = set_stamp(self._joint_state(), stamp, "")
        joints.name, joints.position = list(felt), [float(x) for x in felt.values()]
        self._joints.publish(joints)

    def _perform(self, job: Job) -> None:
        try:
            done = self._robot.perform(
                job.action,
                deadline=job.deadline,
                cancelled=job.cancelled,
                feedback=job.teller.feedback,
            )
        except Exception as error:  # noqa: BLE001 — a robot that breaks must not end its server
            with self._lock:
                self._halt()  # in a thread of its own: to stop may break as well
            known = isinstance(error, TpvqaError)
            said = str(error) if known else f"the skill broke: {type(error).__name__}: {error}"
            done = Execution(Report.FAILED, monotonic() - job.began, said)
        if done.report is Report.CANCELLED and monotonic() - job.began > job.deadline:
            done = replace(done, report=Report.LATE, message=f"stopped after {job.deadline:g} s")
        with self._lock:
            self._ended, self._job = self._link.now(), None
        job.teller.ended(done, self._ended)

    def beat(self, by: str) -> None:
        """A controller was heard; where nobody has the robot, it has it now."""
        with self._lock:
            if self._lease.expired(monotonic()):
                self._halt()
            self._lease.beat(by, monotonic())

    def release(self, by: str) -> None:
        """A controller gives the robot back; what it had begun is stopped."""
        with self._lock:
            if self._lease.holder == by:
                self._halt()
                self._lease.release(by)

    def cancel(self, by: str | None, name: str) -> None:
        """Stop a skill; `by` is None where the asker is known by its goal alone."""
        with self._lock:
            job = self._job
            if job is not None and job.id == name and by in (None, self._lease.holder):
                job.cancelled.set()

    def do(self, wanted: Wanted, teller: Teller) -> None:
        """Begin a skill, or say why not."""
        with self._lock:
            try:
                job = self._accepted(wanted, teller)
            except (ValueError, PDDLError) as refused:
                teller.refused(str(refused))
                return
            self._job = job
            self._jobs.put(job)

    def _accepted(self, wanted: Wanted, teller: Teller) -> Job:
        """The skill that is asked for, where it may begin.

        Raises:
            ValueError: It may not; says why.
            PDDLError: It is no action of the task.
        """
        if self._stopped:
            raise ValueError(self._stopped)
        if not self._lease.beat(wanted.by, monotonic()):
            raise ValueError(f"the robot is held by another controller, {self._lease.holder}")
        if self._job is not None:
            raise ValueError(f"the robot is still at {self._job.action.pddl()}")
        action, deadline, seen = wanted.action, wanted.deadline, wanted.seen
        if deadline is None or deadline <= 0 or seen is None or action is None:
            raise ValueError("expected action, deadline in seconds and the stamp 'seen'")
        if seen <= self._ended:
            raise ValueError("the picture was taken before the last action ended: look again")
        if seen > self._link.now() + AHEAD:
            raise ValueError("the picture is of the future: see that the clocks agree")
        words = Atom.parse(action)
        ground = self._task.action(words.predicate, words.arguments)
        if ground.name not in self._robot.skills:
            raise ValueError(f"the robot has no skill {ground.name!r}")
        return Job(wanted.id, ground, deadline, teller)

    @property
    def _stopped(self) -> str:
        return self._stop or ("" if self._active else "the skill server is not active")

    def _hear_stop(self, message: Any) -> None:
        with self._lock:
            self._stop = "emergency stop" if message.data else ""
            if message.data:
                self._halt()
        self._tick()

    def _halt(self) -> None:
        """Have the robot stand, whatever its thread is at."""
        if self._job is not None:
            self._job.cancelled.set()
            threading.Thread(target=self._robot.stop, daemon=True).start()

    def _tick(self) -> None:
        with self._lock:
            job, now = self._job, monotonic()
            if self._lease.expired(now):
                self._halt()
                self._lease.holder = None
            if job is not None and now - job.began > job.deadline and not job.cancelled.is_set():
                self._halt()
            running = None if job is None else job.action.pddl()
            stands = Standing(self._me, self._lease.holder, running, self._stopped)
        for front in self._fronts:
            front.stands(stands)
        if job is not None:  # else whoever shows pictures tells them
            self._feel()
