"""What was true at a state of a simulated world that has passed; and what tells states apart."""

from collections.abc import Callable
from hashlib import blake2b

from tpvqa.pddl import Action, Atom, State, Task
from tpvqa.pddl.achieved import achieved
from tpvqa.pddl.atoms import holds_in


class EarlierTruth:
    """What was true at a state that is no longer: a `TruthSource`.

    Args:
        task: Tells what follows from the state.
        state: The one.
        visible: Whether the last observation shows a fact.
    """

    def __init__(self, task: Task, state: State, visible: Callable[[Atom], bool]):
        self._task, self._state, self._visible = task, state, visible

    def holds(self, atom: Atom) -> bool:
        """Whether a fact was true then."""
        return holds_in(atom, self._task.extend(self._state))

    def visible(self, atom: Atom) -> bool:
        """Whether the last observation shows if it is true."""
        return self._visible(atom)

    def possible(self, action: Action) -> bool:
        """Whether all preconditions of an action held then."""
        return self._task.applicable(self._state, action)

    def successful(self, action: Action) -> bool:
        """Whether all effects of an action held then."""
        return achieved(self._task, self._state, action)

    def scene(self) -> str:
        """A fingerprint of the state."""
        return fingerprint(self._state)


def fingerprint(state: State) -> str:
    """16 hexadecimal digits that tell states apart, the same in every process."""
    text = "\n".join(sorted(atom.pddl() for atom in state))
    return blake2b(text.encode(), digest_size=8).hexdigest()
