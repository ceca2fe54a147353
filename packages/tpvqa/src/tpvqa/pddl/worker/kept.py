"""The groundings that are kept of a task, or of the part of it that some of its objects make."""

import contextlib
from collections.abc import Iterable, Iterator
from io import StringIO
from typing import Any

from tpvqa.pddl.worker.grounding import AtomKey, Grounding

_KEPT_STATES = 8
"""So many states outside the first grounding widen the second one before it starts anew."""

Facts = frozenset[AtomKey]


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """The translator prints; this process's standard output is spoken for."""
    with contextlib.redirect_stdout(StringIO()), contextlib.redirect_stderr(StringIO()):
        yield


class KeptGroundings:
    """Two groundings, as few as serve the states that come.

    `home` is that from the first state, and `away` serves the states that `home` cannot (an object
    where nothing said it could be, say) and grows with them.

    Args:
        task: The translator's normalised task.
        static: The facts that no action changes.
        fluent: The other facts of the first state.
        names: The objects that are there.
        numbers: The values of the functions of action costs.
        left_open: Facts of which the problem does not say whether they hold at first.
    """

    def __init__(
        self,
        task: Any,
        static: Facts,
        fluent: Facts,
        *,
        names: frozenset[str],
        numbers: Iterable[Any] = (),
        left_open: Facts = frozenset(),
    ):
        self._task, self.names = task, names
        self._all = task.objects
        self._things = [each for each in self._all if each.name in names]
        self._whole = len(self._things) == len(self._all)
        self._numeric = [fact for fact in numbers if names.issuperset(fact.fluent.args)]
        self._first = self.within(static), self.within(fluent)
        self._left_open = self.within(left_open)
        self._home: Grounding | None = None
        self._away: Grounding | None = None
        self._away_states: list[Facts] = []
        self.count = 0

    def within(self, facts: Facts) -> Facts:
        """The facts that speak of no object but those that are there."""
        if self._whole:
            return facts
        return frozenset(key for key in facts if self.names.issuperset(key[1:]))

    @property
    def home(self) -> Grounding:
        """The grounding from the first state."""
        if self._home is None:
            self._home = self.ground(*self._first)
        return self._home

    def ground(self, static: Facts, fluent: Facts, also: Iterable[AtomKey] = ()) -> Grounding:
        """A grounding from a state, which is not kept."""
        self.count += 1
        try:
            self._task.objects = self._things
            with quiet():
                return Grounding(
                    self._task,
                    self._numeric,
                    self.within(static),
                    self.within(fluent),
                    {*also, *self._left_open},
                )
        finally:
            self._task.objects = self._all

    def knows(self, static: Facts, fluent: Facts) -> bool:
        """Whether a grounding that is there serves a state."""
        static, fluent = self.within(static), self.within(fluent)
        kept = [each for each in (self._home, self._away) if each is not None]
        return any(each.serves(static, fluent) for each in kept)

    def serving(self, static: Facts, fluent: Facts) -> Grounding:
        """A grounding that serves a state."""
        static, fluent = self.within(static), self.within(fluent)
        if self.home.serves(static, fluent):
            return self.home
        if self._away is not None and self._away.serves(static, fluent):
            return self._away
        if self._away is None or self._away.static != static:
            self._away_states = []
        self._away_states = [*self._away_states[1 - _KEPT_STATES :], fluent]
        self._away = self.ground(static, fluent, self._first[1].union(*self._away_states))
        return self._away
