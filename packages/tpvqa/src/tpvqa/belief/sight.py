"""What can be seen at all: facts that some question is about, or some sensor."""

from collections.abc import Callable

from tpvqa.belief.faults import FaultModel
from tpvqa.pddl import Action, Atom


class Sight:
    """Tells joint states apart by what can be seen of them.

    Args:
        model: Gives the joint states.
        seen: Whether anything shows a fact; by default everything is shown.
    """

    def __init__(self, model: FaultModel, seen: Callable[[Atom], bool] | None = None):
        self._model, self._seen = model, seen
        self._known: dict[Atom, bool] = {}
        self._looks: dict[int, int] = {}
        self._kinds: dict[frozenset[Atom], int] = {}
        self._hidden: dict[Action, bool] = {}
        self._complete: bool | None = None

    def by(self, seen: Callable[[Atom], bool]) -> None:
        """Note what shows facts."""
        self._seen = seen
        for known in (self._known, self._looks, self._kinds, self._hidden):
            known.clear()
        self._complete = None

    def renumbered(self, model: FaultModel) -> None:
        """Go on with a model that gives joint states other numbers."""
        self._model = model
        self._looks.clear()

    @property
    def complete(self) -> bool:
        """Whether everything is shown."""
        if self._seen is None:
            return True
        if self._complete is None:
            self._complete = all(map(self.sees, self._model.task.atoms()))
        return self._complete

    def sees(self, atom: Atom) -> bool:
        """Whether anything shows a fact."""
        if self._seen is None:
            return True
        known = self._known.get(atom)
        if known is None:
            known = self._known[atom] = self._seen(atom)
        return known

    def look(self, number: int) -> int:
        """How a joint state looks: the same number for those that nothing tells apart."""
        known = self._looks.get(number)
        if known is None:
            seen = frozenset(filter(self.sees, self._model.state(number)))
            known = self._looks[number] = self._kinds.setdefault(seen, len(self._kinds))
        return known

    def hidden(self, action: Action) -> bool:
        """Whether nothing shows that an action did anything."""
        known = self._hidden.get(action)
        if known is None:
            changes = [effect.literal.atom for effect in action.effects]
            known = self._hidden[action] = not any(map(self.sees, changes))
        return known
