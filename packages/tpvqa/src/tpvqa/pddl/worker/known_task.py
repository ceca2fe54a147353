"""A task that the worker has read, with the groundings it keeps."""

import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from fast_downward.translate import normalize, options, pddl

from tpvqa.pddl.worker.describing import static_description
from tpvqa.pddl.worker.durative import leave_out_unplanned, without_running
from tpvqa.pddl.worker.grounding import AtomKey, Grounding, key_of
from tpvqa.pddl.worker.inductive import First
from tpvqa.pddl.worker.invariants import described_groups, lawful_groups
from tpvqa.pddl.worker.kept import Facts, KeptGroundings, quiet
from tpvqa.pddl.worker.likeness import out_of_reach
from tpvqa.pddl.worker.reading import read
from tpvqa.pddl.worker.reading_error import ReadingError
from tpvqa.pddl.worker.relevance import EFFORTS, relevant_objects
from tpvqa.pddl.worker.rules import Rules, rules_of
from tpvqa.pddl.worker.search import Searcher, SearchOutcome
from tpvqa.pddl.worker.seeking import sought
from tpvqa.pddl.worker.unsure import UnsureError, chosen, give_room

LARGE = 50_000
"""Instances of actions times their effects (see `Rules.size`) above which objects are left out."""
_WORTH = 0.75
"""Of a larger share of all objects none is left out."""
_KEPT_PARTS = 6
_PATIENCE = 0.3
"""The share of the time that is left, which the search in a part of the task gets."""
_LONGEST = 30.0  # seconds that it gets where the time is not limited

_OUT_OF_REACH = SearchOutcome(
    "unsolvable", reason="the goal is out of reach even where nothing is ever undone"
)

options.set_options(
    ["domain", "problem", "--keep-unreachable-facts", "--invariant-generation-max-time", "30"]
)


@dataclass(frozen=True, slots=True)
class Leaving:
    """What a search may leave out of a large task.

    Attributes:
        keep: Objects that it may not.
        effort: The number of the effort of `EFFORTS` with which to begin.
    """

    keep: frozenset[str] = frozenset()
    effort: int = 0


class KnownTask:
    """A task, read once.

    Of a large task some objects are left out before it is grounded: first all that seem not to
    matter (see `relevance`), then fewer, then none. That there is no plan is said of the whole
    task alone.

    Args:
        domain_text: The domain, as PDDL.
        problem_text: The problem, as PDDL.

    Raises:
        ReadingError: They cannot be read.
    """

    def __init__(self, domain_text: str, problem_text: str):
        with quiet():
            task, unsure = read(domain_text, problem_text)
            self.description = static_description(task)
            if task.numeric is not None:
                self.description = task.numeric.restored(self.description)
            leave_out_unplanned(task)
            normalize.normalize(task)
            hidden = give_room(task, unsure)
        self._task = task
        self._changing = {
            effect.literal.predicate for action in task.actions for effect in action.effects
        }
        self._derived = {axiom.name for axiom in task.axioms}
        initial = [
            key_of(fact)
            for fact in task.init
            if isinstance(fact, pddl.Atom) and fact.predicate != "="
        ]
        if unsure.atoms:
            try:
                with quiet():
                    initial += chosen(task, initial, unsure)
            except UnsureError as error:
                raise ReadingError(error.message, "problem", error.line) from None
        self._left_open = frozenset(unsure.atoms)
        self._initial = self._split(initial)
        self._first = First(
            self._initial[1] - self._left_open, self._left_open, [*map(frozenset, unsure.oneof)]
        )
        self.description["fluents"] = sorted({*self.description["fluents"], *hidden})
        self.description |= unsure.described()
        self._rules: Rules = rules_of(task)
        self._numbers = [fact for fact in task.init if isinstance(fact, pddl.Assign)]
        self._names = frozenset(thing.name for thing in task.objects)
        self._whole = KeptGroundings(
            task,
            *self._initial,
            names=self._names,
            numbers=self._numbers,
            left_open=self._left_open,
        )
        # what a number needs is not followed back to what brings it about
        self._large = self._rules.size > LARGE and not self._left_open and task.numeric is None
        self._parts: list[KeptGroundings] = []

    @property
    def groundings(self) -> int:
        """How often it was grounded."""
        return self._whole.count + sum(part.count for part in self._parts)

    def describe(
        self, initial: list[list[str]] | None, also: list[list[str]] | None = None
    ) -> dict[str, Any]:
        """Everything about the task.

        Args:
            initial: Another initial state.
            also: Facts that may hold at first besides; only what is reachable depends on them.
        """
        static, fluent = self._initial if initial is None else self._split(map(tuple, initial))
        _, more = self._split(map(tuple, also or ()))
        there, here = self._whole, None
        if self._first_part is not None and not more:
            there, here = self._first_part, self._first_part.home
            if initial is not None:
                there, here = self._reaching(static, fluent, there.names)
        if here is None:
            at_home = initial is None and not more
            here = there.home if at_home else there.ground(static, fluent, more)
        with quiet():
            self._task.init = here.initial
            if there is self._whole:
                opened = First(fluent) if initial is not None else self._first
                groups = described_groups(self._task, here, fluent, opened)
            else:
                groups = lawful_groups(self._task, here.atoms)
        return {
            **self.description,
            "init": sorted(static | fluent),
            "atoms": sorted(key for key in here.atoms if not self._made_up(key[0])),
            "ground_actions": sorted(
                words
                for words in {tuple(action.name.strip("()").split()) for action in here.actions}
                if not self._made_up(words[0])
            ),
            "mutex_groups": [
                group
                for group in without_running(self._task, groups)
                if not any(self._made_up(atom[0]) for atom in group[0])
            ],
            "left_out": sorted(self._names - there.names),
        }

    def plan(
        self,
        state: list[list[str]],
        searcher: Searcher,
        *,
        searches: dict[str, Any],
        seconds: float | None,
        memory: int | None,
        leaving: Leaving | None = None,
    ) -> SearchOutcome:
        """Seek a plan from a state.

        Args:
            state: The atoms that hold.
            searcher: What runs the search.
            searches: Fast Downward's search for tasks that are "simple" (neither axioms nor
                conditional effects) and for "other" ones; see `tpvqa.pddl.worker.seeking` for what
                else may stand here.
            seconds: The time limit of grounding and search together.
            memory: The limit of the search's memory in MiB.
            leaving: What may be left out, if the task is large; None for nothing. A plan found so
                need not hold in the whole task.
        """
        end = None if seconds is None else time.monotonic() + seconds
        static, fluent = self._split(map(tuple, state))
        if self._large and not self._served(static, fluent) and self._hopeless(static, fluent):
            return _OUT_OF_REACH
        for part in () if leaving is None else self._suitable(static, fluent, leaving):
            left = _LONGEST / _PATIENCE if end is None else end - time.monotonic()
            if left <= 0:
                return SearchOutcome("timeout")
            until = time.monotonic() + left * _PATIENCE
            outcome = self._sought(part, static, fluent, searcher, searches, until, memory)
            if outcome.kind == "plan":
                return replace(outcome, left_out=len(self._names - part.names))
        return self._sought(self._whole, static, fluent, searcher, searches, end, memory)

    def _sought(
        self,
        kept: KeptGroundings,
        static: Facts,
        fluent: Facts,
        searcher: Searcher,
        searches: dict[str, Any],
        end: float | None,
        memory: int | None,
    ) -> SearchOutcome:
        grounding = kept.serving(static, fluent)
        if not grounding.goal_reachable:
            return _OUT_OF_REACH
        if grounding.goal_trivial:
            return SearchOutcome("plan")
        with quiet():
            template = grounding.template
        if template is None:
            return SearchOutcome(
                "unsolvable", reason="the goal asks for facts that exclude each other"
            )
        search = searches["simple" if template.simple else "other"]
        left = None if end is None else end - time.monotonic()
        if left is not None and left <= 0:
            return SearchOutcome("timeout")
        return sought(
            searcher, template, kept.within(fluent), search, searches, seconds=left, memory=memory
        )

    @cached_property
    def _first_part(self) -> KeptGroundings | None:
        """The part that is described; None where all objects are, as the task is not large."""
        if not self._large:
            return None
        found, _ = self._reaching(*self._initial, frozenset())
        return None if found is self._whole else found

    def _reaching(
        self, static: Facts, fluent: Facts, names: frozenset[str]
    ) -> tuple[KeptGroundings, Grounding | None]:
        """The smallest part in which the goal can be reached where nothing is ever undone.

        With it comes its grounding from this state; without, where it is the whole task. Where
        the goal is out of reach it is the part of what the goal names.
        """
        if self._hopeless(static, fluent):
            part = self._part(names | self._rules.named, static, fluent)
            return part, part.ground(static, fluent)
        for part in self._grown(static, fluent, Leaving(), names):
            here = part.serving(static, fluent) if not names else part.ground(static, fluent)
            if here.goal_reachable:
                return part, here
        return self._whole, None

    def _hopeless(self, static: Facts, fluent: Facts) -> bool:
        """Whether it is proved without grounding that no plan leads to the goal."""
        with quiet():
            return out_of_reach(
                self._task, static, fluent, named=self._rules.named, numbers=self._numbers
            )

    def _served(self, static: Facts, fluent: Facts) -> bool:
        """Whether a grounding is kept that serves a state and in which the goal seemed in reach."""
        return any(
            kept.knows(static, fluent) and kept.home.goal_reachable
            for kept in (self._whole, *self._parts)
        )

    def _suitable(self, static: Facts, fluent: Facts, leaving: Leaving) -> Iterator[KeptGroundings]:
        """Parts of a large task in which to look for a plan, one after the other."""
        first = self._first_part
        if first is None:
            return
        tried: list[KeptGroundings] = []
        for part in (first, *reversed(self._parts)) if leaving.effort == 0 else ():
            if part not in tried and leaving.keep <= part.names and part.knows(static, fluent):
                tried.append(part)
                yield part
        for part in self._grown(static, fluent, leaving, first.names):
            if part not in tried:
                yield part

    def _grown(
        self, static: Facts, fluent: Facts, leaving: Leaving, names: frozenset[str]
    ) -> Iterator[KeptGroundings]:
        """Parts with these objects and what may matter from a state, each larger than the last."""
        known, names, lacking = frozenset[str](), names | leaving.keep, False
        for effort in EFFORTS[leaving.effort :]:
            if lacking and effort is not EFFORTS[-1]:
                continue  # a little more of the same
            found = relevant_objects(self._rules, static | fluent, effort)
            lacking = found is None
            if found is None or found <= known:
                continue
            known = names = names | found
            if len(names) > _WORTH * len(self._names):
                return
            yield self._part(names, static, fluent)

    def _part(self, names: frozenset[str], static: Facts, fluent: Facts) -> KeptGroundings:
        for part in self._parts:
            if part.names == names:
                return part
        if len(self._parts) == _KEPT_PARTS:
            del self._parts[1]  # the first one is described
        self._parts.append(
            KeptGroundings(self._task, static, fluent, names=names, numbers=self._numbers)
        )
        return self._parts[-1]

    def _made_up(self, name: str) -> bool:
        """Whether a predicate or an action is not of the author's making."""
        numeric = self._task.numeric
        return name.startswith("new-axiom@") or (numeric is not None and numeric.is_made_up(name))

    def _split(self, atoms: Iterable[AtomKey]) -> tuple[Facts, Facts]:
        """Static and fluent facts; derived ones follow from them and are left out, and values of
        numbers are not grounded."""
        static, fluent = set(), set()
        for key in atoms:
            if key[0] in self._changing:
                fluent.add(key)
            elif key[0] not in self._derived and key[0] != "=":
                static.add(key)
        return frozenset(static), frozenset(fluent)
