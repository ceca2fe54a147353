"""What is true in a room of MuJoCo's: of which facts a world knows, now and before an action."""

from collections.abc import Callable, Collection
from itertools import product
from typing import Any

from tpvqa.errors import WorldError
from tpvqa.pddl import Action, Atom, State, Task
from tpvqa.worlds.earlier_truth import EarlierTruth

FINGERS = ("left", "right")


def see_known(
    task: Task,
    known: Collection[str],
    *,
    world: str,
    example: str,
) -> None:
    """See whether a task is about what a world knows.

    Args:
        task: The task.
        known: The predicates of which the world knows when they hold.
        world: The world; named in errors.
        example: A task that it knows.

    Raises:
        WorldError: It has a predicate of which the world cannot tell whether it holds.
    """
    strange = sorted(set(task.predicates) - set(known) - {"="})
    if strange:
        raise WorldError(
            f"The world {world!r} cannot tell when {strange[0]!r} holds; it knows "
            f"{', '.join(known)}. Run {example} in it, or another task with these predicates."
        )


def atoms_of(task: Task, known: Collection[str]) -> frozenset[Atom]:
    """All facts that known predicates and a task's objects make up."""
    return frozenset(
        Atom(predicate, names)
        for predicate, kinds in task.predicates.items()
        if predicate in known
        for names in product(*([n for n in task.objects if task.is_a(n, kind)] for kind in kinds))
    )


def touched_by_both(model: Any, data: Any, name: str) -> bool:
    """Whether parts of both fingers touch a body."""
    body, touching = model.body(name).id, set()
    for contact in data.contact[: data.ncon]:
        bodies = [int(model.geom_bodyid[geom]) for geom in contact.geom]
        if body in bodies and bodies[0] != bodies[1]:
            other = model.body(bodies[1] if bodies[0] == body else bodies[0]).name
            touching |= {side for side in FINGERS if other.startswith(f"arm_hand_{side}")}
    return len(touching) == len(FINGERS)


class PresentTruth:
    """What is true now: a live `TruthSource`.

    Args:
        task: Tells what follows from the state.
        now: Gives the facts that hold now.
    """

    def __init__(self, task: Task, now: Callable[[], State]):
        self._task, self._now = task, now

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
        return EarlierTruth(self._task, self._now(), self.visible)


class PhysicalTruth(PresentTruth):
    """The same, of a world that also knows what was before the last action.

    Args:
        task: Tells what follows from the state.
        now: Gives the facts that hold now.
        before: Gives those that held before the last action.
    """

    def __init__(self, task: Task, now: Callable[[], State], before: Callable[[], State]):
        super().__init__(task, now)
        self._then = before

    def earlier(self) -> EarlierTruth:
        """What was true before the last action; at first what is true now."""
        return EarlierTruth(self._task, self._then(), self.visible)
