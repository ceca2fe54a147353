"""Better ways to do a task unseen than to repeat every step of a plan as often.

Where answers say nothing, what is done from here to the end can be fixed now. Parts of it are put
in, left out and exchanged, wherever that lowers what it is expected to cost in the belief's own
model: what is undone most easily is done last, or again; steps that undo others are repeated less.
"""

from collections.abc import Iterable, Sequence
from itertools import groupby, pairwise
from typing import NamedTuple

import numpy as np

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.deciding.one_thread import one_thread
from tpvqa.belief.deciding.outlook import Outlook
from tpvqa.belief.deciding.steps import Steps
from tpvqa.pddl import Action

MOST = 60
"""Changes that are made, one after the other, at most."""
LEAST = 0.01
"""By how many actions each has to be better."""

Actions = tuple[Action, ...]


class _Change(NamedTuple):
    """What stands from one place to before another is exchanged for a piece."""

    begin: int
    end: int
    piece: Actions


class Improving:
    """Changes what is done unseen as long as that makes it cheaper.

    Args:
        steps: What single actions do to many joint states.
        ahead: How often skills fail, and how often something is undone.
        price: What an action costs.
    """

    def __init__(self, steps: Steps, ahead: Outlook, price: float):
        self._steps, self._ahead, self._price = steps, ahead, price

    @one_thread
    def improved(
        self,
        actions: Actions,
        ways: Sequence[Actions],
        masses: Floats,
        after: Floats,
        most: int | None = None,
    ) -> Actions:
        """What to do instead of some actions.

        In the place of any of them, one after the other, come one step of a way, two that follow
        each other there, or none; of all such changes the best, again and again.

        Args:
            actions: They.
            ways: Ways whose steps may help, besides their own.
            masses: How probable the joint states are, as `Steps` tells them apart.
            after: What is left to pay in each after the last action.
            most: How many actions there may be; None for any number.
        """
        told = [tuple(each for each, _ in groupby(way)) for way in (actions, *ways)]
        pieces: dict[Actions, None] = dict.fromkeys((each,) for way in told for each in way)
        pieces |= dict.fromkeys(pair for way in told for pair in pairwise(way))
        for _ in range(MOST):
            change = self._best(actions, pieces, masses, after, most)
            if change is None:
                break
            actions = (*actions[: change.begin], *change.piece, *actions[change.end :])
        return actions

    def _best(
        self,
        actions: Actions,
        pieces: Iterable[Actions],
        masses: Floats,
        after: Floats,
        most: int | None,
    ) -> _Change | None:
        """The best change; None where none is worth it."""
        before, behind = self._before(actions, masses), self._behind(actions, after)
        place = np.arange(len(actions) + 1)
        longer = place[:, None] - place  # without what stands between a begin and an end
        spent = self._price * place[:, None]
        least = float(before[0] @ behind[:, 0]) - LEAST * self._price
        led: dict[Actions, Floats] = {(): behind}
        found = None
        for piece in ((), *pieces):
            if piece:
                led[piece] = self._back(piece[0], led[piece[1:]])
            barred = longer > 0
            if most is not None:
                barred |= longer + len(actions) + len(piece) > most
            paid = np.where(barred, np.inf, spent + before @ led[piece])
            begin, end = divmod(int(np.argmin(np.round(paid, 9))), len(place))
            if paid[begin, end] < least:
                least, found = float(paid[begin, end]), _Change(begin, end, piece)
        return found

    def _before(self, actions: Actions, masses: Floats) -> Floats:
        """How probable the joint states (columns) are before each action, and after the last."""
        found = [masses]
        for action in actions:
            failure = self._ahead.skill(action).failure
            found.append(self._steps.forth(action, found[-1], failure, self._ahead.rates))
        return np.stack(found)

    def _behind(self, actions: Actions, after: Floats) -> Floats:
        """What is left to pay in the joint states (rows) before each action, and after the last."""
        found = [after[:, None]]
        for action in reversed(actions):
            found.append(self._back(action, found[-1]))
        return np.concatenate(found[::-1], axis=1)

    def _back(self, action: Action, after: Floats) -> Floats:
        failure = self._ahead.skill(action).failure
        return self._price + self._steps.back(action, after, failure, self._ahead.rates)
