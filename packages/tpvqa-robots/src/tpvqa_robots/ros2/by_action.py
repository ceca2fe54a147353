"""A skill server's commands as a ROS 2 action, `tpvqa_interfaces/ExecuteSkill`."""

from threading import Event
from typing import Any

from tpvqa.worlds import Execution, Report
from tpvqa_robots.ros2 import typed
from tpvqa_robots.ros2.job import Commands, Standing, Wanted
from tpvqa_robots.ros2.link import Link, said

SETTLES = 1.0
"""Seconds that a result has to be sent before the node may end."""


class ByAction:
    """Offers an action, hears its controllers and says how the server stands.

    A goal is always accepted: a rejected one could not say why. One that may not begin is aborted,
    with the reason in its result.

    Args:
        link: The server's node.
        action: Its name.
        server: Does what is asked.
    """

    def __init__(self, link: Link, action: str, server: Commands):
        from rclpy.action import ActionServer, CancelResponse, GoalResponse
        from tpvqa_interfaces.action import ExecuteSkill
        from tpvqa_interfaces.msg import Controller, SkillServer

        self._link, self._server = link, server
        self._kind: Any = SkillServer
        self._goal: Any = ExecuteSkill
        self._standing = link.speaker(SkillServer, f"{action}/{typed.SERVER}", said())
        link.listen(Controller, f"{action}/{typed.CONTROLLER}", self._hear, said())

        def cancel(handle: Any) -> Any:
            server.cancel(None, _name(handle))
            return CancelResponse.ACCEPT

        made = ActionServer(
            link.node,
            ExecuteSkill,
            action,
            execute_callback=lambda _: ExecuteSkill.Result(),
            goal_callback=lambda _: GoalResponse.ACCEPT,
            handle_accepted_callback=self._accepted,
            cancel_callback=cancel,
        )
        link.keep(made.destroy)

    def stands(self, now: Standing) -> None:
        """Say how the server stands."""
        self._standing.publish(
            self._kind(
                server=now.server,
                holder=now.holder or "",
                running=now.running or "",
                stopped=now.stopped,
            )
        )

    def _hear(self, message: Any) -> None:
        if message.id and message.release:
            self._server.release(message.id)
        elif message.id:
            self._server.beat(message.id)

    def _accepted(self, handle: Any) -> None:
        """Begin it. The goal counts as executed when it ends: rclpy's own way would keep the node's
        only thread for as long as the robot moves."""
        goal, told = handle.request, _Told(handle, self._goal, self._link)
        if not goal.controller:
            told.refused("a goal has to say which controller it is from")
            return
        deadline = typed.finite(goal.deadline)
        seen = typed.seconds_of(goal.seen)
        wanted = Wanted(goal.controller, _name(handle), goal.action or None, deadline, seen)
        self._server.do(wanted, told)


def _name(handle: Any) -> str:
    return bytes(handle.goal_id.uuid).hex()


class _Told:
    """Tells of one goal."""

    def __init__(self, handle: Any, goal: Any, link: Link):
        self._handle, self._goal, self._link = handle, goal, link

    def feedback(self, message: str) -> None:
        self._handle.publish_feedback(self._goal.Feedback(message=message))

    def refused(self, why: str) -> None:
        self._finish(Execution(Report.UNAVAILABLE, 0.0, why), self._link.now())

    def ended(self, done: Execution, at: float) -> None:
        self._finish(done, at).wait(SETTLES)

    def _finish(self, done: Execution, at: float) -> Event:
        sent, result = Event(), typed.result_message(self._goal.Result(), done, at)

        def finish(handle: Any) -> Any:
            if done.report is Report.DONE:
                handle.succeed()
            elif handle.is_cancel_requested:
                handle.canceled()
            else:
                handle.abort()
            sent.set()
            return result

        self._handle.execute(finish)
        return sent
