"""What a simulated robot measures itself, and what its skills notice of their failures."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from random import Random

from tpvqa.observation import SensedFact
from tpvqa.pddl import Action, Atom, State, Task
from tpvqa.pddl.pattern import Pattern

DrawFor = Callable[[Atom], Random]


class Occasion(StrEnum):
    """When something is sensed."""

    EFFECT = "effect"  # after an action that was to change it
    ACTION = "action"  # after every action
    LOOK = "look"  # at every look


@dataclass(frozen=True, slots=True)
class SensedRule:
    """A form of fact that the robot measures itself.

    Attributes:
        fact: The form.
        right: Share of right readings.
        claims: How probable a reading says that it is right.
        at: On which occasions it is measured.
    """

    fact: Pattern
    right: float = 1.0
    claims: float = 1.0
    at: frozenset[Occasion] = frozenset({Occasion.ACTION})

    def read(self, atom: Atom, *, holds: bool, draw: Random) -> SensedFact:
        """One reading."""
        says = holds == (draw.random() < self.right)
        return SensedFact(atom, self.claims if says else round(1 - self.claims, 9))


@dataclass(frozen=True, slots=True)
class ReportRule:
    """What a skill notices.

    Attributes:
        action: The action's name; None for every one.
        notices: Share of its failures that it reports.
        false_alarms: Share of its successes that it reports as failures.
        refuses: Share of the tries that it reports to have refused, of those in which a
            precondition did not hold; None for `notices`.
    """

    action: str | None = None
    notices: float = 0.0
    false_alarms: float = 0.0
    refuses: float | None = None

    def reports(self, *, failed: bool, impossible: bool = False, draw: Random) -> bool:
        """Whether the skill reports a failure.

        Args:
            failed: Whether it failed in truth.
            impossible: Whether it did as a precondition did not hold.
            draw: Random numbers for it.
        """
        if impossible and self.refuses is not None:
            return draw.random() < self.refuses
        return draw.random() < (self.notices if failed else self.false_alarms)


class Sensors:
    """What a simulated robot measures when.

    Args:
        rules: What is measured; of several rules for a fact on an occasion the first counts.
        task: Gives the facts.
    """

    def __init__(self, rules: Sequence[SensedRule], task: Task):
        self._rules, self._task = rules, task
        self._known = task.atoms() | task.init if rules else frozenset[Atom]()
        self._matching = {
            occasion: dict(self._matches(occasion, self._known)) for occasion in Occasion
        }

    def predicates(self) -> frozenset[str]:
        """The predicates that are measured."""
        return frozenset(rule.fact.predicate for rule in self._rules)

    def at_look(self, state: State, draw_for: DrawFor) -> tuple[SensedFact, ...]:
        """The readings at a look.

        Args:
            state: What is true, derived atoms included.
            draw_for: Gives the random numbers of a fact's reading.
        """
        return _readings(self._of(Occasion.LOOK, state), state, draw_for)

    def after(
        self, actions: Iterable[Action], state: State, draw_for: DrawFor
    ) -> tuple[SensedFact, ...]:
        """The readings after an action.

        Args:
            actions: The action as it was planned, and as the skill truly is.
            state: What is true after it, derived atoms included.
            draw_for: Gives the random numbers of a fact's reading.
        """
        effects = {effect.literal.atom for action in actions for effect in action.effects}
        own = self._of(Occasion.EFFECT, state)
        changed = {atom: rule for atom, rule in own.items() if atom in effects}
        return _readings({**changed, **self._of(Occasion.ACTION, state)}, state, draw_for)

    def _of(self, occasion: Occasion, state: State) -> dict[Atom, SensedRule]:
        """The facts that are measured: all that can be reached, and what else is true."""
        return {**self._matching[occasion], **dict(self._matches(occasion, state - self._known))}

    def _matches(
        self, occasion: Occasion, atoms: Iterable[Atom]
    ) -> Iterator[tuple[Atom, SensedRule]]:
        told = [rule for rule in self._rules if occasion in rule.at]
        for atom in atoms if told else ():
            for rule in told:
                if rule.fact.match(atom, {}, self._task) is not None:
                    yield atom, rule
                    break


def _readings(
    measured: Mapping[Atom, SensedRule], state: State, draw_for: DrawFor
) -> tuple[SensedFact, ...]:
    return tuple(
        measured[atom].read(atom, holds=atom in state, draw=draw_for(atom))
        for atom in sorted(measured)
    )
