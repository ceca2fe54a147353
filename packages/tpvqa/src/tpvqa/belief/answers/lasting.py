"""Errors that last: an answer may be the scene's own, drawn once, however often it is asked.

With a *lasting share* s each answer to a question is, with probability s, the scene's own draw for
it, and otherwise drawn afresh; two answers then correlate by s². Evidence of one question in one
scene saturates. Whether the scene's own draw is a misreading *stays* as it was, with some
probability, where something else in the scene has changed. That errors of views are not
independent: Velez et al. 2012 (JAIR 44). Answers drawn afresh are as often wrong as the scene's
own, or a coin's: then some questions are always misread, and the rest now and then.
"""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.answers.kinds import KINDS

Columns = NDArray[np.intp] | slice
"""Which of all that is told apart of the noise; in `KINDS` along it, once or several times over."""
EVERY = slice(None)


DISPERSED = 8.0
"""Where errors last, a question in a scene has its own rate of yes, too, for answers drawn afresh,
known beforehand as well as from so many answers: none is better than the worst known of it."""
SUREST = 0.001
"""The scene's own answers are wrong so often at least."""
SHARES = np.array([kind.share for kind in KINDS])
STAYS = np.array([kind.stays for kind in KINDS])
_COINS = np.array([kind.coin for kind in KINDS])
_LASTS = np.array([kind.share > 0 for kind in KINDS])


@cache
def _over(size: int) -> tuple[Floats, Floats, Floats]:
    """Whether fresh answers are a coin's, whether errors last, and the shares, so often over."""
    times = size // len(KINDS)
    return np.tile(_COINS, times), np.tile(_LASTS, times), np.tile(SHARES, times)


def _kinds(size: int, columns: Columns) -> tuple[Floats, Floats, Floats]:
    if isinstance(columns, slice):
        return _over(size)
    kinds = columns % len(KINDS)
    return _COINS[kinds], _LASTS[kinds], SHARES[kinds]


def shares_of(size: int, columns: Columns) -> Floats:
    """The lasting shares of some columns.

    Args:
        size: How many.
        columns: Which.
    """
    return _kinds(size, columns)[2]


def stays_of(size: int, columns: Columns) -> Floats:
    """`Kind.stays` of some columns; arguments as those of `shares_of`."""
    if isinstance(columns, slice):
        return np.tile(STAYS, size // len(KINDS))
    found: Floats = STAYS[columns % len(KINDS)]
    return found


def own_rate(rate: Floats, columns: Columns = EVERY) -> Floats:
    """P(yes) of the scene's own answer before it is drawn.

    Args:
        rate: P(yes) of an answer of which nothing is known, by `KINDS` along the last axis, once or
            several times over.
        columns: Which of these they are.
    """
    coins, _, shares = _kinds(rate.shape[-1], columns)
    own = np.clip((rate - (1 - shares) / 2) / np.maximum(shares, 0.5), SUREST, 1 - SUREST)
    return np.where(coins, own, rate)


def fresh_rate(rate: Floats, answers: Floats, yeses: Floats, columns: Columns = EVERY) -> Floats:
    """P(yes) of an answer drawn afresh, after some answers in the same scene.

    Args:
        rate: As that of `own_rate`.
        answers: How many there were.
        yeses: How many of them were yeses.
        columns: As that of `own_rate`.
    """
    coins, lasts, _ = _kinds(rate.shape[-1], columns)
    known = (DISPERSED * rate + yeses) / (DISPERSED + answers)
    return np.where(coins, 0.5, np.where(lasts, known, rate))
