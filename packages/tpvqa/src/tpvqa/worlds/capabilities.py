"""What a world can do besides acting and looking, and the one place that asks whether it can.

A world has a capability by having all of its members, but for `Simulated`, `Pictureless` and
`Noiseless`, which a class declares by deriving from them: what they say is known before a world
is made.
"""

from collections.abc import Collection, Mapping
from threading import Event
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from tpvqa.errors import WorldError
from tpvqa.pddl.arithmetic import VALUE
from tpvqa.plugins import class_of
from tpvqa.vlm import TruthSource
from tpvqa.worlds.outcome import Outcome

if TYPE_CHECKING:
    from tpvqa.pddl import Action, State, Task
    from tpvqa.worlds.simulation import Simulation


@runtime_checkable
class Restorable(Protocol):
    """It can be put back into an earlier state, so that an episode can be resumed."""

    def snapshot(self) -> Mapping[str, Any]:
        """The whole state as plain JSON values."""

    def restore(self, snapshot: Mapping[str, Any]) -> None:
        """Put back what `snapshot` gave."""


@runtime_checkable
class Judged(Protocol):
    """It knows what is true in it: for judges and noise models, and for nothing else."""

    @property
    def truth(self) -> TruthSource:
        """What is true now."""


@runtime_checkable
class Telling(Protocol):
    """It knows what truly came of its actions."""

    @property
    def last_outcome(self) -> Outcome | None:
        """What came of the last action that happened; None before the first."""


@runtime_checkable
class Sensing(Protocol):
    """It says beforehand what the robot senses itself, so that decisions can count on it."""

    def senses(self) -> Collection[str]:
        """The predicates of the facts that `execute` or `observe` tell of."""


@runtime_checkable
class Timed(Protocol):
    """It has a clock by which actions last: it can begin one, go on, and end it later.

    Of a durative action `heat` it executes `start-heat`, which begins it and comes back at once,
    `end-heat`, which comes back when it has ended, and `cancel-heat`, which stops it;
    `while-heat` is nothing but a look that was due.
    """

    def wait(self, until: float | None, *, cancel: Event | None = None) -> float:
        """Let time pass, and tell what the clock shows then.

        Args:
            until: What it is to show; None for no time at all, as where it shows more already.
            cancel: Set from another thread to stop waiting.
        """


@runtime_checkable
class Halting(Protocol):
    """Somebody may stop it, whatever the trial is about: looks, questions and plans end, too."""

    def halted(self) -> str:
        """Why it stands still, and where things are; empty where nobody stopped it."""


@runtime_checkable
class Bounded(Protocol):
    """It knows beforehand which actions it will not do at all, as what leaves the workspace.

    Plans are made without them. `execute` refuses them all the same: not all that is done is of a
    plan.
    """

    def refuses(self, action: "Action") -> str:
        """Why it will not do an action, the same of each always; empty where it will."""


class Simulated:
    """Declares that a world is simulated: it is given a `Simulation` to keep its true state in.

    A world that does not derive from this is a robot's: nothing is said about how often it fails.

    Attributes:
        simulation: Where the true state lies.
    """

    simulation: "Simulation"


class Pictureless:
    """Declares that a world's observations hold no pictures: only noise models can answer."""


class Noiseless:
    """Declares that a world's pictures have no noise: what has not changed looks the very same.

    Of other worlds, but for simulated ones, a picture that an action has not changed in a single
    byte is taken to be that of a frozen camera. A simulator of your own derives from this.
    """


def is_noiseless(world: object) -> bool:
    """Whether pictures of a world, or a class of worlds, may be the same after an action."""
    return issubclass(class_of(world), (Simulated, Noiseless))


def is_simulated(world: object) -> bool:
    """Whether a world, or a class of worlds, is simulated."""
    return issubclass(class_of(world), Simulated)


def simulation_of(world: object) -> "Simulation":
    """Where the true state of a simulated world lies.

    Raises:
        WorldError: The world is not simulated.
    """
    if not isinstance(world, Simulated):
        raise WorldError(
            f"{type(world).__name__} is not simulated: nobody knows what is true in it"
        )
    return world.simulation


def has_pictures(world: object) -> bool:
    """Whether a world, or a class of worlds, can be seen."""
    return not issubclass(class_of(world), Pictureless)


def truth_of(world: object) -> TruthSource | None:
    """What is true in a world; None in one that does not know."""
    return world.truth if isinstance(world, Judged) else None


def true_start(world: object, task: "Task") -> "State":
    """The facts that truly hold at first; of a world that does not know, the problem's.

    Args:
        world: The world, before anything was done in it.
        task: What the trial is about.
    """
    if is_simulated(world):
        return simulation_of(world).start
    truth = truth_of(world)
    if truth is None:
        return task.init
    possible = task.reachable_atoms | task.init
    try:
        return frozenset(atom for atom in possible if atom.predicate == VALUE or truth.holds(atom))
    except WorldError:  # what is true has not come from afar yet
        return task.init
