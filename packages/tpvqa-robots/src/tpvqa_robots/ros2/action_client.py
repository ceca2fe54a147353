"""The loop's side of a skill server that offers the action `tpvqa_interfaces/ExecuteSkill`.

The server may be anybody's, in plain rclpy or rclcpp. Where it says how it stands (ACTION/server),
it is watched by that; where it does not, by whether its action is there.
"""

import math
import threading
from collections.abc import Callable
from time import monotonic
from typing import Any

from tpvqa.worlds import Report
from tpvqa_robots.ros2 import typed, wire
from tpvqa_robots.ros2.client import Doing
from tpvqa_robots.ros2.link import Link, said
from tpvqa_robots.ros2.peers import Peers

SILENT = "the skill server refused, and its action does not say why"


class ActionClient:
    """Speaks with the server of an action.

    Args:
        link: The node.
        action: The action's name.
        changed: Notified when something was heard.
        gone: Seconds after which a server that is not heard, or does not take a goal, is gone.
        me: The controller's name, the same for all servers of a loop.

    Raises:
        TpvqaError: The messages are not built.
    """

    def __init__(self, link: Link, action: str, changed: threading.Condition, gone: float, me: str):
        typed.see_built(f"The action {action}")
        from action_msgs.msg import GoalStatus
        from rclpy.action import ActionClient as Asking
        from tpvqa_interfaces.action import ExecuteSkill
        from tpvqa_interfaces.msg import Controller, SkillServer

        self.prefix, self._changed, self._gone, self._link = action, changed, gone, link
        self._kind: Any = ExecuteSkill
        self._beat: Callable[..., Any] = Controller
        self._statuses = {
            GoalStatus.STATUS_SUCCEEDED: (Report.DONE,),
            GoalStatus.STATUS_CANCELED: (Report.CANCELLED, Report.LATE, Report.FAILED),
            GoalStatus.STATUS_ABORTED: tuple(each for each in Report if each is not Report.DONE),
        }
        self.me = me
        self._peers = Peers(self.me, monotonic())
        self._standing: Any = None
        self._heard = -1e9
        self._offered: tuple[str, ...] = ()
        self._ready, self._speaks = False, False
        self._goal: tuple[Doing, Any] | None = None
        self._asking = Asking(link.node, ExecuteSkill, action)
        self._speaker = link.speaker(Controller, f"{action}/{typed.CONTROLLER}", said())
        link.listen(Controller, f"{action}/{typed.CONTROLLER}", self._hear_other, said())
        link.listen(SkillServer, f"{action}/{typed.SERVER}", self._hear_server, said())
        link.every(wire.BEAT, self._tick)

    @property
    def there(self) -> bool:
        """Whether the server is there; one that says how it stands, once that has been heard."""
        if self._standing is not None:
            return self._ready and monotonic() - self._heard <= self._gone
        return self._ready and len(self._offered) == 1 and not self._speaks

    @property
    def holds(self) -> bool:
        """Whether this controller has the robot."""
        return self.there and self.holder == self.me

    @property
    def server(self) -> str | None:
        """Which server it is: another after every start."""
        if self._standing is not None:
            return str(self._standing.server)
        return "+".join(self._offered) or None

    @property
    def holder(self) -> str | None:
        """Who has the robot: as the server says, else as loops say among each other."""
        if self._standing is not None:
            return self._standing.holder or None
        return self._peers.holder(monotonic())

    @property
    def busy(self) -> str | None:
        """What the server is at."""
        if self._standing is not None:
            return self._standing.running or None
        doing = None if self._goal is None else self._goal[0]
        return doing.id if doing is not None and not doing.over and self._same(doing) else None

    @property
    def stopped(self) -> str:
        """Why the server does nothing; empty where it would."""
        if self._standing is None or monotonic() - self._heard > self._gone:
            return ""
        return str(self._standing.stopped)

    def do(self, action: str, deadline: float, seen: float) -> Doing:
        """Ask for a skill."""
        doing = Doing(action, self.server or "", taken_by=monotonic() + self._gone)
        goal = self._kind.Goal(action=action, deadline=float(deadline), controller=self.me)
        typed.stamped(goal.seen, seen)

        def feedback(message: Any) -> None:
            self._tell(lambda: doing.feedback.append(message.feedback.message))

        def answered(future: Any) -> None:
            handle = future.result()
            if not handle.accepted:
                self._tell(lambda: setattr(doing, "refused", SILENT))
                return
            self._goal = (doing, handle)
            handle.get_result_async().add_done_callback(ended)
            doing.taken_by = math.inf
            if doing.cancelled:
                handle.cancel_goal_async()

        def ended(future: Any) -> None:
            self._tell(lambda: self._ended(doing, future.result()))

        self._asking.send_goal_async(goal, feedback_callback=feedback).add_done_callback(answered)
        return doing

    def cancel(self, doing: Doing) -> None:
        """Have a skill stopped; one that is not taken yet, as soon as it is."""
        doing.cancelled = True
        if self._goal is not None and self._goal[0] is doing:
            self._goal[1].cancel_goal_async()

    def release(self) -> None:
        """Give the robot back; what is still running is stopped."""
        if self._goal is not None and not self._goal[0].over:
            self.cancel(self._goal[0])
        self._speaker.publish(self._beat(id=self.me, release=True))

    def _same(self, doing: Doing) -> bool:
        return doing.server == self.server

    def _ended(self, doing: Doing, came: Any) -> None:
        """Take a result; one that does not fit how the goal ended is none."""
        result = typed.result_of(came.result, self._link.now())
        fits = result is not None and result.report in self._statuses.get(came.status, ())
        doing.result = result if fits else None
        doing.malformed = not fits

    def _tell(self, what: Callable[[], Any]) -> None:
        with self._changed:
            what()
            self._changed.notify_all()

    def _tick(self) -> None:
        """Say who commands, and see who offers the action."""
        status = f"{self.prefix}/_action/status"
        offering = self._link.node.get_publishers_info_by_topic(status)
        speaking = self._link.node.get_publishers_info_by_topic(f"{self.prefix}/{typed.SERVER}")
        ready = self._asking.server_is_ready()
        loops = self._link.node.get_publishers_info_by_topic(f"{self.prefix}/{typed.CONTROLLER}")
        self._peers.found({bytes(each.endpoint_gid).hex() for each in loops}, ready, monotonic())
        holder = self.holder
        self._speaker.publish(self._beat(id=self.me, holds=holder == self.me, release=False))
        with self._changed:
            self._offered = tuple(sorted(bytes(each.endpoint_gid).hex() for each in offering))
            self._ready, self._speaks = ready, bool(speaking)
            if not self._offered:
                self._standing = None
            self._changed.notify_all()

    def _hear_other(self, message: Any) -> None:
        self._peers.hear(message.id, monotonic(), holds=message.holds, release=message.release)

    def _hear_server(self, message: Any) -> None:
        with self._changed:
            self._standing, self._heard = message, monotonic()
            self._changed.notify_all()
