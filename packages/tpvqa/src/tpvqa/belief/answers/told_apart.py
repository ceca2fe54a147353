"""Which of all that is told apart of a VLM's noise is kept in every joint state.

Most of it soon is next to impossible. What is so is left out of the joint states: it is kept as one
probability each, and weighed by every answer as what lies nearest to it would be, so that it comes
back when answers make it probable again.
"""

from dataclasses import dataclass

import numpy as np

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.answers.kinds import KINDS
from tpvqa.belief.answers.led import Places

LEFT_OUT = 1e-7
"""What is less probable is left out of the joint states."""
BACK = 1e-5
"""What was left out and is more probable comes back."""
FEWER = 0.75
"""A share of what was kept: not for more is it worth leaving anything out."""


@dataclass(frozen=True, slots=True)
class ToldApart:
    """What is kept, and the rest. Of each of `KINDS` one column is kept, whatever it is worth: as
    its errors last so do those of the others of its kind.

    Attributes:
        columns: Those that are kept, of all.
        taken: Of each the place of the one whose part it takes among those that were kept before:
            its own, or of what has stood for it.
        rest: The others.
        stands: For each of the rest, the place in `columns` of the one that stands for it.
    """

    columns: Places
    taken: Places
    rest: Places
    stands: Places

    @staticmethod
    def of(noise: Floats, kept: Places) -> "ToldApart":
        """What is worth keeping.

        Args:
            noise: How probable everything that is told apart is.
            kept: What was kept until now.
        """
        was = np.zeros(len(noise), bool)
        was[kept] = True
        by_kind = np.where(was, noise, -1.0).reshape(-1, len(KINDS))
        likeliest = by_kind.argmax(axis=0) * len(KINDS) + np.arange(len(KINDS))
        keep = np.where(was, noise > LEFT_OUT, noise > BACK)
        keep[likeliest] = True
        columns, rest = np.flatnonzero(keep), np.flatnonzero(~keep)
        taken = np.where(was[columns], columns, likeliest[columns % len(KINDS)])
        stands = np.searchsorted(columns, likeliest[rest % len(KINDS)])
        return ToldApart(columns, np.searchsorted(kept, taken), rest, stands)

    def differs(self, kept: Places) -> bool:
        """Whether it is worth going over to it from what was kept until now: something comes back,
        or much is left out."""
        few = len(self.columns) <= FEWER * len(kept)
        return few or not np.isin(self.columns, kept).all()
