"""Going round in circles: dearer each time, but not where faults explain it."""

from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.deciding.rounds import Rounds
from tpvqa.pddl import load_task

TASK = load_task("clean_dishes")
THERE, BACK = TASK.action("find", ["plate", "tv"]), TASK.action("find", ["sink", "plate"])
CLOSE = TASK.action("find", ["tv", "sink"])
PROGRESS = 0.69
"""Of failures and disturbances of .25."""


def believed(state: int, number: int = 0) -> list[tuple[int, float]]:
    """A joint state that is most probable, and another one that is always as probable; at each of
    several times another belief else."""
    return [(state, 0.5), (100, 0.3), (1000 + number, 0.2)]


def gone_round(times: int, *, news: bool = False, undone: bool = False) -> Rounds:
    """Two actions, each done so often, one after the other."""
    rounds = Rounds(price=1.0)
    for number in range(times):
        rounds.acted(THERE, believed(0, news * number), None if undone else 1)
        rounds.acted(BACK, believed(1, news * number), 0)
    return rounds


def dearer(rounds: Rounds, times: int, undone: float = 0.07) -> float:
    """What it costs more to begin once more, after so many rounds that may have told something."""
    return rounds.dearer(THERE, believed(0, times), PROGRESS, undone)


def test_a_circle_of_ones_own_decisions_grows_dearer_than_a_failed_task() -> None:
    paid = [dearer(gone_round(times, news=True), times) for times in (4, 10, 40)]
    assert paid[0] == 0.0
    assert 0.0 < paid[1] < paid[2]
    assert paid[2] > 500


def test_a_round_on_purpose_of_which_nothing_came_is_dear_at_once() -> None:
    assert dearer(gone_round(1), 0) == 1.0
    assert dearer(gone_round(2), 0) > 1.0
    assert dearer(gone_round(2), 2) == 0.0  # something else is believed now


def test_what_led_nowhere_and_is_come_back_to_costs_no_more() -> None:
    """A lid that does not close: what was done in between went round, not who tries it again."""
    rounds = Rounds(price=1.0)
    rounds.acted(CLOSE, believed(0), 2)
    rounds.acted(THERE, believed(0), 1)
    rounds.acted(BACK, believed(1), 0)
    assert rounds.dearer(CLOSE, believed(0), PROGRESS, 0.0) == 0.0
    assert rounds.dearer(THERE, believed(0), PROGRESS, 0.0) == 1.0


def test_a_round_is_paid_once() -> None:
    """Where it was begun anew: who is half way round goes the rest of it."""
    rounds = gone_round(1)
    rounds.acted(THERE, believed(0), 1)
    assert rounds.dearer(BACK, believed(1), PROGRESS, 0.0) == 0.0
    rounds.acted(BACK, believed(1), 0)
    assert dearer(rounds, 0) == 4.0


def test_a_round_in_vain_makes_others_dear() -> None:
    rounds = gone_round(3)
    rounds.acted(THERE, believed(50), 51)
    rounds.acted(BACK, believed(51), 50)
    assert rounds.dearer(THERE, believed(50), PROGRESS, 0.0) > dearer(gone_round(1), 0)


def test_where_something_else_happened_than_was_done_a_round_is_explained() -> None:
    assert dearer(gone_round(2, undone=True), 0) == 0.0


def test_with_other_numbers_of_joint_states_a_round_is_the_same() -> None:
    rounds = gone_round(2)
    before = dearer(rounds, 0)
    rounds.renumbered({0: 10, 1: 11, 100: 12, 1000: 13})
    assert rounds.dearer(THERE, [(10, 0.5), (12, 0.3), (13, 0.2)], PROGRESS, 0.07) == before


@given(st.integers(0, 2000))
def test_where_every_other_action_undoes_something_to_come_back_is_no_circle(times: int) -> None:
    rounds = gone_round(times, news=True)
    assert rounds.dearer(THERE, believed(0, -1), 0.02, 0.5) == 0.0


def test_to_repeat_an_action_is_no_coming_back() -> None:
    rounds = Rounds(price=1.0)
    for _ in range(100):
        rounds.acted(THERE, believed(0), 0)
    assert dearer(rounds, 0) == 0.0
