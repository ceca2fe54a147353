"""Intervals, paired tests, limits and crossings, against figures known from elsewhere."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.bench.curve import crossing
from tpvqa.bench.limits import sensitivity
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.statistics import paired, wilson


def test_the_wilson_interval_of_newcombes_example() -> None:
    """81 of 263: Newcombe 1998, table I, method 3."""
    found = wilson(81, 263)
    assert (round(found.low, 4), round(found.high, 4)) == (0.2553, 0.3662)


@given(st.integers(1, 300).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_an_interval_holds_its_rate_and_stays_within_zero_and_one(counts: tuple[int, int]) -> None:
    found = wilson(*counts)
    assert 0 <= found.low <= found.rate + 1e-12
    assert found.rate - 1e-12 <= found.high <= 1


def test_mcnemars_test_counts_only_where_the_monitors_differ() -> None:
    first = [True] * 9 + [False] * 1 + [True] * 50
    second = [False] * 9 + [True] * 1 + [True] * 50
    found = paired(first, second)
    assert (found.only_first, found.only_second) == (9, 1)
    assert found.difference == pytest.approx(8 / 60)
    assert found.p == pytest.approx(22 / 1024)  # two-sided binomial of 9 and 1
    assert paired(first, first).p == 1


def row(**figures: object) -> EpisodeRow:
    base = {"task": "t", "monitor": "m", "vlm": "v", "world": "w", "seed": 0, "episode": 0}
    believed = {"believed_goal": figures.get("completed", False)}
    return EpisodeRow.model_validate({**base, **believed, **figures})


def test_tighter_limits_take_completions_away_one_by_one() -> None:
    rows = [
        row(completed=True, actions=4, longest_repeat=0, replans=0),
        row(completed=True, actions=14, longest_repeat=3, replans=2),
        row(completed=False, because="limit of replans", actions=30, replans=10),
        row(completed=False, because="goal", believed_goal=True, actions=4),
    ]
    found = sensitivity(rows)
    assert found["actions"][12] == 0.25
    assert found["actions"][16] == found["actions"][60] == 0.5
    assert (found["repeats"][2], found["repeats"][3]) == (0.25, 0.5)
    assert (found["replans"][1], found["replans"][2]) == (0.25, 0.5)


@pytest.mark.parametrize(
    ("rates", "level", "at"),
    [
        ((0.0, 0.2, 0.6), 0.4, 0.85),
        ((0.5, 0.6, 0.7), 0.4, 0.7),
        ((0.1, 0.1, 0.2), 0.4, None),
        ((0.5, 0.3, 0.5), 0.4, 0.85),
    ],
)
def test_where_a_curve_crosses_a_level(rates: tuple[float, ...], level: float, at: object) -> None:
    found = crossing(dict(zip((0.7, 0.8, 0.9), rates, strict=True)), level)
    assert found == (at if at is None else pytest.approx(at))
