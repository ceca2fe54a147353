"""The task: what the planner plans with and the monitor asks about."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from tpvqa.errors import PDDLError, a, suggestion_or_list
from tpvqa.pddl.arithmetic import COMPARISONS
from tpvqa.pddl.atoms import Atom, Literal, State
from tpvqa.pddl.conditions import Condition, Disjunction, holds
from tpvqa.pddl.derivation import Derivation
from tpvqa.pddl.description import described, grounded_fields, key_of
from tpvqa.pddl.ground import Action, Effect, MutexGroup
from tpvqa.pddl.lasting import Lasting
from tpvqa.pddl.numeric import Numeric, numbers_of
from tpvqa.pddl.schema import ActionSchema, AxiomSchema, ground_action

__all__ = ["Action", "Effect", "MutexGroup", "Task"]


@dataclass(frozen=True, eq=False)
class Task:
    """A planning task as its author wrote it, with what grounding it revealed.

    Attributes:
        name: The problem's name.
        domain_name: The domain's name.
        objects: The type of each object, constants of the domain included.
        types: The parent of each type; None for `object` and other roots.
        predicates: The types of each predicate's arguments; `a|b` for `(either a b)`.
        predicate_variables: The variables that each predicate is declared with, e.g. `?x`.
        init: The initial state, static facts included, derived ones not; one of the possible ones.
        goal: The goal.
        fluents: The predicates that actions change.
        derived: The predicates that follow from axioms.
        schemas: The actions with their variables.
        axioms: The axioms.
        mutex_groups: Groups of atoms of which at most one, or exactly one, holds in every state
            that can be reached from the initial one.
        objects_by_type: The objects of each type, those of its subtypes included.
        functions: The values that action costs refer to.
        reachable_atoms: See `atoms`.
        reachable_actions: Name and arguments of the actions of `ground_actions`.
        left_out: Objects that grounding left out, as they seem not to matter for the goal; atoms,
            actions and groups say nothing of what only they bring about. Empty but for large tasks
            (see `tpvqa.pddl.worker.known_task.LARGE`).
        domain_path: Where the domain was read from; None where it was not a file.
        problem_path: Where the problem was read from.
        domain_text: The text of the domain.
        problem_text: The text of the problem.
        unknown: Facts that may hold at first or not: `(unknown …)`.
        oneof: Facts of which exactly one holds at first: `(oneof …)`.
        clauses: Literals of which at least one holds at first: `(or …)`.
        besides: Further facts that may hold at first, see `opened_to`.
        lasting: Its durative actions; None for a domain without any.
        numeric: Its numbers; None where no action changes any but the cost of a plan.
        metric: The problem's metric, where plans are not chosen by it: one of other numbers.
    """

    name: str
    domain_name: str
    objects: Mapping[str, str]
    types: Mapping[str, str | None]
    predicates: Mapping[str, tuple[str, ...]]
    predicate_variables: Mapping[str, tuple[str, ...]]
    init: State
    goal: Condition
    fluents: frozenset[str]
    derived: frozenset[str]
    schemas: tuple[ActionSchema, ...] = field(repr=False)
    axioms: tuple[AxiomSchema, ...] = field(repr=False)
    mutex_groups: tuple[MutexGroup, ...] = field(repr=False)
    objects_by_type: Mapping[str, tuple[str, ...]] = field(repr=False)
    functions: Mapping[tuple[str, ...], int] = field(repr=False)
    reachable_atoms: frozenset[Atom] = field(repr=False)
    reachable_actions: tuple[tuple[str, ...], ...] = field(repr=False)
    left_out: frozenset[str] = field(repr=False)
    domain_path: Path | None = field(repr=False)
    problem_path: Path | None = field(repr=False)
    domain_text: str = field(repr=False)
    problem_text: str = field(repr=False)
    unknown: frozenset[Atom] = field(default=frozenset(), repr=False)
    oneof: tuple[frozenset[Atom], ...] = field(default=(), repr=False)
    clauses: tuple[tuple[Literal, ...], ...] = field(default=(), repr=False)
    besides: frozenset[Atom] = field(default=frozenset(), repr=False)
    lasting: Lasting | None = field(default=None, repr=False)
    numeric: Numeric | None = field(default=None, repr=False)
    metric: str | None = field(default=None, repr=False)

    @cached_property
    def key(self) -> str:
        """Names the domain and the problem, whatever the initial state."""
        return key_of(self.domain_text, self.problem_text)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Task) and (self.key, self.init) == (other.key, other.init)

    def __hash__(self) -> int:
        return hash((self.key, self.init))

    def __getstate__(self) -> dict[str, Any]:
        return {part.name: getattr(self, part.name) for part in fields(self)}

    @cached_property
    def _schemas_by_name(self) -> dict[str, ActionSchema]:
        return {schema.name: schema for schema in self.schemas}

    @cached_property
    def _actions(self) -> dict[tuple[str, ...], Action]:
        return {}

    def action(self, name: str, arguments: Iterable[str] = ()) -> Action:
        """The ground action of a name and arguments, as its author wrote it.

        Raises:
            PDDLError: There is no such action or object, or number or types do not fit.
        """
        words = (name.lower(), *(argument.lower() for argument in arguments))
        action = self._actions.get(words)
        if action is None:
            schema = self._checked(words)
            action = ground_action(schema, words[1:], self.objects_by_type, self.functions)
            if self.lasting is not None:
                action = self.lasting.taken_back(action, self.mutex_groups)
            self._actions[words] = action
        return action

    def _checked(self, words: tuple[str, ...]) -> ActionSchema:
        name, *arguments = words
        schema = self._schemas_by_name.get(name)
        if schema is None:
            raise PDDLError(
                f"the domain {self.domain_name} has no action {name!r}"
                + suggestion_or_list(name, self._schemas_by_name),
                file=self.domain_path,
            )
        wanted = ", ".join(f"{part.name} - {part.type}" for part in schema.parameters)
        if len(arguments) != len(schema.parameters):
            raise PDDLError(
                f"the action {name} takes {len(schema.parameters)} arguments ({wanted}), "
                f"got {len(arguments)}: {' '.join(arguments) or 'none'}",
                file=self.domain_path,
            )
        for argument, parameter in zip(arguments, schema.parameters, strict=True):
            if argument not in self.objects:
                raise PDDLError(
                    f"there is no object {argument!r}" + suggestion_or_list(argument, self.objects),
                    file=self.problem_path,
                )
            if argument not in self.objects_by_type.get(parameter.type, ()):
                raise PDDLError(
                    f"{argument} is {a(self.objects[argument])}, but {parameter.name} of the "
                    f"action {name} must be {a(parameter.type)}",
                    file=self.domain_path,
                )
        function = schema.cost_of(arguments)
        if not isinstance(function, int) and function not in self.functions:
            raise PDDLError(
                f"the cost of {name}({', '.join(arguments)}) is ({' '.join(function)}), "
                "to which the initial state gives no value",
                file=self.problem_path,
            )
        return schema

    def has_cost(self, name: str, arguments: Sequence[str]) -> bool:
        """Whether an action has a cost; one to which the initial state gives none is never done."""
        function = self._schemas_by_name[name].cost_of(arguments)
        return isinstance(function, int) or function in self.functions

    def ground_actions(self) -> tuple[Action, ...]:
        """All actions reachable from the initial state where nothing is ever undone."""
        return self._ground_actions

    @cached_property
    def _ground_actions(self) -> tuple[Action, ...]:
        actions = tuple(self.action(words[0], words[1:]) for words in self.reachable_actions)
        if self.numeric is not None:  # numbers that nothing changes are not grounded with
            return tuple(each for each in actions if each.precondition != Disjunction())
        return actions if self.lasting is None else (*actions, *self.lasting.looks(self, actions))

    def atoms(self) -> frozenset[Atom]:
        """The atoms that change or are derived, and are reachable as `ground_actions` are."""
        return self.reachable_atoms

    @cached_property
    def left_open(self) -> frozenset[Atom]:
        """The facts of which the problem does not say whether they hold at first."""
        return self.unknown.union(
            *self.oneof, (literal.atom for clause in self.clauses for literal in clause)
        )

    @cached_property
    def static(self) -> State:
        """The facts of the initial state that no action changes."""
        changing = self.fluents | {*COMPARISONS}
        return frozenset(atom for atom in self.init if atom.predicate not in changing)

    def changes(self, atom: Atom) -> bool:
        """Whether an action of any objects could change an atom, it is derived, or left open."""
        if atom.predicate in self.derived or atom in self.left_open:
            return True
        if atom.predicate in COMPARISONS:
            return True
        return any(
            all(
                argument == kind if constant else self.is_a(argument, kind)
                for argument, (kind, constant) in zip(atom.arguments, places, strict=True)
            )
            for places in self._effects_on.get(atom.predicate, ())
        )

    @cached_property
    def _effects_on(self) -> dict[str, frozenset[tuple[tuple[str, bool], ...]]]:
        """What actions can change, by predicate: types of the arguments, or constants."""
        found: dict[str, set[tuple[tuple[str, bool], ...]]] = {}
        for schema in self.schemas:
            for effect in schema.effects:
                kinds = {p.name: p.type for p in (*schema.parameters, *effect.parameters)}
                places = tuple(
                    (kinds.get(argument, argument), argument not in kinds)
                    for argument in effect.literal.arguments
                )
                found.setdefault(effect.literal.predicate, set()).add(places)
        return {name: frozenset(places) for name, places in found.items()}

    @cached_property
    def _derivations(self) -> dict[State, Derivation]:
        return {}

    def extend(self, state: State) -> State:
        """The state with its derived atoms."""
        return self.derivation(state).extend(state) if self.axioms else state

    def derivation(self, state: State) -> Derivation:
        """How derived atoms follow from the others, given the static facts of a state."""
        changing = self.fluents | {*COMPARISONS}
        static = frozenset(atom for atom in state if atom.predicate not in changing)
        derivation = self._derivations.get(static)
        if derivation is None:
            constant = frozenset(self.predicates) - self.fluents - self.derived
            derivation = Derivation(self.axioms, self.objects_by_type, static, constant)
            self._derivations.clear()
            self._derivations[static] = derivation
        return derivation

    def applicable(self, state: State, action: Action) -> bool:
        """Whether an action's precondition holds in a state, and its numbers can be worked out."""
        before, numeric = self.extend(state), self.numeric
        able = holds(action.precondition, before)
        return able and (numeric is None or numeric.comes_to(action, state, before) is not None)

    def apply(self, state: State, action: Action) -> State:
        """The state after an action; whether it is applicable is not asked.

        Conditions of effects are those of the state before; what is both added and deleted holds.
        Numbers stay where what becomes of one cannot be worked out.
        """
        before = self.extend(state)
        added: set[Atom] = set()
        deleted: set[Atom] = set()
        for effect in action.effects:
            if holds(effect.condition, before):
                (added if effect.literal.positive else deleted).add(effect.literal.atom)
        after = (state - deleted) | added
        return (self.numeric and self.numeric.comes_to(action, after, before)) or after

    def goal_holds(self, state: State) -> bool:
        """Whether the goal holds in a state."""
        return holds(self.goal, self.extend(state))

    @cached_property
    def _groups_by_atom(self) -> dict[Atom, tuple[MutexGroup, ...]]:
        index: dict[Atom, list[MutexGroup]] = {}
        for group in self.mutex_groups:
            for atom in group.atoms:
                index.setdefault(atom, []).append(group)
        return {atom: tuple(groups) for atom, groups in index.items()}

    def groups_of(self, atom: Atom) -> tuple[MutexGroup, ...]:
        """The mutex groups that an atom belongs to."""
        return self._groups_by_atom.get(atom, ())

    def check_state(self, state: State) -> None:
        """See that a state speaks of this task's predicates and objects, of fitting types.

        Raises:
            PDDLError: It does not.
        """
        for atom in state:
            self.check_atom(atom)

    def is_a(self, name: str, kind: str) -> bool:
        """Whether an object is of a type; `a|b` for `(either a b)`."""
        return any(part == "object" or name in self._members(part) for part in kind.split("|"))

    def _members(self, kind: str) -> frozenset[str]:
        if kind not in self._members_by_type:
            self._members_by_type[kind] = frozenset(self.objects_by_type.get(kind, ()))
        return self._members_by_type[kind]

    @cached_property
    def _members_by_type(self) -> dict[str, frozenset[str]]:
        return {}

    def related(self, kind: str, other: str) -> bool:
        """Whether an object can be of both types."""
        return any(
            part in self._above(kind) or kind in self._above(part) for part in other.split("|")
        )

    def _above(self, kind: str) -> set[str]:
        found = {"object"}
        above: str | None = kind
        while above is not None and above not in found:
            found.add(above)
            above = self.types.get(above)
        return found

    def fits(self, atom: Atom) -> bool:
        """Whether an atom's arguments are of the types that its predicate is declared with."""
        if atom.predicate in COMPARISONS:
            return self.numeric is not None
        wanted = self.predicates[atom.predicate]
        return all(map(self.is_a, atom.arguments, wanted))

    def check_atom(self, atom: Atom) -> None:
        """See that an atom speaks of this task's predicates and objects, each of a fitting type.

        Raises:
            PDDLError: It does not.
        """
        if self.numeric is not None and atom.predicate in COMPARISONS:
            self.numeric.check(atom, self.objects, self.is_a)
            return
        wanted = self.predicates.get(atom.predicate)
        if wanted is None:
            raise PDDLError(
                f"{atom.pddl()}: there is no predicate {atom.predicate!r}"
                + suggestion_or_list(atom.predicate, self.predicates)
            )
        if len(wanted) != len(atom.arguments):
            raise PDDLError(
                f"{atom.pddl()}: {atom.predicate} takes {len(wanted)} arguments "
                f"({', '.join(wanted) or 'none'}), got {len(atom.arguments)}"
            )
        for argument in atom.arguments:
            if argument not in self.objects:
                raise PDDLError(
                    f"{atom.pddl()}: there is no object {argument!r}"
                    + suggestion_or_list(argument, self.objects)
                )
        if atom in self.reachable_atoms:
            return  # an action makes it true, whatever the predicate is declared with
        variables = self.predicate_variables[atom.predicate]
        for argument, variable, kind in zip(atom.arguments, variables, wanted, strict=True):
            if not self.is_a(argument, kind):
                raise PDDLError(
                    f"{atom.pddl()}: {argument} is {a(self.objects[argument])}, but {variable} of "
                    f"{atom.predicate} must be {' or '.join(map(a, kind.split('|')))}"
                )

    def opened_to(self, atoms: Iterable[Atom]) -> "Task":
        """The same task in which some facts may hold at first although no action adds them.

        What they make reachable is reachable then.

        Raises:
            PDDLError: They speak of unknown predicates or objects.
            PlannerError: The worker could not ground it.
        """
        besides = self.besides.union(atoms)
        self.check_state(besides)
        description = described(
            self.domain_text,
            self.problem_text,
            also=besides,
            domain_path=self.domain_path,
            problem_path=self.problem_path,
        )
        fields_now = grounded_fields(description, numbers_of(self.init))
        return replace(self, besides=besides, **fields_now)

    def with_init(self, state: State) -> "Task":
        """The same task from another initial state, with the mutex groups that hold from there.

        Raises:
            PDDLError: The state speaks of unknown predicates or objects.
            PlannerError: The worker could not ground it.
        """
        self.check_state(state)
        description = described(
            self.domain_text,
            self.problem_text,
            state=state,
            domain_path=self.domain_path,
            problem_path=self.problem_path,
        )
        return replace(self, **grounded_fields(description, numbers_of(state)))
