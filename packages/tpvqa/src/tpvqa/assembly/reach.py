"""Which facts can ever hold in a trial: what actions, mishaps and its start bring about."""

from tpvqa.belief.priors import Priors
from tpvqa.pddl import Task
from tpvqa.questions import QuestionBook
from tpvqa.worlds.world_file import WorldRules


def asking(book: QuestionBook, task: Task, rules: WorldRules, priors: Priors) -> QuestionBook:
    """A book that asks about nothing that can never hold.

    Args:
        book: The book.
        task: The task, in which all that the priors name may hold at first.
        rules: What may happen besides actions.
        priors: What is known at first; where that is nothing, anything may hold. Of a predicate
            that rules or priors name, any fact may.
    """
    if priors.nothing_known or task.lasting is not None:
        return book
    added = {each.predicate for rule in rules.undo for o in rule.outcomes for each in o.add}
    stated = {form.predicate for form, _ in priors.facts}
    can_hold = task.atoms() | task.init | task.besides | task.left_open
    return book.within(can_hold, task.derived | added | stated)
