"""States of a task to plan from: some that actions lead to, some that nothing leads to."""

from collections.abc import Iterator
from itertools import product
from random import Random

from tpvqa.pddl import Atom, State, Task


def all_atoms(task: Task) -> list[Atom]:
    """Every atom of fitting types whose predicate actions change."""
    atoms = []
    for predicate in sorted(task.fluents):
        choices = [
            list(
                dict.fromkeys(
                    name for kind in types.split("|") for name in task.objects_by_type.get(kind, ())
                )
            )
            for types in task.predicates[predicate]
        ]
        atoms += [Atom(predicate, arguments) for arguments in product(*choices)]
    return atoms


def walk(task: Task, random: Random, steps: int) -> State:
    """A state that some actions lead to."""
    state = task.init
    for _ in range(steps):
        possible = [a for a in task.ground_actions() if task.applicable(state, a)]
        if not possible:
            break
        state = task.apply(state, random.choice(possible))
    return state


def scrambled(task: Task, random: Random) -> State:
    """A state in which every mutex group holds one atom, though maybe an unreachable one."""
    state = set(walk(task, random, 3))
    for group in random.sample(task.mutex_groups, len(task.mutex_groups)):
        state -= group.atoms
        free = [
            atom
            for atom in sorted(group.atoms)
            if not any(state & other.atoms for other in task.groups_of(atom))
        ]
        if free:
            state.add(random.choice(free))
    return frozenset(state)


def arbitrary(task: Task, random: Random) -> State:
    """Any state at all; mutex groups may be violated."""
    density = random.choice([0.05, 0.2, 0.5])
    chosen = {atom for atom in all_atoms(task) if random.random() < density}
    return frozenset(chosen) | task.static


def random_states(task: Task, *, seed: int, count: int) -> Iterator[State]:
    """States of all three sorts in turn."""
    random = Random(seed)
    for number in range(count):
        if number % 3 == 0:
            yield walk(task, random, random.randrange(12))
        elif number % 3 == 1:
            yield scrambled(task, random)
        else:
            yield arbitrary(task, random)
