"""A proof that a goal is out of reach, for tasks that are too large to be grounded.

Objects that are alike, of one type and with the same static facts about them alone, are taken for
one: whatever one of them could do, it can. Nothing is ever undone, and no condition is negative.
What cannot be reached so cannot be reached at all (an abstraction by a homomorphism, of the
delete relaxation).
"""

from collections.abc import Iterable, Mapping
from typing import Any

from fast_downward.translate import build_model, pddl, pddl_to_prolog

from tpvqa.pddl.worker.grounding import AtomKey, to_fact


def out_of_reach(
    task: Any,
    static: frozenset[AtomKey],
    fluent: frozenset[AtomKey],
    *,
    named: frozenset[str],
    numbers: Iterable[Any] = (),
) -> bool:
    """Whether it is proved that no plan leads from a state to the goal.

    Args:
        task: The translator's normalised task.
        static: The facts that no action changes.
        fluent: The other facts of the state.
        named: The objects that actions, axioms and goal name; each is like none but itself.
        numbers: The values of the functions of action costs.
    """
    alike = _stand_ins(task.objects, static, named)
    facts = {(key[0], *(alike[name] for name in key[1:])) for key in static | fluent}
    objects = task.objects
    try:
        task.objects = [each for each in objects if alike[each.name] == each.name]
        task.init = [
            *(pddl.Atom("=", (each.name, each.name)) for each in task.objects),
            *map(to_fact, sorted(facts)),
            *_numbers(numbers, alike),
        ]
        model = build_model.compute_model(pddl_to_prolog.translate(task))
    finally:
        task.objects = objects
    return all(atom.predicate != "@goal-reachable" for atom in model)


def _stand_ins(
    objects: Iterable[Any], static: Iterable[AtomKey], named: frozenset[str]
) -> Mapping[str, str]:
    """For each object the one that stands for it."""
    about: dict[str, set[str]] = {}
    for key in static:
        if len(key) == 2:
            about.setdefault(key[1], set()).add(key[0])
    first: dict[tuple[str, frozenset[str], str], str] = {}
    return {
        each.name: first.setdefault(
            (
                each.type_name,
                frozenset(about.get(each.name, ())),
                each.name if each.name in named else "",
            ),
            each.name,
        )
        for each in objects
    }


def _numbers(numbers: Iterable[Any], alike: Mapping[str, str]) -> list[Any]:
    """The values, each function once."""
    found = {}
    for fact in numbers:
        key = (fact.fluent.symbol, tuple(alike[name] for name in fact.fluent.args))
        if key not in found:
            found[key] = pddl.Assign(pddl.PrimitiveNumericExpression(*key), fact.expression)
    return list(found.values())
