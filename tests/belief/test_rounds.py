"""Going round in circles: dearer each time, but not where faults explain it."""

from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.rounds import Rounds
from tpvqa.pddl import load_task

TASK = load_task("clean_dishes")
THERE, BACK = TASK.action("find", ["plate", "tv"]), TASK.action("find", ["sink", "plate"])
PROGRESS = 0.69
"""Of failures and disturbances of .25."""


def gone_round(times: int) -> Rounds:
    """Two actions, each done so often, one after the other."""
    rounds = Rounds(price=1.0)
    for _ in range(times):
        rounds.acted(0, THERE)
        rounds.acted(1, BACK)
    return rounds


def test_a_circle_of_ones_own_decisions_grows_dearer_than_a_failed_task() -> None:
    paid = [gone_round(times).dearer(THERE, 0, PROGRESS, 0.07) for times in (4, 10, 40)]
    assert paid[0] == 0.0
    assert 0.0 < paid[1] < paid[2]
    assert paid[2] > 500


@given(st.integers(0, 2000))
def test_where_every_other_action_undoes_something_to_come_back_is_no_circle(times: int) -> None:
    assert gone_round(times).dearer(THERE, 0, 0.02, 0.5) == 0.0


def test_to_repeat_an_action_is_no_coming_back() -> None:
    rounds = Rounds(price=1.0)
    for _ in range(100):
        rounds.acted(0, THERE)
    assert rounds.dearer(THERE, 0, PROGRESS, 0.0) == 0.0
