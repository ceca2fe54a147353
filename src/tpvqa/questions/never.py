"""Facts that no camera shows, as patterns: (free ?h), (not (near ?x))."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from tpvqa.pddl import Literal

_NEGATED = re.compile(r"\(\s*not\s*\(([^()]*)\)\s*\)")
_PLAIN = re.compile(r"\(([^()]*)\)")


@dataclass(frozen=True, slots=True)
class NeverAsked:
    """A pattern of literals that are not asked about.

    Attributes:
        predicate: The predicate.
        terms: An object, or a variable such as `?x`; the same variable is the same object. With
            `actions` given, a variable named like a parameter is the action's own argument.
        types: The type a variable must have; None for any.
        positive: False for the negative literal alone; None for both.
        actions: The actions at which it is not asked; empty for everywhere.
        because: Why, in words.
    """

    predicate: str
    terms: tuple[str, ...]
    types: tuple[str | None, ...]
    positive: bool | None = None
    actions: frozenset[str] = frozenset()
    because: str = ""

    @staticmethod
    def parse(text: str) -> "NeverAsked":
        """Read `(free ?h)`, `(near ?x - container)` or `(not (on ?x fridge))`.

        Raises:
            ValueError: It is not such a pattern.
        """
        written = text.strip().lower()
        negated = _NEGATED.fullmatch(written)
        plain = negated or _PLAIN.fullmatch(written)
        words = plain[1].split() if plain else []
        if not words or words[0] in ("not", "and", "or") or words[0].startswith("?"):
            raise ValueError(
                f"{text!r} is not a fact; write it as (predicate ?x ?y) or (not (predicate ?x ?y))"
            )
        terms: list[str] = []
        types: list[str | None] = []
        rest = iter(words[1:])
        for word in rest:
            if word != "-":
                terms.append(word)
                types.append(None)
                continue
            kind = next(rest, None)
            if kind is None or not terms or not terms[-1].startswith("?") or types[-1]:
                raise ValueError(f"{text!r}: a dash stands between a variable and its type")
            types[-1] = kind
        return NeverAsked(words[0], tuple(terms), tuple(types), False if negated else None)

    def matches(
        self,
        literal: Literal,
        action: str | None,
        arguments: Mapping[str, str],
        is_a: Callable[[str, str], bool],
    ) -> bool:
        """Whether a literal is not asked about at an action.

        Args:
            literal: The literal.
            action: The action's name; None where the question belongs to none.
            arguments: The action's arguments by parameter, without the question mark.
            is_a: Whether an object is of a type.
        """
        atom = literal.atom
        if atom.predicate != self.predicate or self.positive not in (None, literal.positive):
            return False
        if self.actions and action not in self.actions:
            return False
        bound = {f"?{name}": value for name, value in arguments.items()} if self.actions else {}
        for term, kind, value in zip(self.terms, self.types, atom.arguments, strict=True):
            if kind is not None and not is_a(value, kind):
                return False
            if not term.startswith("?"):
                if term != value:
                    return False
            elif bound.setdefault(term, value) != value:
                return False
        return True

    @property
    def everywhere(self) -> bool:
        """Whether it takes in every literal of its predicate, whatever the action."""
        plain = all(kind is None for kind in self.types) and not self.actions
        variables = {term for term in self.terms if term.startswith("?")}
        return plain and self.positive is None and len(variables) == len(self.terms)
