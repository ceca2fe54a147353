"""What a picture is got for: an action of a task's plan, and its success or failure."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from tpvqa.pddl import State
from tpvqa_household.images.manifest import OUTCOMES, Shows
from tpvqa_household.images.reachable import Reachable, say_kind
from tpvqa_household.images.visible import VisibleState


@dataclass(frozen=True)
class Label:
    """An action and outcome that pictures are wanted of.

    Attributes:
        shows: The task, the action and the outcome.
        state: What is true then, unless a photo's label says otherwise: after a success, the next
            state of the plan; after a failure, the state as it was.
        possible: Everything that can be seen then, whatever was disturbed.
    """

    shows: Shows
    state: State = field(repr=False)
    possible: frozenset[VisibleState] = field(repr=False)

    def __str__(self) -> str:
        return f"{self.shows.task}: {self.shows.action}, {self.shows.outcome}"

    @property
    def slug(self) -> str:
        """As a part of a file's name: `clean_dishes-wash_plate_sink-failure`."""
        return f"{self.shows.task}-{file_name(self.shows.action)}-{self.shows.outcome}"


def file_name(action: str) -> str:
    """An action in characters that every file system knows: `wash_plate_sink`."""
    return re.sub(r"[^a-z0-9]+", "_", action.lower()).strip("_")


def labels(tasks: Sequence[Reachable]) -> list[Label]:
    """Every action of the tasks' plans with both outcomes, in the plans' order."""
    found: dict[Shows, Label] = {}
    for task in tasks:
        for step, kind in enumerate(task.nominal):
            for outcome in OUTCOMES:
                succeeded = outcome == "success"
                shows = Shows(task=task.task, action=say_kind(kind), outcome=outcome)
                possible = task.after_success(kind) if succeeded else task.after_failure(kind)
                state = task.path[step + 1 if succeeded else step]
                found.setdefault(shows, Label(shows, state, possible))
    return list(found.values())
