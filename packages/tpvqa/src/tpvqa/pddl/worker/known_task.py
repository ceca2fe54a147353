"""A task that the worker has read, with the groundings it keeps."""

import contextlib
import time
from collections.abc import Iterable, Iterator
from io import StringIO
from typing import Any

from fast_downward.translate import normalize, options, pddl

from tpvqa.pddl.worker.describing import static_description
from tpvqa.pddl.worker.grounding import AtomKey, Grounding, key_of
from tpvqa.pddl.worker.invariants import described_groups
from tpvqa.pddl.worker.reading import ReadingError, read
from tpvqa.pddl.worker.search import Searcher, SearchOutcome
from tpvqa.pddl.worker.unsure import UnsureError, chosen, give_room

_KEPT_STATES = 8
"""So many states outside the first grounding widen the second one before it starts anew."""

options.set_options(
    ["domain", "problem", "--keep-unreachable-facts", "--invariant-generation-max-time", "30"]
)


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """The translator prints; this process's standard output is spoken for."""
    with contextlib.redirect_stdout(StringIO()), contextlib.redirect_stderr(StringIO()):
        yield


class KnownTask:
    """A task, read once.

    Two groundings are kept: `home` from the task's own initial state, and `away`, which serves the
    states that `home` cannot (an object where nothing said it could be, say) and grows with them.

    Args:
        domain_text: The domain, as PDDL.
        problem_text: The problem, as PDDL.

    Raises:
        ReadingError: They cannot be read.
    """

    def __init__(self, domain_text: str, problem_text: str):
        with _quiet():
            task, unsure = read(domain_text, problem_text)
            self.description = static_description(task)
            normalize.normalize(task)
            hidden = give_room(task, unsure)
        self._task = task
        self._numeric = [fact for fact in task.init if isinstance(fact, pddl.Assign)]
        self._changing = {
            effect.literal.predicate for action in task.actions for effect in action.effects
        }
        self._derived = {axiom.name for axiom in task.axioms}
        self._initial = [
            key_of(fact)
            for fact in task.init
            if isinstance(fact, pddl.Atom) and fact.predicate != "="
        ]
        if unsure.atoms:
            try:
                with _quiet():
                    self._initial += chosen(task, self._initial, unsure)
            except UnsureError as error:
                raise ReadingError(error.message, "problem", error.line) from None
        self._left_open = unsure.atoms
        self.description["fluents"] = sorted({*self.description["fluents"], *hidden})
        self.description |= unsure.described()
        self._home: Grounding | None = None
        self._away: Grounding | None = None
        self._away_states: list[frozenset[AtomKey]] = []
        self.groundings = 0

    def describe(
        self, initial: list[list[str]] | None, also: list[list[str]] | None = None
    ) -> dict[str, Any]:
        """Everything about the task.

        Args:
            initial: Another initial state.
            also: Facts that may hold at first besides; only what is reachable depends on them.
        """
        static, fluent = self._split(self._initial if initial is None else map(tuple, initial))
        _, more = self._split(map(tuple, also or ()))
        if initial is None and not more:
            grounding = self._at_home(static, fluent)
        else:
            grounding = self._ground(static, fluent, more)
        with _quiet():
            self._task.init = grounding.initial
            groups = described_groups(self._task, grounding, fluent)
        return {
            **self.description,
            "init": sorted(static | fluent),
            "atoms": sorted(key for key in grounding.atoms if not key[0].startswith("new-axiom@")),
            "ground_actions": sorted(
                {tuple(action.name.strip("()").split()) for action in grounding.actions}
            ),
            "mutex_groups": groups,
        }

    def plan(
        self,
        state: list[list[str]],
        searcher: Searcher,
        *,
        searches: dict[str, str],
        seconds: float | None,
        memory: int | None,
    ) -> SearchOutcome:
        """Seek a plan from a state.

        Args:
            state: The atoms that hold.
            searcher: What runs the search.
            searches: Fast Downward's search for tasks that are "simple" (neither axioms nor
                conditional effects) and for "other" ones.
            seconds: The time limit of grounding and search together.
            memory: The limit of the search's memory in MiB.
        """
        end = None if seconds is None else time.monotonic() + seconds
        static, fluent = self._split(map(tuple, state))
        grounding = self._serving(static, fluent)
        if not grounding.goal_reachable:
            return SearchOutcome(
                "unsolvable", reason="the goal is out of reach even where nothing is ever undone"
            )
        if grounding.goal_trivial:
            return SearchOutcome("plan")
        with _quiet():
            template = grounding.template
        if template is None:
            return SearchOutcome(
                "unsolvable", reason="the goal asks for facts that exclude each other"
            )
        search = searches["simple" if template.simple else "other"]
        left = None if end is None else end - time.monotonic()
        if left is not None and left <= 0:
            return SearchOutcome("timeout")
        return searcher.run(template.fill(fluent), search, seconds=left, memory=memory)

    def _split(self, atoms: Iterable[AtomKey]) -> tuple[frozenset[AtomKey], frozenset[AtomKey]]:
        """Static and fluent facts; derived ones follow from them and are left out."""
        static, fluent = set(), set()
        for key in atoms:
            if key[0] in self._changing:
                fluent.add(key)
            elif key[0] not in self._derived:
                static.add(key)
        return frozenset(static), frozenset(fluent)

    def _ground(
        self,
        static: frozenset[AtomKey],
        fluent: frozenset[AtomKey],
        also: Iterable[AtomKey] = (),
    ) -> Grounding:
        self.groundings += 1
        with _quiet():
            return Grounding(self._task, self._numeric, static, fluent, {*also, *self._left_open})

    def _at_home(self, static: frozenset[AtomKey], fluent: frozenset[AtomKey]) -> Grounding:
        if self._home is None:
            self._home = self._ground(static, fluent)
        return self._home

    def _serving(self, static: frozenset[AtomKey], fluent: frozenset[AtomKey]) -> Grounding:
        home = self._at_home(*self._split(self._initial))
        if home.serves(static, fluent):
            return home
        if self._away is not None and self._away.serves(static, fluent):
            return self._away
        if self._away is None or self._away.static != static:
            self._away_states = []
        self._away_states = [*self._away_states[1 - _KEPT_STATES :], fluent]
        also = set(self._initial).union(*self._away_states)
        _, also_fluent = self._split(also)
        self._away = self._ground(static, fluent, also_fluent)
        return self._away
