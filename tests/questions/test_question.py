"""Questions about facts and questions about actions."""

from typing import get_args

from hypothesis import given
from hypothesis import strategies as st

from tpvqa.pddl import Action, Atom, Conjunction
from tpvqa.questions import ActionQuestion, ActionWay, FactQuestion, FactWay, Question, Way

ATOMS = st.builds(Atom, st.sampled_from(["on", "in_hand"]), st.tuples(st.sampled_from("abc")))
FACTS = st.builds(
    FactQuestion,
    st.sampled_from(["Is it?", "Is it not?"]),
    st.sampled_from(get_args(FactWay)),
    ATOMS,
    st.booleans(),
    st.lists(ATOMS, max_size=2).map(tuple),
)


def test_every_way_is_one_of_asking_about_facts_or_about_actions() -> None:
    assert (*get_args(FactWay), *get_args(ActionWay)) == tuple(Way)


@given(FACTS, st.frozensets(ATOMS))
def test_yes_is_right_where_the_fact_or_one_alike_is_true(
    question: FactQuestion, state: frozenset[Atom]
) -> None:
    assert question.true_in(state.__contains__) == bool({question.atom, *question.alike} & state)
    assert (question.literal.atom, question.literal.positive) == (question.atom, question.expected)


@given(FACTS, FACTS)
def test_equal_questions_have_one_hash(one: FactQuestion, other: FactQuestion) -> None:
    assert one != other or hash(one) == hash(other)


def test_of_an_action_yes_is_expected() -> None:
    wash = Action("wash", ("plate",), Conjunction(), ())
    question: Question = ActionQuestion("Was wash the plate successful?", Way.SUCCESSFUL, wash)
    assert isinstance(question, Question)
    assert question.expected
    assert question.subject == "wash"
