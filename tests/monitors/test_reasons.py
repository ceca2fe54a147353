"""What reasons say of facts and of actions, in whole trials."""

import re
from collections.abc import Iterable
from pathlib import Path

import pytest

from tests.monitors import test_errands
from tests.monitors.test_belief import TASK, planner, run
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.events import Decision, Event
from tpvqa.events.events import Acted, ActionRecord, Answered, Asked, Decided, PlanMade
from tpvqa.monitors.grounds import Grounds
from tpvqa.monitors.inspection import Inspection
from tpvqa.monitors.protocol import Step
from tpvqa.monitors.reasons import reason
from tpvqa.pddl import Atom, Literal, literals, task_from_text
from tpvqa.planning import Plan, Planner
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


PUMP = """(define (domain pump) (:requirements :strips :conditional-effects)
 (:predicates (running) (opened) (pressure))
 (:action open :parameters () :effect (and (opened) (when (running) (pressure))))
 (:action start :parameters () :effect (and (running) (when (opened) (pressure)))))"""
PIPES = """(define (problem pipes) (:domain pump) (:init) (:goal (pressure)))"""


@pytest.mark.parametrize(("running", "names"), [(False, "opened 0.70"), (True, "pressure 0.50")])
def test_a_repetition_is_told_from_what_it_can_bring_about(running: bool, names: str) -> None:
    """Where the pump is off, to open the valve once more gives no pressure."""
    task = task_from_text(PUMP, PIPES)
    pump, valve, pressure = (Atom.parse(f"({each})") for each in ("running", "opened", "pressure"))
    shut = frozenset((pump,) if running else ())
    opened = shut | {valve}
    belief, book = Belief(FaultModel(task)), QuestionBook.load(None, task)
    last = [(opened, 0.2), (opened | {pressure}, 0.5)] if running else [(opened, 0.7)]
    belief.begin([(shut, 0.3), *last])
    opening = task.action("open", [])
    step = Step(task, book, Plan((opening,), 1, "", 0.0), 0, shut)
    grounds = Grounds(
        step,
        FactWords(book),
        belief,
        Inspection(opening),
        plan=None,
        acted=True,
        unseen=frozenset(),
        questions_left=True,
        actions_left=None,
    )
    said = reason(grounds, Decision.REPEAT, opening, shut, 0)
    assert said == f"{names} (not worth asking); open again"


def _said(words: FactWords, literal: Literal) -> str:
    said = words.of(literal.atom)
    return said if literal.positive else f"not {said}"
