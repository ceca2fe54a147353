"""From where plans are wanted."""

from tpvqa.belief.deciding.commitment import Commitments
from tpvqa.belief.deciding.outlook import Outlook
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.pddl import State

LIKELY = 0.02
"""Joint states of at least this probability get a plan of their own."""
UNLIKELY = 4
"""Plans between two actions from joint states that are less probable than that."""
ENDS = 2
"""Plans between two actions from where a way may end as nothing shows that it is not the way."""


class Seeking:
    """Names joint states that no known plan helps; for none is a plan sought twice between two
    actions.

    Args:
        model: The action model.
        ahead: The known plans.
        commitments: Knows where ways may end.
    """

    def __init__(self, model: FaultModel, ahead: Outlook, commitments: Commitments):
        self._model, self._ahead, self._commitments = model, ahead, commitments
        self._sought: set[State] = set()
        self._unlikely = self._ends = 0

    def acted(self) -> None:
        """Note that there is an action."""
        self._sought.clear()
        self._unlikely = self._ends = 0

    def renumbered(self, model: FaultModel) -> None:
        """Go on with a model that gives joint states other numbers."""
        self._model = model

    def unplanned(self, belief: Belief) -> State | None:
        """The most probable joint state that no known plan helps; None if none is likely.

        Many that are unlikely each are likely together: then the first few of them count too.
        """
        found: State | None = None
        together = 0.0
        for number, weight in belief.ranked():
            if weight < LIKELY / 10:
                break
            state = self._model.state(number)
            if state in self._ahead.hopeless or state in self._sought:
                continue
            if self._ahead.best(number) is None:
                if weight >= LIKELY:
                    self._sought.add(state)
                    return state
                found = found or state
                together += weight
        if together < LIKELY or self._unlikely >= UNLIKELY:
            return self._foreseen()
        self._unlikely += 1
        if found is not None:
            self._sought.add(found)
        return found

    def foresees(self) -> bool:
        """Whether a way on may end where no plan is known, so that one is worth having."""
        return self._foreseen(sought=False) is not None

    def _foreseen(self, *, sought: bool = True) -> State | None:
        """The most probable such end; noted as one for which a plan is sought, or not."""
        ends = self._commitments.unplanned
        if not ends or self._ends >= ENDS:
            return None
        state = max(ends, key=ends.__getitem__)
        if ends[state] < LIKELY or state in self._sought or state in self._ahead.hopeless:
            return None
        if sought:
            self._ends += 1
            self._sought.add(state)
        return state
