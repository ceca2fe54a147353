"""Derived facts: a stratified fixpoint over the axioms of a domain."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from tpvqa.errors import PDDLError
from tpvqa.pddl.atoms import Atom, Literal, State
from tpvqa.pddl.conditions import Condition, Conjunction, holds, literals, supporting
from tpvqa.pddl.schema import FALSE, TRUE, AxiomSchema, Objects, bindings, ground_condition, join


@dataclass(frozen=True, slots=True)
class GroundAxiom:
    """A derived atom (its head) and a condition under which it holds."""

    head: Atom
    condition: Condition


class Derivation:
    """Ground axioms in the order in which they are to be evaluated.

    Facts that no action changes are decided once, so that only what can vary is evaluated.

    Args:
        axioms: The axioms.
        objects: The objects of each type.
        static: The facts that no action changes.
        static_predicates: Their predicates.

    Raises:
        PDDLError: A derived fact depends on its own negation.
    """

    def __init__(
        self,
        axioms: Iterable[AxiomSchema],
        objects: Objects,
        static: State,
        static_predicates: frozenset[str],
    ):
        rules: dict[Atom, list[Condition]] = {}
        for axiom in axioms:
            for binding in bindings(axiom.parameters, objects):
                condition = _decided(
                    ground_condition(axiom.condition, binding, objects), static, static_predicates
                )
                if condition != FALSE:
                    head = Atom(axiom.predicate, tuple(binding[p.name] for p in axiom.parameters))
                    rules.setdefault(head, []).append(condition)
        needs = {
            head: [
                literal.atom
                for condition in conditions
                for literal in literals(condition)
                if literal.atom in rules
            ]
            for head, conditions in rules.items()
        }
        self._rules = rules
        self._strata: list[list[GroundAxiom]] = []
        for component in _components(needs):
            members = set(component)
            stratum = [
                GroundAxiom(head, condition) for head in component for condition in rules[head]
            ]
            for rule in stratum:
                for literal in literals(rule.condition):
                    if literal.atom in members and not literal.positive:
                        raise PDDLError(
                            f"the derived fact {rule.head} depends on its own negation through "
                            f"{literal}; expected axioms that can be evaluated in layers"
                        )
            self._strata.append(stratum)

    @property
    def rules(self) -> tuple[GroundAxiom, ...]:
        """The ground axioms, static facts decided."""
        return tuple(rule for stratum in self._strata for rule in stratum)

    def extend(self, state: State) -> State:
        """The state with all its derived atoms."""
        known = set(state)
        view: State = known  # type: ignore[assignment]
        for stratum in self._strata:
            waiting = stratum
            while True:
                fired = [rule for rule in waiting if holds(rule.condition, view)]
                if not fired:
                    break
                known.update(rule.head for rule in fired)
                waiting = [rule for rule in waiting if rule.head not in known]
        return frozenset(known)

    def explain(self, literal: Literal, state: State) -> frozenset[Literal]:
        """Literals of facts that are not derived, on which a derived literal rests.

        Args:
            literal: A derived literal that holds in the state.
            state: The state, without derived atoms.

        Returns:
            Literals that hold in the state; wherever they hold, so does the derived one.
        """
        if literal.positive:
            return frozenset(self._proof(literal.atom, state))
        # It is false because no rule fires; that stays so while nothing the rules speak of changes.
        open_atoms, seen, result = [literal.atom], {literal.atom}, set()
        while open_atoms:
            for condition in self._rules.get(open_atoms.pop(), ()):
                for part in literals(condition):
                    if part.atom not in self._rules:
                        result.add(Literal(part.atom, part.atom in state))
                    elif part.atom not in seen:
                        seen.add(part.atom)
                        open_atoms.append(part.atom)
        return frozenset(result)

    def _proof(self, atom: Atom, state: State) -> set[Literal]:
        reasons: dict[Atom, list[Literal]] = {}
        known = set(state)
        view: State = known  # type: ignore[assignment]
        for stratum in self._strata:
            fired = True
            while fired:
                fired = False
                for rule in stratum:
                    if rule.head not in known and holds(rule.condition, view):
                        reasons[rule.head] = [
                            part for part in supporting(rule.condition, view) if part.holds(view)
                        ]
                        known.add(rule.head)
                        fired = True
        result: set[Literal] = set()
        open_atoms, seen = [atom], {atom}
        while open_atoms:
            for part in reasons[open_atoms.pop()]:
                if part.atom not in self._rules:
                    result.add(part)
                elif not part.positive:
                    result |= self.explain(part, state)
                elif part.atom not in seen:
                    seen.add(part.atom)
                    open_atoms.append(part.atom)
        return result


def _decided(condition: Condition, static: State, predicates: frozenset[str]) -> Condition:
    """The condition with its static literals decided."""
    if isinstance(condition, Literal):
        if condition.atom.predicate not in predicates:
            return condition
        return TRUE if condition.holds(static) else FALSE
    return join(
        (_decided(part, static, predicates) for part in condition.parts),
        conjunctive=isinstance(condition, Conjunction),
    )


def _components(needs: Mapping[Atom, list[Atom]]) -> list[list[Atom]]:
    """Strongly connected components, each after those it needs (Tarjan, without recursion)."""
    index: dict[Atom, int] = {}
    low: dict[Atom, int] = {}
    stack: list[Atom] = []
    on_stack: set[Atom] = set()
    result: list[list[Atom]] = []
    for root in needs:
        if root in index:
            continue
        work = [(root, iter(needs[root]))]
        index[root] = low[root] = len(index)
        stack.append(root)
        on_stack.add(root)
        while work:
            node, rest = work[-1]
            for neighbour in rest:
                if neighbour not in index:
                    index[neighbour] = low[neighbour] = len(index)
                    stack.append(neighbour)
                    on_stack.add(neighbour)
                    work.append((neighbour, iter(needs[neighbour])))
                    break
                if neighbour in on_stack:
                    low[node] = min(low[node], index[neighbour])
            else:
                work.pop()
                if work:
                    parent = work[-1][0]
                    low[parent] = min(low[parent], low[node])
                if low[node] == index[node]:
                    component: list[Atom] = []
                    while not component or component[-1] != node:
                        component.append(stack.pop())
                        on_stack.discard(component[-1])
                    result.append(component)
    return result
