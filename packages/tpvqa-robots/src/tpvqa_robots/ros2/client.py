"""The loop's side of a skill server: one controller that holds it, and has skills done."""

import math
import threading
import uuid
from collections.abc import Callable
from dataclasses import dataclass, field
from time import monotonic
from typing import Any, Protocol

from tpvqa_robots.ros2 import wire
from tpvqa_robots.ros2.link import Link, said


@dataclass
class Doing:
    """A skill that was asked for, and what has been heard of it.

    Attributes:
        id: Of what was asked.
        server: Who was asked.
        result: How it ended.
        refused: Why it was not begun.
        malformed: Whether it ended in a way that is not understood.
        feedback: What the robot was about.
        cancelled: Whether it is to be stopped.
        taken_by: When the server has to have taken it, by `time.monotonic`.
    """

    id: str
    server: str
    result: wire.Result | None = None
    refused: str = ""
    malformed: bool = False
    feedback: list[str] = field(default_factory=list)
    cancelled: bool = False
    taken_by: float = math.inf

    @property
    def over(self) -> bool:
        """Whether the server has said how it ended."""
        return self.result is not None or bool(self.refused) or self.malformed

    @property
    def untaken(self) -> bool:
        """Whether the server did not take it in time."""
        return monotonic() > self.taken_by


class Client(Protocol):
    """Whoever has a robot's skills done, by topics or by an action.

    Attributes:
        prefix: What the server's topics, or its action, are called.
        me: What this controller is called.
    """

    prefix: str
    me: str

    @property
    def there(self) -> bool:
        """Whether the server is there."""

    @property
    def holds(self) -> bool:
        """Whether this controller has the robot."""

    @property
    def server(self) -> str | None:
        """Which server it is: another after every start."""

    @property
    def holder(self) -> str | None:
        """Who has the robot."""

    @property
    def busy(self) -> str | None:
        """What the server is at."""

    @property
    def stopped(self) -> str:
        """Why the server does nothing; empty where it would."""

    def do(self, action: str, deadline: float, seen: float) -> Doing:
        """Ask for a skill; what comes of it is told in what is returned.

        Args:
            action: As PDDL writes it.
            deadline: Seconds that it has.
            seen: The stamp of the latest picture that was looked at.
        """

    def cancel(self, doing: Doing) -> None:
        """Have a skill stopped."""

    def release(self) -> None:
        """Give the robot back; what is still running is stopped."""


class TopicClient:
    """Speaks with the skill server of a prefix, in JSON on two topics.

    Args:
        link: The node.
        prefix: Of the server's topics.
        changed: Notified when something was heard.
        gone: Seconds after which a server that is not heard is gone.
        me: The controller's name, the same for all servers of a loop.
    """

    def __init__(self, link: Link, prefix: str, changed: threading.Condition, gone: float, me: str):
        from std_msgs.msg import String

        self.prefix, self._changed, self._gone = prefix, changed, gone
        self._string: Callable[..., Any] = String
        self.me = me
        self.server: str | None = None
        self.holder: str | None = None
        self.stopped = ""
        self.busy: str | None = None
        self._heard = -1e9
        self._doing: Doing | None = None
        self._speaker = link.speaker(String, f"{prefix}/{wire.COMMAND}", said())
        link.listen(String, f"{prefix}/{wire.STATUS}", self._hear, said())
        link.every(wire.BEAT, lambda: self._say("beat"))

    @property
    def there(self) -> bool:
        """Whether the server is heard."""
        return monotonic() - self._heard <= self._gone

    @property
    def holds(self) -> bool:
        """Whether this controller has the robot."""
        return self.there and self.holder == self.me

    def do(self, action: str, deadline: float, seen: float) -> Doing:
        """Ask for a skill."""
        doing = self._doing = Doing(uuid.uuid4().hex, self.server or "")
        self._say("do", id=doing.id, action=action, deadline=deadline, seen=seen)
        return doing

    def cancel(self, doing: Doing) -> None:
        """Have a skill stopped."""
        self._say("cancel", id=doing.id)

    def release(self) -> None:
        """Give the robot back; what is still running is stopped."""
        if self.there:
            self._say("release")

    def _say(self, what: str, **values: Any) -> None:
        self._speaker.publish(self._string(data=wire.write(what, **{"from": self.me}, **values)))

    def _hear(self, message: Any) -> None:
        heard = wire.read(message.data)
        if heard is None:
            return
        with self._changed:
            if heard["say"] == "alive":
                self._heard = monotonic()
                self.server = wire.text_of(heard, "server")
                self.holder = wire.text_of(heard, "holder")
                self.busy = wire.text_of(heard, "running")
                self.stopped = wire.text_of(heard, "stopped") or ""
            elif self._doing is not None and heard.get("id") == self._doing.id:
                self._told(self._doing, heard)
            self._changed.notify_all()

    def _told(self, doing: Doing, heard: wire.Said) -> None:
        match heard["say"]:
            case "feedback":
                doing.feedback.append(wire.text_of(heard, "message") or "")
            case "refused":
                doing.refused = wire.text_of(heard, "message") or "the skill server refused"
            case "result":
                doing.result = wire.result_of(heard)
                doing.malformed = doing.result is None


def new_name() -> str:
    """What a loop calls itself."""
    return f"loop-{uuid.uuid4().hex[:12]}"
