"""The filter again, as plainly as possible: every joint state and history, nothing dropped."""

from collections.abc import Sequence
from fractions import Fraction

from tpvqa.pddl import Action, Atom, State, Task
from tpvqa.worlds.world_file import WorldRules

World = tuple[State, tuple[Atom, ...]]
"""A joint state and all facts that ended so far, in order: what the simulator keeps."""


def disturbed(world: World, task: Task, rules: WorldRules) -> list[tuple[Fraction, World]]:
    """What a disturbance leads to, as the simulator draws it; nothing where nothing can be."""
    state, ended = world
    undoable = []
    for atom in sorted(state - task.init):
        results = [
            after for rule in rules.undo for _, after in rule.results(atom, state, ended, task)
        ]
        if results:
            undoable.append(results)
    return [
        (Fraction(1, len(undoable) * len(results)), become(world, after))
        for results in undoable
        for after in results
    ]


def become(world: World, after: State) -> World:
    state, ended = world
    return after, (*ended, *sorted(state - after))


def act(
    belief: dict[World, Fraction],
    action: Action,
    task: Task,
    rules: WorldRules,
    rates: Sequence[Fraction],
) -> dict[World, Fraction]:
    """Predict by enumeration, with exact fractions."""
    failure, disturbance, spontaneous, redone = rates
    after: dict[World, Fraction] = {}

    def add(world: World, weight: Fraction) -> None:
        after[world] = after.get(world, Fraction(0)) + weight

    def disturb(world: World, weight: Fraction, chance: Fraction) -> None:
        outcomes = disturbed(world, task, rules)
        add(world, weight * (1 - chance if outcomes else 1))
        for share, other in outcomes:
            add(other, weight * chance * share)

    for world, weight in belief.items():
        state, _ = world
        truly = action
        for rebinding in rules.rebind:
            truly = rebinding.apply(truly, state, task)
        if task.apply(state, action) == state:
            disturb(world, weight, redone)
        elif not task.applicable(state, truly):
            disturb(world, weight, disturbance)
        else:
            disturb(world, weight * failure, disturbance)
            intended = become(world, task.apply(state, truly))
            disturb(intended, weight * (1 - failure), spontaneous)
    return after


def marginal(belief: dict[World, Fraction], atom: Atom) -> float:
    """The probability of a fact."""
    return float(sum(weight for (state, _), weight in belief.items() if atom in state))
