"""The loop's side of a skill server: one controller that holds it, and has skills done."""

import threading
import uuid
from collections.abc import Callable
from dataclasses import dataclass, field
from time import monotonic
from typing import Any

from tpvqa_robots.ros2 import wire
from tpvqa_robots.ros2.link import Link, said


@dataclass
class Doing:
    """A skill that was asked for, and what has been heard of it."""

    id: str
    server: str
    result: wire.Result | None = None
    refused: str = ""
    malformed: bool = False
    feedback: list[str] = field(default_factory=list)


class SkillClient:
    """Speaks with the skill server of a prefix.

    Args:
        link: The node.
        prefix: Of the server's topics.
        changed: Notified when something was heard.
        gone: Seconds after which a server that is not heard is gone.
    """

    def __init__(self, link: Link, prefix: str, changed: threading.Condition, gone: float):
        from std_msgs.msg import String

        self.prefix, self._changed, self._gone = prefix, changed, gone
        self._string: Callable[..., Any] = String
        self.me = f"loop-{uuid.uuid4().hex[:12]}"
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
        """Ask for a skill; what comes of it is told in what is returned.

        Args:
            action: As PDDL writes it.
            deadline: Seconds that it has.
            seen: The stamp of the latest picture that was looked at.
        """
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
