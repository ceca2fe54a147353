"""A kind of domain with problems that are drawn by chance."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise
from random import Random

Drawn = tuple[dict[str, list[str]], list[str], list[str]]
"""Objects by type, what holds at first, and the goal."""


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of domain.

    Attributes:
        types: Its types, as PDDL lists them.
        actions: Its actions: name, typed parameters, precondition, effect.
        predicates: Its predicates, as PDDL lists them.
        problem: Draws one by chance.
    """

    types: str
    predicates: str
    actions: tuple[tuple[str, str, str, str], ...]
    problem: Callable[[Random], Drawn]

    def domain(self, name: str) -> str:
        """The text of the domain."""
        lines = [
            f"  (:action {action}\n    :parameters ({parameters})\n"
            f"    :precondition (and {before})\n    :effect (and {after}))"
            for action, parameters, before, after in self.actions
        ]
        head = f"(define (domain {name})\n  (:requirements :strips :typing)\n"
        head += f"  (:types {self.types})\n  (:predicates {self.predicates})\n"
        return head + "\n".join(lines) + ")\n"

    def drawn(self, name: str, seed: int) -> str:
        """The text of a problem."""
        objects, init, goal = self.problem(Random(f"{name} {seed}"))
        typed = " ".join(f"{' '.join(names)} - {each}" for each, names in objects.items())
        return (
            f"(define (problem {name})\n  (:domain {name})\n  (:objects {typed})\n"
            f"  (:init {_facts(init)})\n  (:goal (and {_facts(goal)})))\n"
        )


def _facts(facts: Iterable[str]) -> str:
    return " ".join(f"({each})" for each in facts)


def named(name: str, count: int) -> list[str]:
    return [f"{name}{number}" for number in range(1, count + 1)]


def chain(word: str, names: list[str]) -> list[str]:
    """A fact for every two neighbours."""
    return [f"{word} {a} {b}" for a, b in pairwise(names)]


def roads(word: str, names: list[str], random: Random, more: int = 1) -> list[str]:
    """Two-way links that lead everywhere: a tree, and some more."""
    pairs = [(b, random.choice(names[:n])) for n, b in enumerate(names) if n]
    others = [(a, b) for a in names for b in names if a < b and not {(a, b), (b, a)} & set(pairs)]
    pairs += random.sample(others, min(more, len(others)))
    return [fact for a, b in pairs for fact in (f"{word} {a} {b}", f"{word} {b} {a}")]
