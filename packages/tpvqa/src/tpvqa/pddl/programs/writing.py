"""What a logic program says, written as PDDL: one task for the whole house."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from itertools import product
from math import prod

from tpvqa.pddl.atoms import Atom, Literal
from tpvqa.pddl.programs.lifting import Arguments, Guards, Item, patterns
from tpvqa.pddl.programs.reading import Program

_LISTED = 1_000_000
"""More choices of objects than these are not listed."""


def as_pddl(program: Program, name: str) -> tuple[str, str]:
    """Domain and problem.

    Args:
        program: What a program says.
        name: What domain and problem are called.

    Raises:
        IrregularError: The instances of an action have too little in common.
    """
    return _Writer(program).written(name)


class _Writer:
    def __init__(self, program: Program):
        self._program = program
        arguments = {name for atom in program.atoms() for name in atom.arguments}
        arguments |= {name for action in program.actions for name in action.arguments}
        self._objects = sorted(arguments | set(program.types))
        self._extent = self._extents()
        self._guards = Guards()
        self._uses: dict[str, set[Arguments]] = defaultdict(set)
        for atom in program.atoms():
            self._uses[atom.predicate].add(atom.arguments)

    def _extents(self) -> dict[str, frozenset[str]]:
        """The objects of each type."""
        parents = self._program.parents
        kinds = {*parents, *parents.values(), *self._program.types.values()}
        found: dict[str, set[str]] = {kind: set() for kind in kinds}
        for thing, kind in self._program.types.items():
            above: str | None = kind
            seen: set[str] = set()
            while above is not None and above not in seen:
                seen.add(above)
                found[above].add(thing)
                above = parents.get(above)
        return {kind: frozenset(things) for kind, things in found.items()}

    def _kind(self, things: Iterable[str]) -> str:
        """The smallest type that some objects are all of."""
        needed = frozenset(things)
        fitting = [kind for kind, own in self._extent.items() if needed and needed <= own]
        return min(fitting, key=lambda kind: (len(self._extent[kind]), kind), default="object")

    def _names(self, word: str, name: str, count: int) -> list[str]:
        own = self._program.variables.get((word, name), ())
        return (
            [f"?{each}" for each in own]
            if len(own) == count
            else [f"?x{number + 1}" for number in range(count)]
        )

    def _parameters(self, names: Sequence[str], uses: Iterable[Arguments]) -> tuple[str, list[str]]:
        columns = list(zip(*uses, strict=True)) or [()] * len(names)
        kinds = [self._kind(column) for column in columns]
        said = (f"{one} - {kind}" for one, kind in zip(names, kinds, strict=True))
        return " ".join(said), kinds

    def written(self, name: str) -> tuple[str, str]:
        program = self._program
        by_name: dict[str, list[Atom]] = defaultdict(list)
        for action in program.actions:
            by_name[action.predicate].append(action)
        actions = [self._action(each, by_name[each]) for each in sorted(by_name)]
        axioms = [
            self._axiom(each) for each in sorted({head.predicate for head, _ in program.rules})
        ]
        predicates = [self._predicate(each) for each in sorted(self._uses)]
        guards = self._guards.facts
        for guard, uses in sorted(guards.items()):
            count = len(next(iter(uses)))
            predicates.append(f"({guard} {' '.join(f'?x{n + 1}' for n in range(count))})")
        functions = sorted({each.predicate for each in program.costs})
        numbers = [f"(cost-{each} {self._cost_parameters(by_name[each])})" for each in functions]
        total = ["(:functions (total-cost) - number", *numbers, ")"] if program.costs else []
        domain = [
            f"(define (domain {name})",
            f"(:requirements {' '.join(self._requirements())})",
            f"(:types {' '.join(self._types())})",
            "(:constants",
            *(f"  {thing} - {program.types.get(thing, 'object')}" for thing in self._objects),
            ")",
            "(:predicates",
            *predicates,
            ")",
            *total,
            *axioms,
            *actions,
            ")",
        ]
        facts = [atom.pddl() for atom in sorted(program.init)]
        facts += [
            Atom(guard, uses).pddl()
            for guard, all_ in sorted(guards.items())
            for uses in sorted(all_)
        ]
        if program.costs:
            facts.append("(= (total-cost) 0)")
            facts += [
                f"(= {Atom(f'cost-{action.predicate}', action.arguments).pddl()} "
                f"{program.costs.get(action, 1)})"
                for action in program.actions
                if action.predicate in functions
            ]
        problem = [
            f"(define (problem {name}) (:domain {name})",
            "(:init",
            *(f"  {fact}" for fact in facts),
            ")",
            f"(:goal (and {' '.join(map(_literal, sorted(program.goal)))}))",
            *(["(:metric minimize (total-cost))"] if program.costs else []),
            ")",
        ]
        return "\n".join(domain) + "\n", "\n".join(problem) + "\n"

    def _requirements(self) -> list[str]:
        named = [":typing", ":equality", ":negative-preconditions", ":disjunctive-preconditions"]
        named.append(":conditional-effects")
        if self._program.rules:
            named.append(":derived-predicates")
        return [*named, *([":action-costs"] if self._program.costs else [])]

    def _types(self) -> list[str]:
        parents = self._program.parents
        return [f"{kind} - {parents.get(kind, 'object')}" for kind in sorted(self._extent)]

    def _predicate(self, name: str) -> str:
        uses = self._uses[name]
        names = self._names("fluent", name, len(next(iter(uses))))
        return f"  ({name} {self._parameters(names, uses)[0]})"

    def _cost_parameters(self, actions: Sequence[Atom]) -> str:
        count = len(actions[0].arguments)
        names = [f"?x{n + 1}" for n in range(count)]
        return self._parameters(names, [each.arguments for each in actions])[0]

    def _action(self, name: str, actions: Sequence[Atom]) -> str:
        program = self._program
        names = self._names("action", name, len(actions[0].arguments))
        instances = frozenset(each.arguments for each in actions)
        said, kinds = self._parameters(names, instances)
        fitting = [sorted(self._extent.get(kind, self._objects)) for kind in kinds]
        conditions = []
        small = prod(map(len, fitting)) <= _LISTED
        others = frozenset(product(*fitting)) - instances if small else None
        guard = self._guards.condition(f"may-{name}", names, instances, others)
        conditions += [guard] if guard else []
        needs: dict[Arguments, list[Item]] = {
            each.arguments: [(tuple(sorted(clause)), None) for clause in program.needs[each]]
            for each in actions
        }
        for (clause, _), having in patterns(needs, names):
            guard = self._guards.condition(f"if-{name}", names, having, instances - having)
            parts = [f"(not {guard})"] * bool(guard) + [_literal(each) for each in clause]
            conditions.append(parts[0] if len(parts) == 1 else f"(or {' '.join(parts)})")
        effects: dict[Arguments, list[Item]] = {
            each.arguments: [
                (tuple(sorted(under)), literal) for under, literal in program.effects[each]
            ]
            for each in actions
        }
        results = []
        for (under, literal), having in patterns(effects, names):
            assert literal is not None
            guard = self._guards.condition(f"if-{name}", names, having, instances - having)
            parts = [guard] * bool(guard) + [_literal(each) for each in under]
            effect = _literal(literal)
            results.append(f"(when (and {' '.join(parts)}) {effect})" if parts else effect)
        if any(each in program.costs for each in actions):
            results.append(f"(increase (total-cost) (cost-{' '.join([name, *names])}))")
        elif program.costs:
            results.append("(increase (total-cost) 1)")
        return (
            f"(:action {name} :parameters ({said})\n"
            f"  :precondition (and {' '.join(conditions)})\n"
            f"  :effect (and {' '.join(results)}))"
        )

    def _axiom(self, name: str) -> str:
        rules = sorted(
            (head, sorted(under)) for head, under in self._program.rules if head.predicate == name
        )
        names = [f"?x{n + 1}" for n in range(len(rules[0][0].arguments))]
        said, _ = self._parameters(names, [head.arguments for head, _ in rules])
        ways = []
        for head, under in rules:
            same = [f"(= {one} {thing})" for one, thing in zip(names, head.arguments, strict=True)]
            ways.append(f"(and {' '.join([*same, *map(_literal, under)])})")
        return f"(:derived ({name} {said}) (or {' '.join(ways)}))"


def _literal(literal: Literal) -> str:
    said = literal.atom.pddl()
    return said if literal.positive else f"(not {said})"
