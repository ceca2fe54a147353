"""What a reason says that an action is done before its turn for, in whole trials."""

import re

from tests.monitors.test_belief import TASK, planner, run
from tpvqa.events.events import ActionRecord, Decided, PlanMade
from tpvqa.pddl import Literal, literals
from tpvqa.planning import Planner
from tpvqa.questions import QuestionBook
from tpvqa.questions.fact_words import FactWords
from tpvqa.tasks import find_task

__all__ = ["planner"]


def test_a_step_before_its_turn_is_told_from_what_it_needs_or_what_comes_before_it_did(
    planner: Planner,
) -> None:
    """To find the plate needs no bread in the hand: the bread need not be picked up again."""
    told = re.compile(r"on to [^;]*, (which can be|as what comes before it is) done [^;]*")
    words = FactWords(QuestionBook.load(find_task("serve_breakfast").questions, TASK))
    seen = set[str]()
    for n in range(4, 10):
        plan: tuple[ActionRecord, ...] = ()
        _, events, _ = run(planner, "belief", vlm="oracle:0.7:0:0.74", episode=n)
        for event in events:
            if isinstance(event, PlanMade) and not event.considered and event.plan:
                plan = event.plan
            if isinstance(event, Decided) and (found := told.search(event.reason)):
                assert event.onto is not None
                *before, step = (
                    TASK.action(each.name, each.arguments) for each in plan[: event.onto + 1]
                )
                needs = [_said(words, each) for each in literals(step.precondition)]
                brought = [_said(words, e.literal) for each in before for e in each.effects]
                named = any(f" {each} (" in found[0] for each in needs)
                done = any(f" {each} (" in found[0] for each in brought)
                assert (done and not named) == (found[1] != "which can be"), event.reason
                seen.add(found[1])
    assert len(seen) == 2


def _said(words: FactWords, literal: Literal) -> str:
    said = words.of(literal.atom)
    return said if literal.positive else f"not {said}"
