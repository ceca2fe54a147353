"""What a monitor declares of itself, or has besides; and the one place that asks."""

from typing import TYPE_CHECKING, Protocol, runtime_checkable

from tpvqa.plugins import class_of
from tpvqa.questions import QuestionBook

if TYPE_CHECKING:
    from tpvqa.belief.learning.experience import Experience
    from tpvqa.monitors.protocol import Check


class NeverAsks:
    """Declares that a monitor asks nothing: then no VLM needs to be there."""


class AsksActions:
    """Declares that a monitor asks about whole actions, not about facts."""


@runtime_checkable
class Learning(Protocol):
    """A monitor that learns from trial to trial."""

    @property
    def experience(self) -> "Experience | None":
        """What is known now, for the next trial; None where nothing is learned."""


@runtime_checkable
class LooksFirst(Protocol):
    """A monitor that looks before there is a plan where it is not sure how the world is."""

    @property
    def unsure(self) -> bool:
        """Whether it is not."""

    def first(self, book: QuestionBook) -> "Check":
        """A check whose verdict says what is believed, and may bring the first plan."""


@runtime_checkable
class Believing(Protocol):
    """A monitor that knows how probable it is that the goal holds."""

    @property
    def goal_probability(self) -> float:
        """That, now."""


def never_asks(monitor: object) -> bool:
    """Whether a monitor, or a class of monitors, asks nothing."""
    return issubclass(class_of(monitor), NeverAsks)


def asks_actions(monitor: object) -> bool:
    """Whether a monitor, or a class of monitors, asks about whole actions."""
    return issubclass(class_of(monitor), AsksActions)


def experience_of(monitor: object) -> "Experience | None":
    """What a monitor has learned; None for one that learns nothing."""
    return monitor.experience if isinstance(monitor, Learning) else None


def goal_probability_of(monitor: object) -> float | None:
    """How probable a monitor takes it to be that the goal holds; None for one that does not say."""
    return monitor.goal_probability if isinstance(monitor, Believing) else None
