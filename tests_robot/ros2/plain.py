"""Somebody else's robot: the action ExecuteSkill, a camera and joints in plain rclpy.

Nothing of tpvqa's ROS 2 side is used, and nothing said but the action. What the arm does is that of
the stand-in.
"""

import argparse
import contextlib
import signal
import threading
from pathlib import Path
from typing import Any

import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import CompressedImage, JointState
from std_msgs.msg import String
from tpvqa_interfaces.action import ExecuteSkill
from tpvqa_interfaces.msg import Fact

from tests_robot.ros2.standin import StandIn
from tpvqa import load_task
from tpvqa.tasks import find_task

NUMBERS = {"done": ExecuteSkill.Result.DONE, "cancelled": ExecuteSkill.Result.CANCELLED}


class PlainServer(Node):  # type: ignore[misc]
    def __init__(self, robot: StandIn):
        super().__init__("somebody_elses_arm")
        self.robot, self.busy = robot, False
        self.action = ActionServer(
            self,
            ExecuteSkill,
            "/arm/do",
            self.execute,
            goal_callback=self.wanted,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
            callback_group=ReentrantCallbackGroup(),
        )
        self.pictures = self.create_publisher(CompressedImage, "/arm/image", 1)
        self.joints = self.create_publisher(JointState, "/arm/joints", 1)
        self.true = self.create_publisher(String, "/arm/truth", 1)
        self.create_timer(0.05, self.show)

    def wanted(self, _: Any) -> Any:
        return GoalResponse.REJECT if self.busy else GoalResponse.ACCEPT

    def execute(self, handle: Any) -> Any:
        self.busy = True
        words = handle.request.action.strip("()").split()
        stopped = threading.Event()

        def feedback(text: str) -> None:
            handle.publish_feedback(ExecuteSkill.Feedback(message=text))

        def watch() -> None:
            if handle.is_cancel_requested:
                stopped.set()

        timer = self.create_timer(0.01, watch, ReentrantCallbackGroup())
        done = self.robot.perform(
            self.robot.task.action(words[0], words[1:]),
            deadline=handle.request.deadline,
            cancelled=stopped,
            feedback=feedback,
        )
        self.destroy_timer(timer)
        result = ExecuteSkill.Result(report=NUMBERS[done.report.value], seconds=done.seconds)
        if "unset" in self.robot.faults:
            result.report = ExecuteSkill.Result.UNSET
        for fact in done.facts:
            result.facts.append(Fact(fact=fact.atom.pddl(), probability=fact.probability))
        (handle.canceled if handle.is_cancel_requested else handle.succeed)()
        self.busy = False
        return result

    def show(self) -> None:
        stamp = self.get_clock().now().to_msg()
        picture = CompressedImage(format="png")
        picture.header.stamp, picture.header.frame_id = stamp, "eye"
        picture.data = self.robot.look("overhead").frames["overhead"].data
        self.pictures.publish(picture)
        joints = JointState(name=list(self.robot.state()), position=[*self.robot.state().values()])
        joints.header.stamp = stamp
        self.joints.publish(joints)
        facts = ", ".join(f'"{atom.pddl()}"' for atom in self.robot.true())
        seconds = stamp.sec + stamp.nanosec / 1e9
        self.true.publish(String(data=f'{{"stamp": {seconds}, "facts": [{facts}]}}'))


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("file", type=Path)
    parser.add_argument("--fault", action="append", default=[])
    parser.add_argument("--seconds", type=float, default=0.05)
    said = parser.parse_args()
    files = find_task("collect_toys")
    task = load_task(files.domain, files.problem)
    rclpy.init()
    signal.signal(signal.SIGTERM, lambda *_: rclpy.try_shutdown())
    executor = MultiThreadedExecutor(4)
    executor.add_node(PlainServer(StandIn(task, said.file, set(said.fault), said.seconds)))
    print("ready", flush=True)
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


if __name__ == "__main__":
    main()
