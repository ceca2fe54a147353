"""What a robot says it has sensed, held against the task before anybody believes it."""

from collections.abc import Collection, Sequence
from typing import cast

from tpvqa.drivers.plugged import called, malformed
from tpvqa.errors import PDDLError, suggestion_or_list
from tpvqa.observation import SensedFact
from tpvqa.pddl import Atom, Task
from tpvqa.worlds.capabilities import Sensing

_NAMES = cast("type[Collection[str]]", Collection)


def senses_of(world: object, task: Task) -> frozenset[str]:
    """The predicates that a world says the robot senses itself.

    Raises:
        PluginError: The world broke, or names what is no predicate of the task.
    """
    if not isinstance(world, Sensing):
        return frozenset()
    told: Collection[str] = called(world, "senses", _NAMES)
    for name in told:
        if name not in task.predicates:
            said = f"there is no predicate {name!r}" + suggestion_or_list(
                str(name), task.predicates
            )
            raise malformed(world, "senses", ValueError(said))
    return frozenset(told)


def checked(
    facts: Sequence[SensedFact], task: Task, part: object, method: str
) -> tuple[SensedFact, ...]:
    """The facts that a world's method sensed.

    Raises:
        PluginError: One is no `SensedFact`, is not of the task, or its probability is no number
            from 0 to 1.
    """
    if isinstance(facts, str) or not isinstance(facts, Sequence):
        raise malformed(part, method, ValueError(f"facts is no sequence: {facts!r:.80}"))
    for fact in facts:
        if not isinstance(fact, SensedFact) or not isinstance(fact.atom, Atom):
            raise malformed(part, method, ValueError(f"no SensedFact of an Atom: {fact!r:.80}"))
        p = fact.probability
        number = isinstance(p, int | float) and not isinstance(p, bool)
        if not number or not 0 <= p <= 1:
            said = f"the probability of {fact.atom} is from 0 to 1, not {p!r:.80}"
            raise malformed(part, method, ValueError(said))
        try:
            task.check_atom(fact.atom)
        except PDDLError as error:
            raise malformed(part, method, error) from error
    return tuple(facts)
