"""A survey asks everything and lets nothing change."""

from collections.abc import Callable

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


@pytest.mark.parametrize("spec", ["0", "-1", "many"])
def test_a_number_of_looks_that_is_none_is_said(spec: str) -> None:
    with pytest.raises(PluginError, match="survey:5"):
        Survey.from_spec(spec)


def test_its_name_says_how_often_it_looks() -> None:
    assert Survey.from_spec("3").name == "survey:3"
    assert Survey.from_spec().looks == 8
