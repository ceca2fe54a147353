"""Why there is no plan: what the goal needs and nothing can bring about.

Found where it shows even if nothing were ever undone (the delete relaxation: Bonet and Geffner
2001); where a plan fails for other reasons, there is nothing to say.
"""

from collections import deque
from collections.abc import Iterator
from itertools import islice, permutations, product

from tpvqa.pddl import Atom, Conjunction, Disjunction, Literal, State, Task
from tpvqa.pddl.conditions import Condition
from tpvqa.pddl.schema import ActionSchema, EffectSchema, ground_condition

_TRIED = 5000
"""Actions that are looked at, reachable or not, before it is left unsaid."""
_COMPARED = 100
"""Obstacles that are compared."""
_TURNED = 4
"""Arguments whose order is thought about."""


def obstacle(task: Task, state: State) -> str:
    """What stands between a state and the goal, in words; empty where it cannot be told.

    Args:
        task: The task.
        state: From where there is no plan.
    """
    if task.left_out:
        return ""  # what they can bring about is not known
    possible = task.reachable_atoms | state
    for goal in _unmet(task.goal, possible):
        roots = list(islice(_roots(task, goal, possible), _COMPARED))
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


def _roots(task: Task, goal: Atom, possible: State) -> Iterator[tuple[str, Atom]]:
    """Atoms that no action says, each with the action on the way to the goal that needs it."""
    waiting, seen, tried = deque([("", goal)]), {goal}, 0
    while waiting:
        action, atom = waiting.popleft()
        if atom.predicate in task.derived:
            continue
        unmet = {
            said: _unmet(precondition, possible)
            for said, precondition in islice(_achievers(task, atom), _TRIED - tried)
        }
        tried += len(unmet)
        if tried >= _TRIED:
            return
        if not unmet:
            yield action, atom
            continue
        fewest = min(map(len, unmet.values()))
        for said, needs in unmet.items():
            for need in needs if len(needs) == fewest else ():
                if need not in seen:
                    seen.add(need)
                    waiting.append((said, need))


def _achievers(task: Task, atom: Atom) -> Iterator[tuple[str, Condition]]:
    """Actions whose effects say an atom, reachable or not, and what they need."""
    for schema in task.schemas:
        for effect in schema.effects:
            if effect.literal.positive and effect.literal.predicate == atom.predicate:
                for binding in _fitting(task, schema, effect, atom):
                    said = f"{schema.name}({', '.join(binding.values())})"
                    yield said, ground_condition(schema.precondition, binding, task.objects_by_type)


def _fitting(
    task: Task, schema: ActionSchema, effect: EffectSchema, atom: Atom
) -> Iterator[dict[str, str]]:
    """Objects for an action's variables with which an effect says an atom."""
    bound: dict[str, str] = {}
    for word, name in zip(effect.literal.arguments, atom.arguments, strict=True):
        if (bound.setdefault(word, name) if word.startswith("?") else word) != name:
            return
    names = [parameter.name for parameter in schema.parameters]
    choices = []
    for parameter in schema.parameters:
        objects = task.objects_by_type.get(parameter.type, ())
        wanted = bound.get(parameter.name)
        choices.append(objects if wanted is None else tuple(o for o in objects if o == wanted))
    for choice in product(*choices):
        yield dict(zip(names, choice, strict=True))


def _odd(atom: Atom, state: State) -> int:
    """Orders obstacles: those first that look most like a mistake."""
    if _turned(atom, state):
        return 0
    return 2 if any(each.predicate == atom.predicate for each in state) else 1


def _turned(atom: Atom, state: State) -> Atom | None:
    """The same fact with its arguments in another order, where that holds."""
    if len(atom.arguments) > _TURNED:
        return None
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
