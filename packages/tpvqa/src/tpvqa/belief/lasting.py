"""Errors that last: an answer may be the scene's own, drawn once, however often it is asked.

With a *lasting share* s each answer to a question is, with probability s, the scene's own draw for
it, and otherwise drawn afresh; two answers then correlate by s². Evidence of one question in one
scene saturates. Whether the scene's own draw is a misreading *stays* as it was, with some
probability, where something else in the scene has changed. That errors of views are not
independent: Velez et al. 2012 (JAIR 44).
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from tpvqa.belief.information import Floats


class Kind(NamedTuple):
    """How errors may last.

    Attributes:
        share: The lasting share s.
        stays: Probability that a misreading, or that there is none, goes on when the scene has
            changed.
    """

    share: float
    stays: float


KINDS = (
    Kind(0.0, 0.0),
    *(Kind(share, stays) for share in (0.35, 0.6, 0.8, 0.97) for stays in (0.0, 0.9)),
)
"""What is told apart."""
FRESH = (1.0, *(0.0 for _ in KINDS[1:]))
"""How probable each is where errors are known not to last."""
RECORDED = (0.34, 0.05, 0.05, 0.08, 0.07, 0.13, 0.12, 0.08, 0.08)
"""How probable each is before any answer of a VLM was labelled: for two thirds as with those of
ViPlan (a lasting share of about .8 and .98, of which .77 and .55 stay), shared out widely; the rest
for one that answers anew at every look."""
SHARES = np.array([kind.share for kind in KINDS])
STAYS = np.array([kind.stays for kind in KINDS])


@dataclass(frozen=True, slots=True)
class Drawn:
    """What is known of the scene's own answer to a question, by `KINDS` along the last axis.

    Attributes:
        yes: P(it is a yes and was drawn before), first where yes is right, then where no is.
        new: P(it is not drawn yet), likewise.
    """

    yes: tuple[Floats, Floats]
    new: tuple[Floats, Floats]

    def after(self, same: tuple[float, float], still: float) -> "Drawn":
        """What is known of it at a later scene.

        Args:
            same: Probability that the fact was the same before, where yes is right now and where
                no is.
            still: Probability that then nothing else has changed either.
        """
        yes, new = [], []
        for now in (0, 1):
            here = same[now] * (still + (1 - still) * STAYS)
            turned = (1 - same[now]) * STAYS
            # A misreading goes on: where the fact has changed, so has the answer.
            swapped = 1 - self.yes[1 - now] - self.new[1 - now]
            yes.append(here * self.yes[now] + turned * swapped)
            new.append(here * self.new[now] + turned * self.new[1 - now] + 1 - here - turned)
        return Drawn((yes[0], yes[1]), (new[0], new[1]))

    def own(self, now: int, rate: Floats) -> Floats:
        """P(the scene's own answer is a yes).

        Args:
            now: 0 where yes is right, 1 where no is.
            rate: P(yes) of one drawn afresh.
        """
        own: Floats = self.yes[now] + self.new[now] * rate
        return own

    def told(
        self, yes: bool, rates: tuple[Floats, Floats], repeated: tuple[Floats, Floats]
    ) -> "Drawn":
        """What is known of it after an answer.

        Args:
            yes: Whether it is a yes.
            rates: P(yes) of one drawn afresh, where yes is right and where no is.
            repeated: Probability that it is the answer before once more, likewise.
        """
        found = []
        for now in (0, 1):
            rate, own = rates[now], self.own(now, rates[now])
            this, fresh = (own, rate) if yes else (1 - own, 1 - rate)
            drawn = SHARES * this + (1 - SHARES) * fresh
            agrees = this * (SHARES + (1 - SHARES) * fresh) / np.maximum(drawn, 1e-12)
            after = agrees if yes else 1 - agrees
            found.append(repeated[now] * own + (1 - repeated[now]) * after)
        none = np.zeros(len(KINDS))
        return Drawn((found[0], found[1]), (none, none))


NEVER = Drawn((np.zeros(len(KINDS)),) * 2, (np.ones(len(KINDS)),) * 2)
"""Of a question that was not asked."""
