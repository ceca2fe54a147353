"""Control questions: about what is known already, to see whether the answers can be trusted.

A calibration may be of another camera. Answers that are worth nothing look like good ones for long
where only what is in doubt is asked about: there is always a state of the world that explains them.
An answer about what is known speaks for or against the VLM alone (Wald 1945).
"""

from collections.abc import Callable, Sequence
from math import log

from tpvqa.belief.costs import Costs
from tpvqa.belief.weighing.expected import Expected
from tpvqa.questions import FactQuestion

KNOWN = 0.01
"""What is surer than this is known."""
RULED_OUT = 0.003
"""That answers are worth nothing is ruled out where it is less probable, and found where the
contrary is."""
LOST = 0.5
"""The share of tasks that is lost where answers are trusted that are worth nothing."""
SUSPECTED = 0.1
"""Where they are worth nothing with less than this, only the first few questions are asked."""
FIRST = 6
"""So many."""
TIMES = 2
"""How often one question is asked."""


class Controls:
    """Asks what is known already, as long as it matters whether the answers are worth anything.

    Args:
        evidence: Says what answers are worth.
        costs: What a question costs, and a failed task.
    """

    def __init__(self, evidence: Expected, costs: Costs):
        self._evidence, self._costs = evidence, costs
        self._asked: dict[str, int] = {}
        self._right = {True: 0, False: 0}

    def next(
        self,
        questions: Sequence[FactQuestion],
        likely: Callable[[FactQuestion], float],
        views: Callable[[FactQuestion], Sequence[str | None]],
    ) -> FactQuestion | None:
        """The next one; None where none is worth it. It counts as asked.

        Of those asked least, one to which yes is right where no was right more often until now, and
        the other way round: who always says no is found out, too.

        Args:
            questions: What can be asked.
            likely: How probable it is that yes is right.
            views: From where a question may find an answer.
        """
        nothing = self._evidence.worth.nothing
        few = nothing < SUSPECTED and sum(self._asked.values()) >= FIRST
        if few or not worth_asking(nothing, self._evidence.right, self._costs):
            return None
        more = self._right[True] > self._right[False]
        found: dict[tuple[int, bool, int], FactQuestion] = {}
        for place, question in enumerate(questions):
            asked = self._asked.get(question.text, 0)
            if question.wording or asked >= TIMES or KNOWN < likely(question) < 1 - KNOWN:
                continue
            if question.still_shown and likely(question) < 0.5:
                continue  # a yes may be right
            if views(question):
                found[asked, (likely(question) > 0.5) == more, place] = question
        if not found:
            return None
        best = found[min(found)]
        self._asked[best.text] = self._asked.get(best.text, 0) + 1
        self._right[likely(best) > 0.5] += 1
        return best


def worth_asking(nothing: float, right: float, costs: Costs) -> bool:
    """Whether it is worth its questions to know if answers are worth anything.

    Args:
        nothing: The probability that they are not.
        right: How often they are right otherwise.
        costs: What things cost.
    """
    if not RULED_OUT < nothing < 1 - RULED_OUT:
        return False
    odds, known = log(nothing / (1 - nothing)), log(1 / RULED_OUT - 1)
    if nothing < 0.5:
        speaks = right * log(2 * right) + (1 - right) * log(2 * (1 - right))
    else:
        speaks = -0.5 * log(4 * right * (1 - right))
    answers = (known - abs(odds)) / max(speaks, 1e-9)
    price = (costs.question + costs.look) * answers
    return min(nothing, 1 - nothing) * LOST * costs.failure > price
