"""A skill server's commands as JSON on two topics: nothing has to be built for it."""

from collections.abc import Callable
from typing import Any

from tpvqa.worlds import Execution
from tpvqa_robots.ros2 import wire
from tpvqa_robots.ros2.job import Commands, Standing, Wanted
from tpvqa_robots.ros2.link import Link, said


class ByTopics:
    """Hears PREFIX/command and speaks on PREFIX/status.

    Args:
        link: The server's node.
        prefix: Of the topics.
        server: Does what is asked.
    """

    def __init__(self, link: Link, prefix: str, server: Commands):
        from std_msgs.msg import String

        self._string: Callable[..., Any] = String
        self._server, self._ids = server, set[str]()
        self._status = link.speaker(String, f"{prefix}/{wire.STATUS}", said())
        link.listen(String, f"{prefix}/{wire.COMMAND}", self._hear, said())

    def stands(self, now: Standing) -> None:
        """Say how the server stands."""
        self.say(
            "alive",
            server=now.server,
            holder=now.holder,
            running=now.running,
            stopped=now.stopped,
        )

    def say(self, what: str, **values: Any) -> None:
        """Speak."""
        self._status.publish(self._string(data=wire.write(what, **values)))

    def _hear(self, message: Any) -> None:
        heard = wire.read(message.data)
        by = None if heard is None else wire.text_of(heard, "from")
        if heard is None or by is None:
            return
        name = wire.text_of(heard, "id")
        match heard["say"]:
            case "beat":
                self._server.beat(by)
            case "release":
                self._server.release(by)
            case "cancel" if name is not None:
                self._server.cancel(by, name)
            case "do" if name is not None and name not in self._ids:
                self._ids.add(name)
                deadline, seen = wire.number_of(heard, "deadline"), wire.number_of(heard, "seen")
                action = wire.text_of(heard, "action")
                self._server.do(Wanted(by, name, action, deadline, seen), _Told(self, name))


class _Told:
    """Tells of one skill."""

    def __init__(self, topics: ByTopics, name: str):
        self._topics, self._id = topics, name

    def feedback(self, message: str) -> None:
        self._topics.say("feedback", id=self._id, message=message)

    def refused(self, why: str) -> None:
        self._topics.say("refused", id=self._id, message=why)

    def ended(self, done: Execution, at: float) -> None:
        self._topics.say(
            "result",
            id=self._id,
            report=done.report.value,
            seconds=float(done.seconds),
            message=done.message,
            facts=wire.written(done.facts),
            ended=at,
        )
