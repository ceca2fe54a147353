"""Why there is no plan: what the goal needs and nothing can bring about.

Found where it shows even if nothing were ever undone (the delete relaxation: Bonet and Geffner
2001); where a plan fails for other reasons, there is nothing to say.
"""

from collections.abc import Iterator
from itertools import islice, permutations, product

from tpvqa.pddl import Action, Atom, Conjunction, Disjunction, Literal, State, Task
from tpvqa.pddl.conditions import Condition
from tpvqa.pddl.schema import ActionSchema, EffectSchema

_TRIED = 2000
"""Ways to give objects to an action's variables that are looked at."""
_COMPARED = 100
"""Obstacles that are compared."""


def obstacle(task: Task, state: State) -> str:
    """What stands between a state and the goal, in words; empty where it cannot be told.

    Args:
        task: The task.
        state: From where there is no plan.
    """
    possible = task.reachable_atoms | state
    for goal in _unmet(task.goal, possible):
        roots = list(islice(_roots(task, goal, possible, set()), _COMPARED))
        if roots:
            action, atom = min(roots, key=lambda root: _odd(root[1], state))
            needs = f"{goal}; {action} needs {atom}" if action else str(goal)
            return f"the goal needs {needs}, which nothing brings about{_instead(atom, state)}"
    return ""


def _unmet(condition: Condition, possible: State) -> list[Atom]:
    """Atoms that a condition needs and that never hold; of a disjunction the fewest."""
    match condition:
        case Literal(atom, positive):
            return [atom] if positive and atom not in possible else []
        case Conjunction(parts):
            return [atom for part in parts for atom in _unmet(part, possible)]
        case Disjunction(parts):
            return min((_unmet(part, possible) for part in parts), key=len, default=[])


def _roots(
    task: Task, atom: Atom, possible: State, seen: set[Atom]
) -> Iterator[tuple[Action | None, Atom]]:
    """Atoms that no action says, each with the action on the way to the goal that needs it."""
    seen.add(atom)
    if atom.predicate in task.derived:
        return
    achievers = list(islice(_achievers(task, atom), _TRIED))
    if not achievers:
        yield None, atom
        return
    unmet = {action: _unmet(action.precondition, possible) for action in achievers}
    fewest = min(map(len, unmet.values()))
    for action, needs in unmet.items():
        for need in needs if len(needs) == fewest else ():
            if need not in seen:
                for below, root in _roots(task, need, possible, seen):
                    yield below or action, root


def _achievers(task: Task, atom: Atom) -> Iterator[Action]:
    """Actions whose effects say an atom, reachable or not; so many only."""
    for schema in task.schemas:
        for effect in schema.effects:
            if effect.literal.positive and effect.literal.predicate == atom.predicate:
                for arguments in _fitting(task, schema, effect, atom):
                    yield task.action(schema.name, arguments)


def _fitting(
    task: Task, schema: ActionSchema, effect: EffectSchema, atom: Atom
) -> Iterator[tuple[str, ...]]:
    bound: dict[str, str] = {}
    for word, name in zip(effect.literal.arguments, atom.arguments, strict=True):
        if (word if not word.startswith("?") else bound.setdefault(word, name)) != name:
            return
    choices = []
    for parameter in schema.parameters:
        objects = task.objects_by_type.get(parameter.type, ())
        wanted = bound.get(parameter.name)
        choices.append(objects if wanted is None else tuple(o for o in objects if o == wanted))
    yield from product(*choices)


def _odd(atom: Atom, state: State) -> int:
    """Orders obstacles: those first that look most like a mistake."""
    if _turned(atom, state):
        return 0
    return 2 if any(each.predicate == atom.predicate for each in state) else 1


def _turned(atom: Atom, state: State) -> Atom | None:
    """The same fact with its arguments in another order, where that holds."""
    turned = (Atom(atom.predicate, arguments) for arguments in permutations(atom.arguments))
    return next((each for each in turned if each != atom and each in state), None)


def _instead(atom: Atom, state: State) -> str:
    """What holds in place of an atom."""
    turned = _turned(atom, state)
    if turned:
        return f" ({turned} holds: are its arguments in the right order?)"
    same = sorted(each for each in state if each.predicate == atom.predicate)
    told = f" ({', '.join(map(str, same[:3]))} does)" if same else ""
    return f" and which does not hold{told}"
