"""What a simulated robot says is true, behind a topic: for judges and noise models alone."""

import json
from typing import Any

from tpvqa.errors import WorldError
from tpvqa.pddl import Atom, State, Task
from tpvqa_robots.truth import PresentTruth


class PublishedTruth(PresentTruth):
    """The true state as it was last published.

    Args:
        task: The task.
        topic: Where it comes from, for messages.
    """

    def __init__(self, task: Task, topic: str):
        super().__init__(task, self._told)
        self._topic = topic
        self.state: State | None = None
        self.stamp = 0.0

    def hear(self, message: Any) -> None:
        """A message of the topic; what is malformed is left out."""
        try:
            said = json.loads(message.data)
            state = frozenset(Atom.parse(text) for text in said["facts"])
            stamp = float(said["stamp"])
        except (ValueError, TypeError, KeyError, AttributeError):
            return
        self.state, self.stamp = state, stamp

    def _told(self) -> State:
        if self.state is None:
            raise WorldError(f"Nothing has come on {self._topic}, which is to tell what is true.")
        return self.state
