"""One grounding of a task, from which plans can be sought for many initial states."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from io import StringIO
from typing import Any

from fast_downward.translate import (
    fact_groups,
    instantiate,
    pddl,
    sas_tasks,
    variable_order,
)
from fast_downward.translate import main as translator

from tpvqa.pddl.worker.ahead import AHEAD, Ahead, ahead_of

AtomKey = tuple[str, ...]
"""A predicate and its arguments."""


def key_of(fact: Any) -> AtomKey:
    """The key of one of the translator's atoms."""
    return (fact.predicate, *fact.args)


def to_fact(key: Sequence[str]) -> Any:
    """The translator's atom of a key."""
    return pddl.Atom(key[0], tuple(key[1:]))


@dataclass(frozen=True)
class SASTemplate:
    """The text of a SAS+ task with a gap where the initial state stands.

    Attributes:
        before: Everything up to the values of the initial state.
        after: Everything after them.
        defaults: Each variable's value where none of its atoms holds.
        places: Variable and value of each atom that the task still mentions.
        simple: Whether it has neither axioms nor conditional effects.
        has_axioms: Whether it has axioms.
    """

    before: bytes
    after: bytes
    defaults: tuple[int, ...]
    places: dict[AtomKey, tuple[int, int]]
    simple: bool
    has_axioms: bool

    def values(self, state: Iterable[AtomKey]) -> list[int]:
        """Each variable's value in a state."""
        values = list(self.defaults)
        for atom in state:
            place = self.places.get(atom)
            if place is not None:
                values[place[0]] = place[1]
        return values

    def fill(self, state: Iterable[AtomKey]) -> bytes:
        """The text of the task with a state as its initial one."""
        values = "\n".join(map(str, self.values(state))).encode()
        return self.before + values + b"\n" + self.after

    @cached_property
    def ahead(self) -> Ahead | None:
        """How the task is read before its initial state is known; None where that saves little."""
        if len(self.before) + len(self.after) < AHEAD:
            return None
        return ahead_of(self.before, self.after, self.defaults)


class Grounding:
    """Everything that can be reached from some facts, and how states are encoded.

    It serves every state whose atoms all lie among the reached ones (what can be reached from such
    a state is then among them too) and of which no mutex group holds twice (groups are balanced:
    no action raises a group's weight, so a weight of at most one stays). For all other states the
    task has to be grounded again.

    Args:
        task: The translator's normalised task.
        numeric: Its initial function values.
        static: The facts that no action changes.
        current: The fluent facts of the state for which mutex groups are to hold.
        also: Further fluent facts from which to start, so that more states are served.
    """

    def __init__(
        self,
        task: Any,
        numeric: Sequence[Any],
        static: frozenset[AtomKey],
        current: Iterable[AtomKey],
        also: Iterable[AtomKey] = (),
    ):
        self.static = static
        equalities = [pddl.Atom("=", (thing.name, thing.name)) for thing in task.objects]
        fixed = [*equalities, *numeric, *map(to_fact, sorted(static))]
        now = [to_fact(key) for key in sorted(current)]
        task.init = list(dict.fromkeys([*fixed, *now, *map(to_fact, sorted(also))]))
        (self._goal_reachable, atoms, self.actions, self._goal, self._axioms, parameters) = (
            instantiate.explore(task)
        )
        self.atoms = frozenset(key_of(fact) for fact in atoms)
        # The weight of an invariant is that of the current state alone.
        task.init = [*fixed, *now]
        negative = {fact.negate() for fact in self._goal or () if fact.negated}
        self._groups, groups, self._names = fact_groups.compute_groups(
            task, atoms, parameters, negative
        )
        self._all_groups = groups
        self.mutex_groups = [frozenset(map(key_of, group)) for group in groups if len(group) > 1]
        self.initial = task.init
        self._metric = task.use_min_cost_metric

    @property
    def goal_reachable(self) -> bool:
        """Whether the goal is reachable at all where delete effects are ignored."""
        return self._goal_reachable and self._goal is not None

    @property
    def goal_trivial(self) -> bool:
        """Whether the goal rests on nothing that changes, and holds."""
        return self.goal_reachable and not self._goal

    def serves(self, static: frozenset[AtomKey], fluent: frozenset[AtomKey]) -> bool:
        """Whether plans from this state may be sought in this grounding."""
        return (
            static == self.static
            and fluent <= self.atoms
            and all(len(fluent & group) <= 1 for group in self.mutex_groups)
        )

    @cached_property
    def template(self) -> SASTemplate | None:
        """The SAS+ text, written on first use; None where the goal asks for two of a group."""
        return self._write()

    def _write(self) -> SASTemplate | None:
        ranges, places = translator.strips_to_sas_dictionary(self._groups, assert_partial=True)
        mutex_ranges, mutex_places = translator.strips_to_sas_dictionary(
            self._all_groups, assert_partial=False
        )
        task = translator.translate_task(
            places,
            ranges,
            self._names,
            mutex_places,
            mutex_ranges,
            translator.build_mutex_key(places, self._all_groups),
            self.initial,
            self._goal,
            self.actions,
            self._axioms,
            self._metric,
            {},
        )
        if task.variables.value_names is not self._names:
            return None  # the translator saw that the goal violates a mutex group
        # Which atom each value stands for is read from the names, as variables are about to move.
        by_name = {str(to_fact(key)): key for key in self.atoms}
        variable_order.find_and_apply_variable_order(task, True, True)
        left: dict[AtomKey, tuple[int, int]] = {}
        defaults: list[int] = []
        for variable, names in enumerate(task.variables.value_names):
            default = None
            for value, name in enumerate(names):
                if name in by_name:
                    left[by_name[name]] = (variable, value)
                else:
                    default = value
            defaults.append(task.init.values[variable] if default is None else default)
        for key in [key for key in left if task.variables.axiom_layers[left[key][0]] >= 0]:
            del left[key]
        return _split(task, tuple(defaults), left)


def _split(
    task: sas_tasks.SASTask, defaults: tuple[int, ...], places: dict[AtomKey, tuple[int, int]]
) -> SASTemplate:
    stream = StringIO()
    task.output(stream)
    text = stream.getvalue()
    start = text.index("begin_state\n") + len("begin_state\n")
    end = text.index("end_state")
    conditional = any(
        condition for operator in task.operators for _, _, _, condition in operator.pre_post
    )
    return SASTemplate(
        before=text[:start].encode(),
        after=text[end:].encode(),
        defaults=defaults,
        places=places,
        simple=not task.axioms and not conditional,
        has_axioms=bool(task.axioms),
    )
