"""Which objects make a rule's body hold in a state, or leave little of it to be brought about."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import islice

from tpvqa.pddl.worker.grounding import AtomKey
from tpvqa.pddl.worker.rules import Literal, Rule, Rules, Words

Binding = dict[str, str]

_DEEP = 40
"""Derived facts that rest on each other; further ones are taken not to hold."""
_ALL = 1 << 30
_MUST, _MAY, _OPEN = "holds", "may hold", "is left open"
_Pending = tuple[str, Literal]
"""Whether a literal of a body has to hold, and the literal as far as it is bound."""


class Matcher:
    """Looks facts up in a state, derived ones included.

    Args:
        rules: The rules of the task.
        state: The atoms that hold, static ones included, derived ones not.
    """

    def __init__(self, rules: Rules, state: frozenset[AtomKey]):
        self._rules = rules
        self._state = state
        self._facts: dict[str, list[Words]] = {}
        self._index: dict[tuple[str, int], dict[str, list[Words]]] = {}
        self._derived: dict[Literal, bool] = {}
        self._deep = 0
        self._brought: dict[Literal, list[set[str]]] = {}
        self.preferred: dict[str, None] = {}
        """Objects that free variables stand for rather than others."""
        for key in sorted(state):
            self._facts.setdefault(key[0], []).append(key[1:])

    def holds(self, literal: Literal) -> bool:
        """Whether a ground literal holds in the state."""
        if literal.predicate == "=":
            return (literal.arguments[0] == literal.arguments[1]) == literal.positive
        if literal.predicate in self._rules.derived:
            return self._follows(literal) == literal.positive
        return ((literal.predicate, *literal.arguments) in self._state) == literal.positive

    def _follows(self, literal: Literal) -> bool:
        atom = literal if literal.positive else literal.negate()
        if atom not in self._derived:
            self._derived[atom] = False  # until it is known: nothing follows from itself
            self._derived[atom] = next(self.reasons(atom), None) is not None
        return self._derived[atom]

    def reasons(self, atom: Literal) -> Iterator[tuple[Rule, Binding]]:
        """The axioms by which a derived atom holds in the state, with their objects."""
        if self._deep >= _DEEP:
            return
        self._deep += 1
        try:
            for rule in self._rules.by_head.get((True, atom.predicate), ()):
                binding = unified(rule, atom)
                if binding is not None:
                    body = [(_MUST, literal) for literal in rule.body]
                    for found, _ in self._extended(rule, binding, body, (), 0, _ALL):
                        yield rule, found
        finally:
            self._deep -= 1

    def supports(
        self, rule: Rule, binding: Binding, *, spare: int, most: int
    ) -> list[tuple[Binding, tuple[Literal, ...]]]:
        """Objects for all variables of a rule, with what of its body does not hold.

        Static parts of the body hold; the fewer of the others are open, the earlier it comes.

        Args:
            rule: The rule.
            binding: The objects that some of its variables stand for.
            spare: So many literals may be left open though they hold for some objects.
            most: So many at most.
        """
        body = [
            (_MUST if literal.predicate in self._rules.static else _MAY, literal)
            for literal in rule.body
        ]
        found = {
            tuple(each[word] for word in rule.variables): (each, missing)
            for each, missing in islice(
                self._extended(rule, binding, body, (), spare, most), 4 * most
            )
        }
        return sorted(found.values(), key=lambda each: len(each[1]))[:most]

    def _extended(
        self,
        rule: Rule,
        binding: Binding,
        pending: Sequence[_Pending],
        missing: tuple[Literal, ...],
        spare: int,
        most: int,
    ) -> Iterator[tuple[Binding, tuple[Literal, ...]]]:
        """Joins the body with the facts, those literals first that leave the fewest choices."""
        rest: list[_Pending] = []
        for how, literal in pending:
            bound = literal.bound(binding)
            if any(word[0] == "?" for word in bound.arguments):
                rest.append((how, bound))
            elif not self.holds(bound):
                if how is _MUST:
                    return
                missing = (*missing, bound)
        best: tuple[tuple[bool, int], int, list[Words]] | None = None
        for place, (how, literal) in enumerate(rest):
            if how is _OPEN or not literal.positive or literal.predicate == "=":
                continue
            facts = self._matching(literal)
            if facts:
                alone = all(word[0] == "?" for word in literal.arguments)
                if best is None or (alone, len(facts)) < best[0]:
                    best = (alone, len(facts)), place, facts
            elif how is _MUST:
                return
        if best is not None:
            _, place, facts = best
            how, literal = rest[place]
            some = False
            for arguments in facts[: 4 * most]:
                more = self._with(rule, binding, literal.arguments, arguments)
                if more is not None:
                    for each in self._extended(rule, more, rest, missing, spare, most):
                        some = True
                        yield each
            if how is _MAY and (spare or not some):
                rest[place] = (_OPEN, literal)
                yield from self._extended(rule, binding, rest, missing, spare - some, most)
            return
        free = next((word for word in rule.variables if word not in binding), None)
        if free is None:
            yield binding, tuple(dict.fromkeys(missing))
            return
        fitting = self._possible(rule, binding, free)
        names = [name for name in self.preferred if name in fitting]
        others = (name for name in fitting if name not in self.preferred)
        for name in [*names, *islice(others, most)][:most]:
            yield from self._extended(rule, {**binding, free: name}, rest, missing, spare, most)

    def _possible(self, rule: Rule, binding: Binding, variable: str) -> Mapping[str, None]:
        """The objects for a variable with which an action can bring the body about at all."""
        fitting = rule.variables[variable]
        for literal in rule.body:
            if (
                not literal.positive
                or literal.predicate == "="
                or variable not in literal.arguments
            ):
                continue
            bound = literal.bound(binding)
            if bound not in self._brought:
                self._brought[bound] = self._bringable(bound)
            place = literal.arguments.index(variable)
            names = self._brought[bound][place]
            fitting = {name: None for name in fitting if name in names}
        return fitting

    def _bringable(self, literal: Literal) -> list[set[str]]:
        """What may stand at each place of a literal with variables, now or after some action."""
        found: list[set[str]] = [set() for _ in literal.arguments]
        for rule in self._rules.by_head.get((True, literal.predicate), ()):
            if unified(rule, literal) is not None:
                for place, word in zip(found, rule.head.arguments, strict=True):
                    place.update(rule.variables[word] if word[0] == "?" else (word,))
        if literal.predicate not in self._rules.derived:
            for arguments in self._matching(literal):
                for place, name in zip(found, arguments, strict=True):
                    place.add(name)
        return found

    def _with(self, rule: Rule, binding: Binding, words: Words, arguments: Words) -> Binding | None:
        more = dict(binding)
        for word, name in zip(words, arguments, strict=True):
            if word[0] == "?" and (
                more.setdefault(word, name) != name or name not in rule.variables[word]
            ):
                return None
        return more

    def _matching(self, literal: Literal) -> list[Words]:
        """The arguments of the facts that a literal with variables fits."""
        if literal.predicate in self._rules.derived:
            return list(
                dict.fromkeys(
                    rule.head.bound(binding).arguments for rule, binding in self.reasons(literal)
                )
            )
        facts, bound = self._facts.get(literal.predicate, []), 0
        for place, word in enumerate(literal.arguments):
            if word[0] != "?":
                bound += 1
                bucket = self._bucket(literal.predicate, place).get(word, [])
                if bound == 1 or len(bucket) < len(facts):
                    facts = bucket
        if bound < 2:
            return facts
        return [each for each in facts if _fits(literal.arguments, each)]

    def _bucket(self, predicate: str, place: int) -> Mapping[str, list[Words]]:
        index = self._index.get((predicate, place))
        if index is None:
            index = self._index[predicate, place] = {}
            for arguments in self._facts.get(predicate, ()):
                index.setdefault(arguments[place], []).append(arguments)
        return index


def unified(rule: Rule, literal: Literal) -> Binding | None:
    """The objects with which a rule's head says a literal; None where it cannot.

    Variables of the literal leave those of the head free.
    """
    binding: Binding = {}
    for word, name in zip(rule.head.arguments, literal.arguments, strict=True):
        if name[0] == "?":
            continue
        if word[0] != "?":
            if word != name:
                return None
        elif binding.setdefault(word, name) != name or name not in rule.variables[word]:
            return None
    return binding


def _fits(words: Sequence[str], arguments: Sequence[str]) -> bool:
    return all(word[0] == "?" or word == name for word, name in zip(words, arguments, strict=True))
