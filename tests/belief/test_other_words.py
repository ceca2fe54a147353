"""Answers in several wordings of a question: they err alike as far as that is known."""

from dataclasses import replace
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.belief.test_evidence import FIND, MODEL, NEAR, QUESTION
from tpvqa.belief import AnswerRates, Calibration, Group
from tpvqa.belief.answers.kinds import KINDS
from tpvqa.belief.answers.other_words import OtherWords
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import Rates
from tpvqa.belief.weighing.evidence import Evidence
from tpvqa.questions import FactQuestion
from tpvqa.vlm import Answer, Reply

KIND = next(each for each in KINDS if each.coin)
OTHERS = [
    replace(QUESTION, text=text, wording=number, first=QUESTION.text)
    for number, text in enumerate(("Can a plate be seen?", "Is it shown?"), start=1)
]
WORDS = [QUESTION, *OTHERS]
RIGHT = 0.8
OWN = (RIGHT - (1 - KIND.share) / 2) / KIND.share
"""How often the scene's own answer is right, where those drawn afresh are a coin's."""


def heard(answers: list[tuple[int, bool]], words: OtherWords) -> tuple[Belief, Evidence]:
    """After answers in one scene to `find plate`, with errors that last."""
    belief = Belief(MODEL)
    belief.act(FIND, Rates(0.25, 0.25, 0.0))
    calibration = Calibration(
        vlm="",
        whole=Group(rates=AnswerRates(RIGHT, 1 - RIGHT, 0, 0), rows=10**9),
        repeat_same_view=0.0,
        repeat_other_view=0.0,
        lasting=tuple(float(kind == KIND) for kind in KINDS),
    )
    evidence = Evidence(belief, calibration, None, unexplained=0.0, words=words)
    for look, (number, yes) in enumerate(answers):
        said = Answer(WORDS[number], Reply.YES if yes else Reply.NO)
        evidence.take(WORDS[number], said, look, None)
    return belief, evidence


def enumerated(answers: list[tuple[int, bool]], share: float) -> float:
    """P(near), by all that the scene's own answers in two wordings can be."""
    found = {True: 0.0, False: 0.0}
    for near, first, other in product((True, False), repeat=3):
        rate = OWN if near else 1 - OWN
        weight = (0.75 if near else 0.25) * (rate if first else 1 - rate)
        weight *= share * (first == other) + (1 - share) * (rate if other else 1 - rate)
        for number, yes in answers:
            drawn = KIND.share * (first, other)[number] + (1 - KIND.share) / 2
            weight *= drawn if yes else 1 - drawn
        found[near] += weight
    return found[True] / (found[True] + found[False])


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.tuples(st.integers(0, 1), st.booleans()), min_size=1, max_size=6),
    st.floats(0.01, 0.99),
)
def test_answers_in_two_wordings_weigh_as_brute_force_has_it(
    answers: list[tuple[int, bool]], share: float
) -> None:
    belief, _ = heard(answers, OtherWords(share))
    assert belief.probability(NEAR) == pytest.approx(enumerated(answers, share), abs=1e-5)


def settles(evidence: Evidence, question: FactQuestion) -> float:
    expected = evidence.expect(question, None)
    return expected.yes_if_true - expected.yes_if_false


def test_another_wording_tells_more_once_one_is_exhausted_if_it_errs_by_itself() -> None:
    noes = [(0, False)] * 6
    for share, least, most in ((0.001, 0.5, 0.7), (0.5, 0.2, 0.5), (0.999, 0.0, 0.05)):
        _, evidence = heard(noes, OtherWords(share))
        assert settles(evidence, QUESTION) < 0.05
        assert least <= settles(evidence, OTHERS[0]) <= most


def test_how_far_wordings_err_alike_is_learned_from_how_they_agree() -> None:
    agreeing, denying = OtherWords(), OtherWords()
    assert agreeing.share == pytest.approx(0.5)
    heard([(0, False)] * 6 + [(1, False)], agreeing)
    heard([(0, False)] * 6 + [(1, True)], denying)
    assert denying.share < 0.5 < agreeing.share
    stated = OtherWords(0.7)
    heard([(0, False)] * 6 + [(1, True)], stated)
    assert stated.share == pytest.approx(0.7)


def test_two_that_are_not_the_first_err_alike_by_both_of_them() -> None:
    words = OtherWords(0.5)
    assert words.between(WORDS[0], WORDS[2]) == pytest.approx(0.5)
    assert words.between(WORDS[1], WORDS[2]) == pytest.approx(0.25)
