"""What makes an action worth being a choice: that it would change something, and that it can."""

import numpy as np

from tpvqa.belief.by_kind import Kinds
from tpvqa.belief.far_off import FarOff, Ranked
from tpvqa.belief.information import Floats
from tpvqa.belief.outlook import Outlook
from tpvqa.belief.sight import Sight
from tpvqa.belief.table import Choice

IDLE = 0.97
"""An action that changes nothing with this probability is no choice."""
HIDDEN_IDLE = 0.99
"""The same where nothing shows what it does: what it costs tells how often it is worth doing."""
FLOOR = 0.1
"""An action is no choice whose preconditions hold with less than this, where it is not done."""


class Doing:
    """Says what choices have to do.

    Args:
        ahead: How often skills fail.
        far: What actions do in joint states.
        sight: What can be seen.
    """

    def __init__(self, ahead: Outlook, far: FarOff, sight: Sight):
        self._ahead, self._far, self._sight = ahead, far, sight

    def of(self, choice: Choice, ranked: Ranked, kinds: Kinds) -> Floats:
        """What a choice has to do in the joint states: what it would change, and what it can, each
        less how probable that has to be; shape (2, states).

        Q-MDP, which takes everything to be known after the next action, would wait for ever.
        """
        found = np.ones((2, len(ranked)))
        if choice.action is not None:
            # Who does in vain what nothing shows never learns that it is in vain.
            hidden = self._sight.hidden(choice.action)
            works = 1 - self._ahead.skill(choice.action).failure if hidden else 1.0
            idle = HIDDEN_IDLE if hidden else IDLE
            undone, possible = self._far.does(choice.action, ranked, kinds).T[:2]
            found[0] = works * undone * possible - (1 - idle)
            found[1] = undone * (possible - FLOOR)
        return found
