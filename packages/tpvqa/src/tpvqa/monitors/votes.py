"""The paper's monitor, improved by nothing but looking more often: votes wherever it asks."""

import re

from tpvqa.errors import PluginError
from tpvqa.monitors.asker import MOST, Asker
from tpvqa.monitors.correcting import CorrectingMonitor
from tpvqa.monitors.majority import Majority
from tpvqa.plugins import PlainArguments

_NUMBER = re.compile(r"[0-9]{1,9}")  # of more digits Python makes no number


class Votes(CorrectingMonitor, PlainArguments):
    """TPVQA with votes over several looks everywhere, and a check of the goal at the end.

    Args:
        votes: Looks at which every question is asked.
        majority: When votes deny an action.
    """

    def __init__(self, votes: int, *, majority: Majority | str = Majority.TIE_DENIES):
        self._votes = Asker(majority=majority, votes=votes)
        super().__init__(self._votes, goal=True)

    @classmethod
    def from_spec(
        cls, arguments: str = "", *, majority: Majority | str = Majority.TIE_DENIES
    ) -> "Votes":
        """Make it from `vote:K[:MAJORITY]`, with votes over K looks.

        Raises:
            PluginError: The arguments are others.
        """
        votes, _, rule = arguments.partition(":")
        looks = int(votes) if _NUMBER.fullmatch(votes) else 0
        if not 1 <= looks <= MOST or rule not in ("", *Majority):
            raise PluginError(
                f"'vote:{arguments}' is not understood. Write vote:K for votes over K looks, "
                f"{MOST} at most, e.g. vote:5, or with the majority tie, strict or any at its end: "
                "vote:5:strict."
            )
        return cls(looks, majority=rule or majority)

    @property
    def name(self) -> str:
        """What the log calls it."""
        strict = ":strict" if self._votes.majority is Majority.STRICT else ""
        return f"vote:{self._votes.votes}{strict}"
