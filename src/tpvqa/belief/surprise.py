"""What else could be true when answers contradict all that the action model explains."""

from tpvqa.pddl import Atom, State, Task


def flips(task: Task, state: State, atoms: tuple[Atom, ...]) -> list[State]:
    """The nearest consistent states in which a fact is the other way.

    Args:
        task: Gives the mutex groups.
        state: A consistent state.
        atoms: The fact, and others that no answer tells from it.

    Returns:
        States in which all of them are false, where one holds; or one of them is true, where none
        does. A group of which exactly one fact holds keeps one.
    """
    true = [atom for atom in atoms if atom in state]
    if not true:
        return [
            after
            for atom in sorted(atoms)
            if atom in task.atoms() and (after := _with(task, state, frozenset(), atom)) is not None
        ]
    atom = true[0]
    homes = [group.atoms for group in task.groups_of(atom) if group.exactly_one]
    if not homes:
        return [state - set(true)]
    # The thing is elsewhere: every other fact of its largest group.
    home = max(homes, key=len)
    found = []
    for other in sorted((home & task.atoms()) - set(atoms)):
        after = _with(task, state, frozenset({atom}), other)
        if after is not None and after not in found:
            found.append(after)
    return found


def _with(task: Task, state: State, gone: State, atom: Atom) -> State | None:
    """The state with a fact made true and others false; None where that takes more changes."""
    rivals = {other for group in task.groups_of(atom) for other in group.atoms} - {atom}
    after = (state - gone - rivals) | {atom}
    for group in task.mutex_groups:
        if group.exactly_one and state & group.atoms and not after & group.atoms:
            filled = _filled(task, after, group.atoms)
            if filled is None:
                return None
            after = filled
    return after


def _filled(task: Task, state: State, group: frozenset[Atom]) -> State | None:
    """The state with the fact of a group that rivals nothing; None where no fact fits."""
    fitting = [
        atom
        for atom in sorted(group & (task.atoms() | task.init))
        if not any(state & (other.atoms - {atom}) for other in task.groups_of(atom))
    ]
    fitting.sort(key=lambda atom: len(task.groups_of(atom)))
    return state | {fitting[0]} if fitting else None
