"""Looking closely at how an action came out that may never work."""

from collections.abc import Callable, Sequence

from tpvqa.belief.belief import Belief
from tpvqa.belief.inquiry import Budget, Inquiry
from tpvqa.monitors.inspection import Inspection
from tpvqa.pddl import Atom, literals
from tpvqa.questions import FactQuestion, QuestionBook

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
) -> Inquiry | None:
    """The question about some facts that is least settled; arguments as those of `unknown`."""
    if min(budget.questions, budget.looks) <= 0:
        return None
    sure = {
        question: abs(belief.probability(question.atom, question.alike) - 0.5)
        for question in now.about(atoms, book)
        if views(question)
    }
    least = min(sure, key=sure.__getitem__, default=None)
    return None if least is None or sure[least] > 0.5 - KNOWN else Inquiry(least, 1, 0.0)
