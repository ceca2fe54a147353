"""The paper's vote over the literals of an action."""

from collections.abc import Sequence
from enum import StrEnum

from tpvqa.errors import PluginError
from tpvqa.vlm import Answer


class Majority(StrEnum):
    """When the answers about an action's literals deny it.

    The paper speaks of a majority; its own example (`wash(plate)`: one of two preconditions
    denied, and it replans) needs a tie to deny.
    """

    TIE_DENIES = "tie"  # at least half of the answered literals are denied
    STRICT = "strict"  # more than half are
    ANY = (
        "any"  # a single one is: no majority, where three preconditions outvote the one that fails
    )

    @classmethod
    def named(cls, name: str) -> "Majority":
        """The majority of a name.

        Raises:
            PluginError: There is none.
        """
        try:
            return cls(name)
        except ValueError:
            raise PluginError(
                f"There is no majority {name!r}. Write 'tie' (half of the answers deny), "
                "'strict' (more than half must) or 'any' (one is enough)."
            ) from None

    def denies(self, answers: Sequence[Answer]) -> bool | None:
        """Whether the answers deny the action; None where all of them abstain."""
        votes = [answer.agrees for answer in answers if answer.agrees is not None]
        if not votes:
            return None
        denied = votes.count(False)
        if self is Majority.ANY:
            return denied > 0
        return 2 * denied >= len(votes) if self is Majority.TIE_DENIES else 2 * denied > len(votes)
