"""What can be seen at all: facts that some question is about, or some sensor."""

from collections.abc import Callable, Sequence

from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.pddl import Action, Atom


class Sight:
    """Tells joint states apart by what can be seen of them.

    Args:
        model: Gives the joint states.
        seen: Whether anything shows a fact; by default everything is shown.

    Attributes:
        version: Grows whenever something else shows facts.
    """

    def __init__(self, model: FaultModel, seen: Callable[[Atom], bool] | None = None):
        self._model, self._seen, self.version = model, seen, 0
        self._felt: Callable[[Atom], bool] = lambda atom: False
        self._known: dict[Atom, bool] = {}
        self._looks: dict[tuple[int, frozenset[Atom]], int] = {}
        self._felt_by: dict[Action, frozenset[Atom]] = {}
        self._kinds: dict[frozenset[Atom], int] = {}
        self._hidden: dict[Action, bool] = {}
        self._complete: bool | None = None

    def by(
        self,
        seen: Callable[[Atom], bool],
        felt: Callable[[Atom], bool] = lambda atom: False,
    ) -> None:
        """Note what shows facts.

        Args:
            seen: Whether anything shows a fact.
            felt: Whether the robot notices a fact as it changes it, and perhaps never after.
        """
        self._seen, self._felt = seen, felt
        self.version += 1
        for known in (self._known, self._looks, self._kinds, self._hidden, self._felt_by):
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

    def look(self, number: int, after: Action | None = None) -> int:
        """How a joint state looks: the same number for those that nothing tells apart.

        Args:
            number: Of the joint state.
            after: The action that has led to it, of whose effects more may be felt.
        """
        felt = frozenset[Atom]() if after is None else self._felt_of(after)
        known = self._looks.get((number, felt))
        if known is None:
            state = self._model.state(number)
            seen = frozenset(filter(self.sees, state)) | (felt & state)
            known = self._kinds.setdefault(seen, len(self._kinds))
            self._looks[number, felt] = known
        return known

    def undone(self, number: int) -> Sequence[tuple[float, int]]:
        """What undoing leads to from a joint state, with shares, where anything shows it.

        What nothing shows is left out of what the next action may undo: of later ones it is not
        known either, and whatever puts the next one off would look cheaper.
        """
        found = self._model.undone(number)
        if self.complete:
            return found
        look = self.look(number)
        return [(share, other) for share, other in found if self.look(other) != look]

    def _felt_of(self, action: Action) -> frozenset[Atom]:
        known = self._felt_by.get(action)
        if known is None:
            changes = (effect.literal.atom for effect in action.effects)
            known = self._felt_by[action] = frozenset(filter(self._felt, changes))
        return known

    def hidden(self, action: Action) -> bool:
        """Whether nothing shows that an action did anything."""
        known = self._hidden.get(action)
        if known is None:
            changes = [effect.literal.atom for effect in action.effects]
            shown = any(self.sees(atom) or self._felt(atom) for atom in changes)
            known = self._hidden[action] = not shown
        return known
