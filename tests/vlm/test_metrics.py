"""Figures over answers, against definitions written out."""

from dataclasses import astuple, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.vlm import Reply
from tpvqa.vlm.metrics import Scored, auroc, calibration_error, measure


def row(reply: Reply, truth: bool, *, visible: bool = True, hard: bool = False) -> Scored:
    p_yes = {Reply.YES: 0.9, Reply.NO: 0.1}.get(reply)
    return Scored(reply, truth, p_yes, visible, hard)


def test_rates_are_over_visible_facts_only() -> None:
    found = measure(
        [
            row(Reply.YES, True),
            row(Reply.NO, True),
            row(Reply.YES, False, hard=True),
            row(Reply.NO, False),
            row(Reply.CANNOT_SEE, False),
            row(Reply.CANNOT_SEE, True, visible=False),
            row(Reply.YES, True, visible=False),
        ]
    )
    assert found.visible == 5
    assert found.accuracy == pytest.approx(2 / 5)
    assert found.false_positive_rate == pytest.approx(1 / 3)
    assert found.false_negative_rate == pytest.approx(1 / 2)
    assert found.abstained == pytest.approx(1 / 5)
    assert found.hard_no == 0.0
    assert found.hidden == 2
    assert found.cannot_see_rightly == pytest.approx(1 / 2)


def test_nothing_to_count_is_none_and_not_zero() -> None:
    found = measure([])
    assert found.accuracy is None
    assert found.auroc is None
    assert found.calibration_error is None


_ROWS = st.builds(
    Scored,
    reply=st.sampled_from(Reply),
    truth=st.booleans(),
    p_yes=st.none() | st.sampled_from([0.0, 0.1, 0.5, 1.0]),
    visible=st.booleans(),
    hard=st.booleans(),
    count=st.integers(1, 4),
)


@given(st.lists(_ROWS, max_size=8))
def test_a_count_is_worth_so_many_rows(rows: list[Scored]) -> None:
    each = [replace(row, count=1) for row in rows for _ in range(row.count)]
    assert astuple(measure(rows)) == pytest.approx(astuple(measure(each)), nan_ok=True)


def test_a_billion_answers_take_no_room() -> None:
    assert measure([replace(row(Reply.YES, True), count=10**9)] * 2).visible == 2 * 10**9


@given(st.lists(st.tuples(st.integers(0, 5), st.booleans()), min_size=1, max_size=30))
def test_auroc_is_the_chance_that_a_yes_scores_above_a_no(pairs: list[tuple[int, bool]]) -> None:
    yes = [score for score, truth in pairs if truth]
    no = [score for score, truth in pairs if not truth]
    found = auroc(np.array([s for s, _ in pairs], float), np.array([t for _, t in pairs]))
    if not yes or not no:
        assert found is None
    else:
        wins = sum((y > n) + 0.5 * (y == n) for y in yes for n in no)
        assert found == pytest.approx(wins / (len(yes) * len(no)))


def test_calibration_error_is_the_gap_between_said_and_true() -> None:
    p_yes, truth = np.array([0.95, 0.95, 0.05, 0.05]), np.array([True, False, False, False])
    assert calibration_error(p_yes, truth) == pytest.approx((0.45 + 0.05) / 2)
