"""What the right answer to a question is, in a simulated world."""

from collections.abc import Mapping
from functools import lru_cache

from tpvqa.events.events import QuestionRecord
from tpvqa.labelling.recorded import OF_FACTS
from tpvqa.pddl import Action, Atom
from tpvqa.pddl.atoms import holds_in
from tpvqa.questions import Way
from tpvqa.worlds.simulation import Simulation


def yes_is_right(
    question: QuestionRecord, simulation: Simulation, actions: Mapping[str, Action]
) -> bool:
    """Whether yes is the right answer now.

    A fact is judged by the true state, "possible" means that all preconditions hold, "successful"
    that all effects do.

    Args:
        question: What is asked.
        simulation: The true state.
        actions: The task's ground actions, by their PDDL.
    """
    if question.atom is not None and question.way in OF_FACTS:
        state = simulation.task.extend(simulation.state)
        return any(
            holds_in(_atom(text), state) for text in (question.atom, *(question.alike or ()))
        )
    assert question.action is not None
    action = actions[question.action]
    if question.way is Way.POSSIBLE:
        return simulation.possible(action)
    return simulation.achieved(action)


_atom = lru_cache(maxsize=4096)(Atom.parse)
