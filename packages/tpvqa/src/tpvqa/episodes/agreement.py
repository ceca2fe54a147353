"""Whether answers agree with what is expected: with what is believed to hold by now."""

from tpvqa.errors import TpvqaError
from tpvqa.events import Exchange, TrialState
from tpvqa.pddl import Atom, State, Task
from tpvqa.pddl.atoms import holds_in
from tpvqa.questions import FactWords


class Agreement:
    """Compares answers with the state that a trial expects.

    Before an action that is what is believed; after it, what is believed once the action has done
    what its effects say. A question that is to be denied (`expected` is false) says so itself; a
    monitor that weighs answers asks of every fact whether it holds, also of those that it takes to
    be gone.

    Args:
        words: Those of the trial, which know its task; without a task the questions' own
            expectation counts.
    """

    def __init__(self, words: FactWords):
        self._task = None if words.book is None else words.book.task

    def of(self, told: Exchange, state: TrialState) -> bool | None:
        """Whether an answer agrees; None where nothing is expected, or there is no answer.

        Args:
            told: The question with its answer.
            state: Where the trial stood when it was asked.
        """
        plain, atom = told.agrees, told.question.atom
        if plain is None or not told.question.expected or atom is None or self._task is None:
            return plain
        try:
            expected = _expected(self._task, state)
            atoms = (atom, *(told.question.alike or ()))
            holds = any(holds_in(Atom.parse(each), expected) for each in atoms)
        except TpvqaError:  # of a log that does not fit its own domain
            return plain
        return plain if holds else not plain


def _expected(task: Task, state: TrialState) -> State:
    """What is believed to hold when something is asked."""
    action = state.action
    if state.when == "before" or action is None:
        return task.extend(state.believed)
    done = task.action(action.name, action.arguments)
    return task.extend(task.apply(state.believed, done))
