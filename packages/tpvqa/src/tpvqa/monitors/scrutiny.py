"""Looking closely at how an action came out that may never work."""

from collections.abc import Callable, Sequence

from tpvqa.belief.deciding.inquiry import Budget, Inquiry
from tpvqa.belief.filtering.belief import Belief
from tpvqa.monitors.inspection import Inspection
from tpvqa.pddl import Atom, literals
from tpvqa.questions import FactQuestion, QuestionBook

TELLING = 0.8
"""Where answers settle less, how an action came out is not looked at closely."""
KNOWN = 0.01
"""How it came out is asked about until nothing of it is less sure than this."""


def unknown(
    now: Inspection,
    belief: Belief,
    book: QuestionBook,
    budget: Budget,
    views: Callable[[FactQuestion], Sequence[str | None]],
) -> Inquiry | None:
    """What is least known of whether the last action could work, and whether it did.

    Which way to go does not depend on it, so that no answer would save anything now. Whether the
    action is tried in vain ever after does.

    Args:
        now: What happened since the last action.
        belief: What is believed.
        book: The questions.
        budget: What may still be asked and looked at.
        views: From where a question may find an answer.

    Returns:
        What to ask; None where all is known or nothing may be asked.
    """
    if now.action is None:
        return None
    needed = {literal.atom for literal in literals(now.action.precondition)}
    return least_known(now.effects | needed, now, belief, book, budget, views)


def least_known(
    atoms: frozenset[Atom],
    now: Inspection,
    belief: Belief,
    book: QuestionBook,
    budget: Budget,
    views: Callable[[FactQuestion], Sequence[str | None]],
    *,
    at_first: float = KNOWN,
) -> Inquiry | None:
    """The question about some facts that is least settled.

    Args:
        atoms: The facts; the other arguments as those of `unknown`.
        at_first: What has not been asked about since the last action is, until it is surer than
            this.
    """
    if min(budget.questions, budget.looks) <= 0:
        return None
    doubt = dict[FactQuestion, float]()
    for question in now.about(atoms, book):
        likely = belief.probability(question.atom, question.alike)
        known = KNOWN if question.text in now.replies else at_first
        if views(question) and known <= likely <= 1 - known:
            doubt[question] = abs(likely - 0.5)
    least = min(doubt, key=doubt.__getitem__, default=None)
    return None if least is None else Inquiry(least, 1, 0.0)
