"""How errors last and repeat, as far as it is learnt from answers beside the truth."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpvqa.belief import LabelledAnswer
from tpvqa.belief.calibrating.calibration import AnswerRates
from tpvqa.belief.calibrating.repeats import Repeats, fit_repeats
from tpvqa.questions import Way
from tpvqa.vlm import Reply

Heard = tuple[bool, bool, bool]
"""Whether it was asked as an effect, whether yes was right, and whether that was said."""


def fitted(heard: list[Heard], effect: float, precondition: float) -> Repeats:
    """What is learnt of answers to the same words, by how often yes is said of each way."""
    rates = {Way.EFFECT: effect, Way.PRECONDITION: precondition}
    rows = [
        LabelledAnswer(
            Way.EFFECT if as_effect else Way.PRECONDITION,
            "on",
            "Is it on?",
            truth,
            Reply.YES if yes else Reply.NO,
            None,
            "1",
            look,
        )
        for look, (as_effect, truth, yes) in enumerate(heard)
    ]
    return fit_repeats(
        rows,
        lambda row: AnswerRates(rates[row.way], rates[row.way] / 2, 0.0, 0.0),
        same_view=0.1,
        other_view=0.05,
    )


def test_who_says_yes_of_one_way_of_asking_and_no_of_the_other() -> None:
    said = "yyyyyyyynnnnynnnyyyyyyyynnnnnnnn"
    heard = [(n % 16 < 8, True, reply == "y") for n, reply in enumerate(said)]
    found = fitted(heard, effect=0.9999932387021971, precondition=0.9060713656964564)
    assert sum(found.lasting) == pytest.approx(1, abs=1e-3)


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(st.booleans(), st.booleans(), st.booleans()), min_size=2, max_size=60),
    st.floats(1e-7, 1 - 1e-7),
    st.floats(1e-7, 1 - 1e-7),
)
def test_how_errors_last_is_always_a_distribution(
    heard: list[Heard], effect: float, precondition: float
) -> None:
    found = fitted(heard, effect, precondition)
    assert sum(found.lasting) == pytest.approx(1, abs=1e-3)
    assert all(0 <= each <= 1 for each in (*found.lasting, *found.rho))
