"""How far doubts were settled counts for how far they will be."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.weighing.settling import Settling, Settlings

DOUBTS = st.dictionaries(
    st.sampled_from("abcd"), st.tuples(st.floats(0.01, 0.25), st.floats(0.0, 1.0))
)


def after(times: int, found: Settling, *, asked: str = "", ahead: tuple[int, int]) -> float:
    """How far answers are expected to settle what is in doubt, where that came of it so often."""
    settlings, (first, last) = Settlings(), ahead
    settlings.taken(found, first)
    for _ in range(times):
        settlings.acted(asked)
        settlings.taken(found, last)
    return settlings.taken(found, last)


def test_what_could_be_settled_and_was_not_asked_is_for_later() -> None:
    found = Settling(0.8, 3.0, {"a": (0.25, 0.9), "b": (0.07, 0.6)})
    assert after(6, found, ahead=(6, 0)) == pytest.approx(0.8)


def test_what_was_asked_and_is_in_doubt_still_will_be() -> None:
    found = Settling(0.8, 3.0, {"a": (0.25, 0.9), "b": (0.07, 0.6)})
    assert after(6, found, asked="a", ahead=(6, 0)) < 0.4


def test_what_cannot_be_settled_will_not_be() -> None:
    found = Settling(0.8, 3.0, {"a": (0.25, 0.1)})
    assert after(6, found, ahead=(6, 0)) < 0.4


def test_a_slight_doubt_counts_slightly() -> None:
    slight, grave = (Settling(0.8, 3.0, {"a": (doubt, 0.1)}) for doubt in (0.01, 0.25))
    assert after(6, slight, ahead=(6, 0)) > 0.7 > 0.4 > after(6, grave, ahead=(6, 0))


def test_to_act_and_come_no_nearer_says_that_less_is_settled() -> None:
    found = Settling(0.8, 3.0, {})
    told = [after(times, found, ahead=(6, 6)) for times in (0, 6, 60)]
    assert told[0] == pytest.approx(0.8)
    assert 0.4 < told[1] < 0.6
    assert told[2] < 0.2


def test_in_a_long_task_doubts_wait_and_answers_that_settle_them_are_not_in_vain() -> None:
    waiting = [(Settling(share, 3.0, {"a": (0.25, 0.4)})) for share in (0.6, 0.9, 0.9699)]
    short, long = ([after(60, each, ahead=(n, n)) for each in waiting] for n in (14, 15))
    assert max(short) < 0.1
    assert long[0] < 0.1 < 0.5 < long[1] < 0.9
    assert long[2] == pytest.approx(0.97, abs=0.01)  # no leap at .97


@given(
    st.lists(st.tuples(DOUBTS, st.sets(st.sampled_from("abcd")), st.integers(0, 30)), max_size=20)
)
def test_it_is_a_share(steps: list[tuple[dict[str, tuple[float, float]], set[str], int]]) -> None:
    settlings = Settlings()
    for doubts, asked, ahead in steps:
        found = Settling(0.7, 1.0, doubts)
        assert 0.0 <= settlings.taken(found, ahead) <= 0.7 + 1e-9
        settlings.acted(asked)


def test_where_the_goal_was_farther_than_thought_to_come_nearer_counts() -> None:
    settlings, found = Settlings(), Settling(0.8, 3.0, {})
    settlings.taken(found, 0)
    for ahead in range(10, 0, -1):
        settlings.acted(())
        settlings.taken(found, ahead)
    assert settlings.taken(found, 1) > 0.75
    assert 1.0 <= settlings.dearer < 1.1
