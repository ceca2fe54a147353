"""A survey asks everything and lets nothing change."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from tests.doubles import perform
from tpvqa.errors import PluginError
from tpvqa.monitors import Decision, Step
from tpvqa.monitors.survey import Survey
from tpvqa.questions import Question
from tpvqa.vlm import Reply


def no(question: Question) -> Reply:
    return Reply.NO


def test_it_asks_all_at_every_look_and_goes_on_whatever_is_answered(
    at: Callable[..., Step],
) -> None:
    step = at(1)
    before, looks, asked = perform(Survey(5).before(step), no)
    assert (before.decision, before.state, looks) == (Decision.GO_ON, None, 5)
    once = [question.text for question in step.book.preconditions(step.action, step.state)]
    assert asked == once * 5
    after, looks, asked = perform(Survey(2).after(step), no)
    assert (after.decision, looks) == (Decision.GO_ON, 2)
    assert after.state == step.task.apply(step.state, step.action)


@pytest.mark.parametrize("spec", ["0", "-1", "many", "5:often", "twice:5", ":twice"])
def test_a_number_of_looks_that_is_none_is_said(spec: str) -> None:
    with pytest.raises(PluginError, match="survey:5"):
        Survey.from_spec(spec)


def test_its_name_says_how_often_it_looks() -> None:
    assert Survey.from_spec("3").name == "survey:3"
    assert Survey.from_spec().looks == 8


def test_it_may_do_every_action_twice(at: Callable[..., Step]) -> None:
    survey = Survey.from_spec("2:twice")
    assert (survey.name, Survey.from_spec("twice").name) == ("survey:2:twice", "survey:8:twice")
    again, looks, _ = perform(survey.after(at(1)), no)
    assert (again.decision, again.state, looks) == (Decision.REPEAT, None, 2)
    for second in (replace(at(1), attempt=1), replace(at(1), repeats_left=0)):
        assert perform(survey.after(second), no)[0].decision is Decision.GO_ON
