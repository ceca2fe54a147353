"""Ground actions of one name → one action with variables: what all share, and what only some have.

What only some instances have stands under a guard: a condition on the action's arguments that holds
for just those. An equality of objects does where one says it; else a static fact.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product

from tpvqa.pddl.atoms import Literal

Item = tuple[tuple[Literal, ...], Literal | None]
"""A clause, or the conditions of an effect with the effect."""

Arguments = tuple[str, ...]

PATTERNS = 500
"""Of more things that only some instances have no action is made."""


class IrregularError(Exception):
    """The instances of an action have too little in common."""


@dataclass
class Guards:
    """Static facts that tell for which arguments something is so."""

    facts: dict[str, frozenset[Arguments]] = field(default_factory=dict)

    def condition(
        self,
        stem: str,
        names: Sequence[str],
        inside: frozenset[Arguments],
        outside: frozenset[Arguments] | None,
    ) -> str:
        """PDDL that holds for the arguments inside and not for those outside; empty for all.

        Args:
            stem: How a static fact may be called.
            names: The variables.
            inside: Arguments.
            outside: The other arguments that there are; None for too many to be listed.
        """
        said = None if outside is None else _equality(names, inside, outside)
        if said is not None:
            return said
        predicate = f"{stem}-{sum(each.startswith(stem) for each in self.facts) + 1}"
        self.facts[predicate] = inside
        return f"({' '.join([predicate, *names])})"


def _equality(
    names: Sequence[str], inside: frozenset[Arguments], outside: frozenset[Arguments]
) -> str | None:
    """A guard that is said by equalities, where there is one."""
    if not outside:
        return ""
    for place, name in enumerate(names):
        values = {each[place] for each in inside}
        others = {each[place] for each in outside}
        if values.isdisjoint(others):
            if len(others) < len(values) and len(others) <= 4:
                return _all(f"(not (= {name} {value}))" for value in sorted(others))
            if len(values) <= 4:
                same = [f"(= {name} {value})" for value in sorted(values)]
                return same[0] if len(same) == 1 else f"(or {' '.join(same)})"
    for one, name in enumerate(names):
        for other in range(one + 1, len(names)):
            if all((each[one] == each[other]) != (each in inside) for each in inside | outside):
                return f"(not (= {name} {names[other]}))"
            if all((each[one] == each[other]) == (each in inside) for each in inside | outside):
                return f"(= {name} {names[other]})"
    return None


def patterns(
    items: Mapping[Arguments, Iterable[Item]], names: Sequence[str]
) -> list[tuple[Item, frozenset[Arguments]]]:
    """What the instances of an action have, each with variables and with those that have it.

    Args:
        items: What each instance has, by its arguments.
        names: The variables of the arguments.
    """
    all_of = {arguments: frozenset(each) for arguments, each in items.items()}
    left = {arguments: set(each) for arguments, each in all_of.items()}
    found: list[tuple[Item, frozenset[Arguments]]] = []
    # The most general instances first, so that what holds of all is not said of ?a = ?b alone.
    for arguments in sorted(left, key=lambda each: (-len(set(each)), each)):
        while left[arguments]:
            item = min(left[arguments], key=repr)
            ways = [
                (pattern, frozenset(a for a in all_of if _put(pattern, names, a) in all_of[a]))
                for pattern in _lifted(item, names, arguments)
            ]
            pattern, having = max(ways, key=lambda way: (len(way[1]), _variables(way[0])))
            for each in having:
                left[each].discard(_put(pattern, names, each))
            found.append((pattern, having))
            if len(found) > PATTERNS:
                raise IrregularError
    return found


def _lifted(item: Item, names: Sequence[str], arguments: Arguments) -> Iterable[Item]:
    """An item with variables for some of its objects, in all ways that give it back."""
    literals, effect = item
    atoms = [each.atom for each in (*literals, *([effect] if effect else []))]
    objects = sorted({name for atom in atoms for name in atom.arguments})
    ways = [
        [*(names[place] for place, own in enumerate(arguments) if own == thing), thing]
        for thing in objects
    ]
    for choice in product(*ways):
        chosen = dict(zip(objects, choice, strict=True))
        yield _mapped(item, lambda name, chosen=chosen: chosen[name])  # type: ignore[misc]


def _put(item: Item, names: Sequence[str], arguments: Arguments) -> Item:
    values = dict(zip(names, arguments, strict=True))
    return _mapped(item, lambda name: values.get(name, name))


def _mapped(item: Item, into: Callable[[str], str]) -> Item:
    def literal(each: Literal) -> Literal:
        atom = each.atom
        return Literal(atom._replace(arguments=tuple(map(into, atom.arguments))), each.positive)

    literals, effect = item
    return tuple(sorted(map(literal, literals))), effect and literal(effect)


def _variables(item: Item) -> int:
    literals, effect = item
    atoms = [each.atom for each in (*literals, *([effect] if effect else []))]
    return sum(name.startswith("?") for atom in atoms for name in atom.arguments)


def _all(parts: Iterable[str]) -> str:
    said = list(parts)
    return said[0] if len(said) == 1 else f"(and {' '.join(said)})"
