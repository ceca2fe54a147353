"""What holds in joint states, as rows of bits: facts are looked up in many of them at once."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.answers.information import Floats

Bytes = NDArray[np.uint8]
Numbers = NDArray[np.intp]


class Packed:
    """Rows of bits by the number of a joint state, worked out as they are met.

    Args:
        holding: What holds in a joint state, as bits.
    """

    def __init__(self, holding: Callable[[int], int]):
        self._holding = holding
        self._rows: Bytes = np.zeros((64, 8), np.uint8)
        self._known = np.zeros(64, bool)

    def rows(self, numbers: Numbers) -> Bytes:
        """The rows of some joint states, shape (joint states, bytes)."""
        more = int(numbers.max(initial=-1)) + 1 - len(self._known)
        if more > 0:
            more = max(more, len(self._known))
            self._known = np.pad(self._known, (0, more))
            self._rows = np.pad(self._rows, ((0, more), (0, 0)))
        for number in numbers[~self._known[numbers]].tolist():
            holding = self._holding(number)
            size = holding.bit_length() // 8 + 1
            wider = size - self._rows.shape[1]
            if wider > 0:
                self._rows = np.pad(self._rows, ((0, 0), (0, wider + size // 4)))
            told = np.frombuffer(holding.to_bytes(size, "little"), np.uint8)
            self._rows[number, :size], self._known[number] = told, True
        return self._rows[numbers]


def held(rows: Bytes, places: Numbers) -> NDArray[np.bool_]:
    """Which of some facts hold, shape (joint states, facts).

    Args:
        rows: Of joint states.
        places: Of the facts' bits.
    """
    places = np.minimum(places, 8 * rows.shape[1])
    rows = np.pad(rows, ((0, 0), (0, 1)))  # of bits that no row has
    found: NDArray[np.bool_] = (rows[:, places >> 3] >> (places & 7).astype(np.uint8)) & 1 > 0
    return found


class Facts:
    """What holds in some joint states: their common facts once, the others one by one.

    Args:
        rows: Of the joint states.
    """

    def __init__(self, rows: Bytes):
        differ = np.bitwise_or.reduce(rows ^ rows[0], axis=0)
        varied = np.flatnonzero(np.unpackbits(differ, bitorder="little"))
        self._size = len(rows)
        self._common = np.unpackbits(rows[0], bitorder="little").astype(float)
        self._varied = varied
        self._places = {place: column for column, place in enumerate(varied.tolist())}
        self._held = held(rows, varied).T
        self._weighed = self._held.astype(float)

    def probabilities(self, weights: Floats) -> list[float]:
        """The probability of every fact, by its bit; of later ones it is nought."""
        found = self._common.copy()
        found[self._varied] = np.minimum(self._weighed @ weights, 1.0)
        listed: list[float] = found.tolist()
        return listed

    def holds(self, places: Sequence[int]) -> NDArray[np.bool_]:
        """In which of the joint states any of some facts holds, by their bits."""
        found = np.zeros(self._size, bool)
        for place in places:
            column = self._places.get(place)
            if column is not None:
                found |= self._held[column]
            elif place < len(self._common) and self._common[place]:
                found[:] = True
        return found
