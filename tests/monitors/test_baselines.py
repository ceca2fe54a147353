"""The paper's baselines at their seam, with the paper's questions."""

from collections.abc import Callable

import pytest

from tests.doubles import knowing, perform, replies
from tests.monitors.conftest import agree
from tpvqa.errors import PluginError
from tpvqa.monitors import Decision, Monitor, Step
from tpvqa.monitors.effect_vqa import EffectVQA
from tpvqa.monitors.palme_vqa import PaLMEVQA
from tpvqa.monitors.success_vqa import SuccessVQA
from tpvqa.monitors.tpvqa import TPVQA
from tpvqa.pddl import Atom
from tpvqa.plugins import Kind, make
from tpvqa.questions import Question
from tpvqa.vlm import Reply

At = Callable[..., Step]
POSSIBLE = "Is it possible to wash the plate here?"
SUCCESSFUL = "Was wash the plate successful?"
DID = "Did the robot successfully wash the plate?"


@pytest.mark.parametrize("spec", ["effectvqa", "tp", "palmevqa", "successvqa", "tpvqa:3"])
def test_every_baseline_has_a_name_and_believes_what_is_affirmed(spec: str, at: At) -> None:
    monitor: Monitor = make(Kind.MONITOR, spec)
    step = at(3)
    before, _, _ = perform(monitor.before(step), agree)
    assert before.decision is Decision.GO_ON
    after, _, _ = perform(monitor.after(step), agree)
    assert after.decision is Decision.GO_ON
    assert after.state == step.task.apply(step.state, step.action)


def test_effectvqa_asks_effects_and_never_preconditions(at: At) -> None:
    verdict, looks, asked = perform(EffectVQA().before(at(1)), replies({}, Reply.NO))
    assert (verdict.decision, looks, asked) == (Decision.GO_ON, 0, [])
    verdict, _, asked = perform(EffectVQA().after(at(1)), knowing("(on plate table)"))
    assert asked == ["Is the plate in a robot's hand?", "Is the plate on the table?"]
    assert verdict.decision is Decision.REPEAT


def test_successvqa_asks_only_whether_the_robot_did_it(at: At) -> None:
    _, _, asked = perform(SuccessVQA().before(at(3)), replies({}, Reply.NO))
    assert asked == []
    verdict, looks, asked = perform(SuccessVQA().after(at(3)), replies({}, Reply.NO))
    assert (verdict.decision, looks, asked) == (Decision.REPEAT, 1, [DID])


def test_palmevqa_takes_all_preconditions_out_when_an_action_is_not_possible(at: At) -> None:
    monitor = PaLMEVQA()
    step = at(3, monitor)
    verdict, _, asked = perform(monitor.before(step), replies({}, Reply.NO))
    assert asked == [POSSIBLE]
    assert verdict.decision is Decision.REPLAN
    assert verdict.state is not None
    assert step.state - verdict.state == {
        Atom("in_hand", ("plate", "left")),
        Atom("near", ("sink",)),
    }
    assert Atom("on", ("plate", "table")) in verdict.state
    verdict, _, asked = perform(monitor.after(step), replies({}, Reply.NO))
    assert (verdict.decision, asked) == (Decision.REPEAT, [SUCCESSFUL])


def test_palmevqa_acts_when_there_is_nothing_to_take_out(at: At) -> None:
    verdict, looks, _ = perform(PaLMEVQA().before(at(0)), replies({}, Reply.NO))
    assert (verdict.decision, looks) == (Decision.GO_ON, 2)


def test_palmevqa_can_start_over(at: At) -> None:
    step = at(3)
    verdict, _, _ = perform(PaLMEVQA(start_over=True).before(step), replies({}, Reply.NO))
    assert (verdict.decision, verdict.state) == (Decision.REPLAN, step.task.init)


@pytest.mark.parametrize("monitor", [EffectVQA, PaLMEVQA, SuccessVQA])
def test_no_answer_at_all_stops_safely(monitor: Callable[..., Monitor], at: At) -> None:
    verdict, looks, _ = perform(monitor(looks=2).after(at(3)), replies({}, Reply.UNKNOWN))
    assert (verdict.decision, looks) == (Decision.GIVE_UP, 3)


def test_a_vote_outweighs_one_wrong_look_and_a_single_look_does_not(at: At) -> None:
    def second_look_errs() -> Callable[[Question], Reply]:
        told: dict[str, int] = {}

        def reply(question: Question) -> Reply:
            told[question.text] = told.get(question.text, 0) + 1
            right = agree(question)
            wrong = Reply.NO if right is Reply.YES else Reply.YES
            return wrong if told[question.text] == 1 else right

        return reply

    verdict, looks, asked = perform(TPVQA(votes=3).after(at(1)), second_look_errs())
    assert (verdict.decision, looks, len(asked)) == (Decision.GO_ON, 3, 6)
    verdict, _, _ = perform(TPVQA().after(at(1)), second_look_errs())
    assert verdict.decision is Decision.REPEAT


def test_a_tied_vote_abstains(at: At) -> None:
    answers = iter([Reply.YES, Reply.NO] * 4)
    verdict, looks, _ = perform(
        TPVQA(votes=2, looks=1).after(at(0)), lambda question: next(answers)
    )
    assert (verdict.decision, looks) == (Decision.GIVE_UP, 4)


@pytest.mark.parametrize("spec", ["tpvqa:0", "tpvqa:many", "palmevqa:again"])
def test_arguments_that_mean_nothing_are_refused(spec: str) -> None:
    with pytest.raises(PluginError):
        make(Kind.MONITOR, spec)
