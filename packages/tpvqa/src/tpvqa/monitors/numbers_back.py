"""A number that came with a fact goes with it: the load of a basket out of which a sample fell."""

from collections.abc import Collection, Generator
from typing import Any

from tpvqa.monitors.asker import Asks
from tpvqa.monitors.memory import FactMemory
from tpvqa.monitors.protocol import Step
from tpvqa.monitors.requests import Request
from tpvqa.pddl import Atom, Literal, State
from tpvqa.pddl.arithmetic import Words, values_in, written
from tpvqa.pddl.likewise import numbers_likewise
from tpvqa.pddl.numeric import with_values
from tpvqa.questions import Way
from tpvqa.vlm import Reply


def numbers_back(
    asker: Asks, step: Step, memory: FactMemory, denied: Collection[Literal], state: State
) -> Generator[Request, Any, State]:
    """The state in which what came with denied facts is taken back from numbers, too.

    Where a question can tell it is asked, and only a yes takes anything back. Of what cannot be
    asked it is as after the action that undoes what was denied, where there is one; else what had
    become more is taken back, and what was used up is gone.

    Args:
        asker: Who asks.
        step: Where the trial stands.
        memory: Knows what came with what.
        denied: The facts that were denied.
        state: The state without them.
    """
    likewise = numbers_likewise(step.task, step.state, state)
    values = {} if likewise is None else values_in(likewise)
    for literal in denied:
        for words, by in (
            memory.came_with(literal.atom, step.state).items() if literal.positive else ()
        ):
            value = values_in(state)[words]
            comparison = ">=" if by < 0 else "<="
            back = Literal(Atom(comparison, (*words, written(value - by))))
            if step.book.asked(back):
                question = step.book.fact(back, way=Way.ALTERNATIVE)
                (answer,) = yield from asker.tell((question,))
                if answer.reply is not Reply.YES:
                    continue
            elif words in values or by < 0:
                continue
            state = with_values(state, {words: value - by})
    unasked = {words: value for words, value in values.items() if not _asked(step, words)}
    return with_values(state, unasked)


def _asked(step: Step, words: Words) -> bool:
    return step.book.asked(Literal(Atom(">=", (*words, "0"))))
