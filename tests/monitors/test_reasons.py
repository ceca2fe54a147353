"""What reasons say of facts and of actions, in whole trials."""

import re
from collections.abc import Iterable
from pathlib import Path

from tests.monitors import test_errands
from tests.monitors.test_belief import TASK, planner, run
from tpvqa.events import Event
from tpvqa.events.events import Acted, ActionRecord, Answered, Asked, Decided, PlanMade
from tpvqa.pddl import Literal, literals
from tpvqa.planning import Planner
from tpvqa.questions import QuestionBook
from tpvqa.questions.fact_words import FactWords
from tpvqa.tasks import find_task
from tpvqa.vlm import Reply

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


def test_only_a_fact_whose_own_question_found_no_answer_is_out_of_view(tmp_path: Path) -> None:
    """That what is asked of the lamp cannot be seen says nothing of where the robot is."""
    told = [_out_of_view(test_errands.run(tmp_path, n)[1]) for n in range(2)]
    assert any(told)
    for hidden, unanswered in (pair for each in told for pair in each):
        assert hidden in unanswered


def _out_of_view(events: Iterable[Event]) -> list[tuple[str, set[str]]]:
    """The facts that reasons call out of view, each with those whose questions had no answer."""
    found: list[tuple[str, set[str]]] = []
    asked, unanswered = "", set[str]()
    for event in events:
        match event:
            case Acted():
                unanswered = set()
            case Asked(questions=questions):
                asked = re.sub(r"^Is (it true: |the )?|\?$", "", questions[0].text)
            case Answered(answers=answers) if answers[0].reply is Reply.CANNOT_SEE:
                unanswered |= {asked}
            case Decided():
                told = re.findall(r"(?:^|; )([^;]*) \d\.\d\d \(out of view\)", event.reason)
                found += [(each.removeprefix("not "), unanswered) for each in told]
    return found


def _said(words: FactWords, literal: Literal) -> str:
    said = words.of(literal.atom)
    return said if literal.positive else f"not {said}"
