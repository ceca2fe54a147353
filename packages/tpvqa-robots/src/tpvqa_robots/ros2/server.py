"""The skill server: offers a `Robot` on topics, to one controller at a time.

The robot is moved and looked at by one thread alone, that of `run`; what is heard meanwhile cancels
and stops it from the node's thread.
"""

import json
import queue
import threading
import uuid
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from time import monotonic
from typing import Any

from tpvqa.errors import PDDLError, TpvqaError
from tpvqa.pddl import Action, Atom, State, Task
from tpvqa.worlds import Execution, Report
from tpvqa_robots.ros2 import wire
from tpvqa_robots.ros2.lease import Lease
from tpvqa_robots.ros2.link import Link, said
from tpvqa_robots.ros2.pictures import messages_of, set_stamp
from tpvqa_robots.skills.protocol import Robot


@dataclass
class Job:
    """A skill that is asked for."""

    id: str
    action: Action
    deadline: float
    cancelled: threading.Event = field(default_factory=threading.Event)
    began: float = field(default_factory=monotonic)


class SkillServer:
    """Offers a robot on PREFIX/command, PREFIX/status, PREFIX/VIEW/… and PREFIX/joints.

    Args:
        robot: The robot.
        task: Names its actions.
        views: Its cameras.
        prefix: Of the topics.
        stop: The topic of emergency stops.
        rate: Pictures a second and camera.
        truth: Tells the true state, where the robot is simulated.

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
    ):
        self._robot, self._task, self._views, self._truth = robot, task, views, truth
        self._period = 1 / rate
        self._link = link = Link("tpvqa_skill_server")
        from sensor_msgs.msg import CameraInfo, CompressedImage, Image, JointState
        from std_msgs.msg import Bool, String

        self._string: Callable[..., Any] = String
        self._joint_state: Callable[[], Any] = JointState
        self._me, self._lease = f"server-{uuid.uuid4().hex[:12]}", Lease()
        self._jobs: queue.Queue[Job] = queue.Queue()
        self._job: Job | None = None
        self._ids: set[str] = set()
        self._ended, self._stop, self._over = link.now(), "", threading.Event()
        self._lock = threading.RLock()
        self._status = link.speaker(String, f"{prefix}/{wire.STATUS}", said())
        self._joints = link.speaker(JointState, f"{prefix}/{wire.JOINTS}", said(1))
        self._true = link.speaker(String, f"{prefix}/{wire.TRUTH}", said(1))
        self._cameras: Mapping[str, tuple[Any, Any, Any]] = {
            view: (
                link.speaker(CompressedImage, f"{prefix}/{view}/image", said(1)),
                link.speaker(Image, f"{prefix}/{view}/depth", said(1)),
                link.speaker(CameraInfo, f"{prefix}/{view}/camera_info", said(1)),
            )
            for view in views
        }
        link.listen(String, f"{prefix}/{wire.COMMAND}", self._hear, said())
        link.listen(Bool, stop, self._hear_stop, said())
        link.every(wire.BEAT / 2, self._tick)

    def run(self) -> None:
        """Serve until `close` is called, or Ctrl-C."""
        self._link.start()
        try:
            while not self._over.is_set():
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

    def _show(self) -> None:
        """Publish what the robot sees and feels now."""
        for view, (pictures, depths, infos) in self._cameras.items():
            stamp = self._link.now()
            frame = self._robot.look(view).frames[view]
            picture, depth, info = messages_of(frame, stamp, view)
            for speaker, message in ((depths, depth), (infos, info), (pictures, picture)):
                if message is not None:
                    speaker.publish(message)
        stamp, felt = self._link.now(), self._robot.state()
        joints = set_stamp(self._joint_state(), stamp, "")
        joints.name, joints.position = list(felt), [float(x) for x in felt.values()]
        self._joints.publish(joints)
        if self._truth is not None:
            facts = sorted(atom.pddl() for atom in self._truth())
            text = json.dumps({"stamp": stamp, "facts": facts})
            self._true.publish(self._string(data=text))

    def _perform(self, job: Job) -> None:
        try:
            done = self._robot.perform(
                job.action,
                deadline=job.deadline,
                cancelled=job.cancelled,
                feedback=lambda told: self._say("feedback", id=job.id, message=told),
            )
        except TpvqaError as error:
            done = Execution(Report.FAILED, monotonic() - job.began, str(error))
        if done.report is Report.CANCELLED and monotonic() - job.began > job.deadline:
            done = replace(done, report=Report.LATE, message=f"stopped after {job.deadline:g} s")
        with self._lock:
            self._ended, self._job = self._link.now(), None
        self._say(
            "result",
            id=job.id,
            report=done.report.value,
            seconds=float(done.seconds),
            message=done.message,
            facts=wire.written(done.facts),
            ended=self._ended,
        )

    def _hear(self, message: Any) -> None:
        heard = wire.read(message.data)
        by = None if heard is None else wire.text_of(heard, "from")
        if heard is None or by is None:
            return
        with self._lock:
            match heard["say"]:
                case "beat":
                    if self._lease.expired(monotonic()):
                        self._halt()
                    self._lease.beat(by, monotonic())
                case "release" if self._lease.holder == by:
                    self._halt()
                    self._lease.release(by)
                case "cancel" if self._lease.holder == by and self._job is not None:
                    if wire.text_of(heard, "id") == self._job.id:
                        self._job.cancelled.set()
                case "do":
                    self._do(by, heard)

    def _do(self, by: str, heard: wire.Said) -> None:
        name = wire.text_of(heard, "id")
        if name is None or name in self._ids:
            return
        try:
            job = self._accepted(by, name, heard)
        except (ValueError, PDDLError) as refused:
            self._say("refused", id=name, message=str(refused))
            return
        self._ids.add(name)
        self._job = job
        self._jobs.put(job)

    def _accepted(self, by: str, name: str, heard: wire.Said) -> Job:
        """The skill that is asked for, where it may begin.

        Raises:
            ValueError: It may not; says why.
            PDDLError: It is no action of the task.
        """
        if self._stop:
            raise ValueError(self._stop)
        if not self._lease.beat(by, monotonic()):
            raise ValueError(f"the robot is held by another controller, {self._lease.holder}")
        if self._job is not None:
            raise ValueError(f"the robot is still at {self._job.action.pddl()}")
        deadline, seen = wire.number_of(heard, "deadline"), wire.number_of(heard, "seen")
        action = wire.text_of(heard, "action")
        if deadline is None or deadline <= 0 or seen is None or action is None:
            raise ValueError("expected action, deadline in seconds and the stamp 'seen'")
        if seen <= self._ended:
            raise ValueError("the picture was taken before the last action ended: look again")
        words = Atom.parse(action)
        ground = self._task.action(words.predicate, words.arguments)
        if ground.name not in self._robot.skills:
            raise ValueError(f"the robot has no skill {ground.name!r}")
        return Job(name, ground, deadline)

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
            holder, stopped = self._lease.holder, self._stop
        running = None if job is None else job.action.pddl()
        self._say("alive", server=self._me, holder=holder, running=running, stopped=stopped)

    def _say(self, what: str, **values: Any) -> None:
        self._status.publish(self._string(data=wire.write(what, **values)))
