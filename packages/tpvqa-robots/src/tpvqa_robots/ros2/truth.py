"""What a simulated robot says is true, behind a topic: for judges and noise models alone."""

import json
from typing import Any

from tpvqa.errors import WorldError
from tpvqa.pddl import Action, Atom, State, Task
from tpvqa.worlds.earlier_truth import EarlierTruth


class PublishedTruth:
    """The true state as it was last published.

    Args:
        task: The task.
        topic: Where it comes from, for messages.
    """

    def __init__(self, task: Task, topic: str):
        self._task, self._topic = task, topic
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

    def holds(self, atom: Atom) -> bool:
        """Whether a fact is true now."""
        return self._present.holds(atom)

    def visible(self, atom: Atom) -> bool:
        """Pictures show what they show; nothing is said to be out of sight."""
        return True

    def possible(self, action: Action) -> bool:
        """Whether all preconditions of an action hold now."""
        return self._present.possible(action)

    def successful(self, action: Action) -> bool:
        """Whether all effects of an action hold now."""
        return self._present.successful(action)

    def scene(self) -> str:
        """A fingerprint of the true state."""
        return self._present.scene()

    @property
    def _present(self) -> EarlierTruth:
        if self.state is None:
            raise WorldError(f"Nothing has come on {self._topic}, which is to tell what is true.")
        return EarlierTruth(self._task, self.state, self.visible)
