"""The paper's monitor: ask all preconditions before an action, all effects after it, and count."""

import re

from tpvqa.errors import PluginError
from tpvqa.monitors.asker import Asker
from tpvqa.monitors.correcting import CorrectingMonitor
from tpvqa.monitors.majority import Majority
from tpvqa.plugins import PlainArguments

PLAIN = "no-alternatives"


class TPVQA(CorrectingMonitor, PlainArguments):
    """Zhang et al. 2023, section "Method".

    Before an action all its preconditions are asked. Where the majority denies them, the denied
    facts are taken out of the state and a new plan is made from there. After it all its effects
    are asked, negative ones too; where the majority denies them, the action is repeated.

    Args:
        majority: When answers deny an action.
        looks: How often to look again where every answer abstains, before stopping.
        votes: Looks at which every question is asked; each question's answer is the vote.
        alternatives: Whether to ask where else a thing is, once a fact about it is denied. The
            paper does not.

    Example:
        >>> TPVQA.from_spec("5:strict").name
        'tpvqa:5:strict'
    """

    def __init__(
        self,
        *,
        majority: Majority | str = Majority.TIE_DENIES,
        looks: int = 3,
        votes: int = 1,
        alternatives: bool = True,
    ):
        asker = Asker(majority=majority, looks=looks, votes=votes)
        super().__init__(asker, alternatives=alternatives)
        self._parts = asker.words

    @classmethod
    def from_spec(
        cls,
        arguments: str = "",
        *,
        majority: Majority | str = Majority.TIE_DENIES,
        no_alternatives: bool = False,
    ) -> "TPVQA":
        """Make it from `tpvqa[:K][:MAJORITY][:no-alternatives]`, with votes over K looks.

        Raises:
            PluginError: The arguments are others.
        """
        words = arguments.split(":") if arguments else []
        votes = words.pop(0) if words and re.fullmatch(r"[0-9]{1,9}", words[0]) else "1"
        rule = words.pop(0) if words and words[0] in set(Majority) else majority
        if words not in ([], [PLAIN]):
            raise PluginError(
                f"'tpvqa:{arguments}' is not understood. Write tpvqa[:K][:MAJORITY][:{PLAIN}], in "
                "this order: votes over K looks, the majority tie, strict or any; for example "
                f"tpvqa:5, tpvqa:any or tpvqa:5:strict:{PLAIN}."
            )
        return cls(majority=rule, votes=int(votes), alternatives=not (words or no_alternatives))

    @property
    def name(self) -> str:
        """What the log calls it."""
        return ":".join(["tpvqa", *self._parts, *([] if self.alternatives else [PLAIN])])
