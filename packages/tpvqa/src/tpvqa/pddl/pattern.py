"""Facts with variables, as users write them in their files: (on ?x ?d - dish)."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from tpvqa.errors import PDDLError, a, suggestion, suggestion_or_list
from tpvqa.pddl.atoms import Atom
from tpvqa.pddl.task import Task

_FACT = re.compile(r"\(([^()]*)\)")

Binding = Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Pattern:
    """A form of facts of one task.

    Attributes:
        predicate: The predicate.
        terms: Objects, and variables such as `?x`; the same variable is the same object.
        types: The type that each variable must have; None for any.
    """

    predicate: str
    terms: tuple[str, ...]
    types: tuple[str | None, ...]

    @staticmethod
    def parse(text: str, task: Task) -> "Pattern":
        """Read `(free ?h)` or `(near ?x - container)` and see that it fits the task.

        Raises:
            PDDLError: It is no fact, speaks of what the task does not know, or no fact of the
                task can ever have this form.
        """
        whole = _FACT.fullmatch(text.strip().lower())
        words = whole[1].split() if whole else []
        if not words or words[0] in ("not", "and", "or") or words[0].startswith("?"):
            raise PDDLError(f"{text!r} is not a fact; write it as (predicate ?x …)")
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
                raise PDDLError(f"{text!r}: a dash stands between a variable and its type")
            types[-1] = kind
        pattern = Pattern(words[0], tuple(terms), tuple(types))
        pattern._check(task)
        return pattern

    def __str__(self) -> str:
        words = [
            term if kind is None else f"{term} - {kind}"
            for term, kind in zip(self.terms, self.types, strict=True)
        ]
        return f"({' '.join((self.predicate, *words))})"

    @property
    def variables(self) -> frozenset[str]:
        """The variables in it."""
        return frozenset(term for term in self.terms if term.startswith("?"))

    def match(self, atom: Atom, binding: Binding, task: Task) -> dict[str, str] | None:
        """The binding under which it is this atom; None where there is none."""
        if atom.predicate != self.predicate or len(atom.arguments) != len(self.terms):
            return None
        bound = dict(binding)
        for term, kind, value in zip(self.terms, self.types, atom.arguments, strict=True):
            if kind is not None and value not in task.objects_by_type.get(kind, ()):
                return None
            if not term.startswith("?"):
                if term != value:
                    return None
            elif bound.setdefault(term, value) != value:
                return None
        return bound

    def ground(self, binding: Binding) -> Atom:
        """The atom under a binding of all its variables."""
        return Atom(self.predicate, tuple(binding.get(term, term) for term in self.terms))

    def _check(self, task: Task) -> None:
        declared = task.predicates.get(self.predicate)
        if declared is None:
            raise PDDLError(
                f"{self}: the domain has no predicate {self.predicate!r}"
                + suggestion_or_list(self.predicate, task.predicates)
            )
        if len(declared) != len(self.terms):
            raise PDDLError(
                f"{self}: {self.predicate} takes {len(declared)} objects "
                f"({', '.join(declared) or 'none'}), this has {len(self.terms)}"
            )
        for term, kind, wanted in zip(self.terms, self.types, declared, strict=True):
            if kind is not None and kind not in task.types:
                raise PDDLError(
                    f"{self}: the domain has no type {kind!r}"
                    + suggestion_or_list(kind, task.types)
                )
            if kind is not None and not task.related(kind, wanted):
                raise PDDLError(
                    f"{self}: {term} can be no {kind}, as {self.predicate} takes {a(wanted)} there"
                )
            if term.startswith("?"):
                continue
            if term not in task.objects:
                raise PDDLError(
                    f"{self}: this problem has no object {term!r}{suggestion(term, task.objects)} "
                    "A variable starts with a question mark"
                )
            if not task.is_a(term, wanted):
                raise PDDLError(
                    f"{self}: {term} is {a(task.objects[term])}, but {self.predicate} takes "
                    f"{a(wanted)} there"
                )


def check_together(patterns: Iterable[Pattern], task: Task) -> None:
    """See that some object can stand for each variable in all patterns that speak of it.

    Raises:
        PDDLError: None can, as the predicates are declared.
    """
    possible: dict[str, frozenset[str]] = {}
    for pattern in patterns:
        declared = task.predicates[pattern.predicate]
        for term, kind, wanted in zip(pattern.terms, pattern.types, declared, strict=True):
            if not term.startswith("?"):
                continue
            fitting = frozenset(
                name
                for name in task.objects
                if task.is_a(name, wanted) and (kind is None or task.is_a(name, kind))
            )
            before = possible.get(term, fitting)
            possible[term] = before & fitting
            # A problem without objects of a type says nothing about the file.
            if before and fitting and not possible[term]:
                raise PDDLError(
                    f"{pattern}: {term} must be {a(kind or wanted)} here, but what it stands for "
                    "before is none"
                )
