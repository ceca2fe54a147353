"""Numbers worked out once for every set of facts that may hold, and looked up by arrays."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.answers.information import Floats

Kinds = NDArray[np.intp]


class ByKind:
    """Rows of numbers by `FaultModel.kind`, worked out as they are met.

    Args:
        width: Numbers in a row.
    """

    def __init__(self, width: int):
        self._rows: Floats = np.empty((0, width))
        self._known: NDArray[np.bool_] = np.empty(0, bool)

    def of(self, kinds: Kinds, work_out: Callable[[int], tuple[float, ...]]) -> Floats:
        """The rows of some kinds, shape (kinds, width).

        Args:
            kinds: Which.
            work_out: The row of one, by its place among them.
        """
        most = int(kinds.max(initial=-1)) + 1
        if most > len(self._known):
            more = max(most, 2 * len(self._known)) - len(self._known)
            self._known = np.concatenate([self._known, np.zeros(more, bool)])
            self._rows = np.concatenate([self._rows, np.zeros((more, self._rows.shape[1]))])
        for place in np.flatnonzero(~self._known[kinds]).tolist():
            kind = kinds[place]
            if not self._known[kind]:
                self._rows[kind], self._known[kind] = work_out(place), True
        return self._rows[kinds]
