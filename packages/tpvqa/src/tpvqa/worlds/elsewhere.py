"""True states at first in which things are not where the problem says."""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence

from tpvqa.chance import chance
from tpvqa.errors import WorldError
from tpvqa.pddl import Action, Atom, State, Task

MOST_TRIED = 40
"""States that are drawn for one thing before it stays where it is."""


def elsewhere(
    task: Task,
    count: int,
    *,
    plan: Callable[[State], Sequence[Action] | None],
    seed: int = 0,
    episode: int = 0,
) -> State:
    """A first state in which some things are elsewhere than in the task's.

    A thing is what all facts of an exactly-one group name, as `(on bread table)` and `(gripped
    robot bread)` do; it stands first in the one that holds, its place after it. It is elsewhere
    where another fact of that group and predicate holds, at a place where anything can be, and all
    mutex groups still hold: a place for one thing is free, and the one that it left is.

    Args:
        task: Gives the groups and the initial state.
        count: How many things.
        plan: Gives a plan from a state; None where there is none. Things are those that the plan
            from the initial state handles, but for what takes part in every action, as robots do.
        seed: With `episode`, decides which things, and where they are.
        episode: Number of the episode under this seed.

    Raises:
        WorldError: Not so many things can be elsewhere with the goal still in reach.
    """
    state, moved = task.init, 0
    draw = chance(seed, episode, "elsewhere", task.name, count)
    handled = _handled(task, plan(task.init) or ())
    places = {thing: found for thing, found in places_of(task).items() if thing in handled}
    for thing in draw.sample(sorted(places), len(places)):
        if moved == count:
            break
        others = [each for each in elsewhere_of(places[thing], state, task) if each != task.init]
        tried = draw.sample(others, min(len(others), MOST_TRIED))
        found = next((other for other in tried if plan(other) is not None), None)
        if found is not None:
            state, moved = found, moved + 1
    if moved < count:
        raise WorldError(
            f"--elsewhere {count}: of what the plan of {task.name} handles, {moved or 'no'} "
            f"{'thing' if moved < 2 else 'things'} can be elsewhere with the goal still in reach"
            f"{_why(task, handled, places)}; name {'fewer, or ' if count > 1 else ''}a state with "
            "--true-start"
        )
    return state


def _why(task: Task, handled: Collection[str], places: Mapping[str, Sequence[Atom]]) -> str:
    """Why no more things of those that a plan handles can be elsewhere, where the task says why."""
    at = {atom.arguments[0] for atom in task.init - task.static if len(atom.arguments) > 1}
    loose = sorted((at & {*handled}) - places.keys())
    bound = sorted(thing for thing, found in places.items() if len(found) < 2)
    why = []
    if loose:
        why.append(
            f"of {' and '.join(loose)} the domain does not make sure that exactly one of the facts "
            "that say where it is holds (what adds one has to delete another that it has as its "
            "condition)"
        )
    if bound:
        why.append(f"no action brings {' or '.join(bound)} to another place of that kind")
    unary = (atom for atom in task.init - task.static if len(atom.arguments) == 1)
    lone = sorted(atom.pddl() for atom in unary if atom.arguments[0] in handled)
    if not (places or loose) and lone:
        why.append(f"{' and '.join(lone)} names no place of which there could be another")
    elif not (places or loose):
        why.append("no action changes a fact that says where one is, as (on bread table)")
    return f" ({'; '.join(why)})" if why else ""


def _handled(task: Task, plan: Sequence[Action]) -> set[str]:
    everywhere = [set(words[1:]) for words in task.reachable_actions]
    always = set.intersection(*everywhere) if everywhere else set()
    return {name for action in plan for name in action.arguments} - always


def places_of(task: Task) -> dict[str, list[Atom]]:
    """Where each thing can be, as facts of the predicate of the one that is true at first."""
    found: dict[str, list[Atom]] = {}
    known = {(atom.predicate, atom.arguments[1:]) for atom in task.atoms() | task.init}
    for group in task.mutex_groups:
        here = [atom for atom in group.atoms if atom in task.init]
        if not group.exactly_one or len(here) != 1 or len(here[0].arguments) < 2:
            continue
        thing = here[0].arguments[0]
        if all(thing in atom.arguments for atom in group.atoms):
            found[thing] = [
                atom
                for atom in sorted(group.atoms)
                if atom.predicate == here[0].predicate
                and (atom.predicate, atom.arguments[1:]) in known
                and thing not in atom.arguments[1:]
            ]
    return found


def elsewhere_of(places: Sequence[Atom], state: State, task: Task) -> Iterator[State]:
    """The states in which one thing is elsewhere and all mutex groups still hold.

    Args:
        places: Where the thing can be.
        state: The one where it is not.
        task: Gives the groups.
    """
    here = state & {*places}
    for place in places:
        if place not in here:
            after = _repaired(state - here, place, task)
            if after is not None:
                yield after


def _repaired(state: State, place: Atom, task: Task) -> State | None:
    """The state with a fact more, and what follows from it in other groups; None for none."""
    rivals = {atom for group in task.groups_of(place) for atom in group.atoms} & state
    if any(len(atom.arguments) > 1 for atom in rivals):
        return None  # something else is there
    after = (state - rivals) | {place}
    for group in task.mutex_groups:
        if group.exactly_one and not after & group.atoms:
            fitting = [atom for atom in sorted(group.atoms) if _fits(after | {atom}, atom, task)]
            if len(fitting) != 1:
                return None
            after |= {fitting[0]}
    consistent = all(_fits(after, atom, task) for atom in after)
    return after if consistent else None


def _fits(state: State, atom: Atom, task: Task) -> bool:
    """Whether no other fact of a fact's groups holds."""
    return all(len(group.atoms & state) <= 1 for group in task.groups_of(atom))
