"""What could be brought about if nothing were undone: as told by going through all, each time."""

from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.states.relaxation import Needs, Relaxation, Way

FACTS = 6
BITS = st.integers(0, 2**FACTS - 1)
NEEDS = st.tuples(st.integers(0, FACTS - 1), st.integers(0, FACTS - 1), BITS).map(
    lambda given: (1 << given[0], (1 << given[1]) & given[2] & ~(1 << given[0]))
)
WAYS = st.lists(st.tuples(NEEDS, BITS, BITS), max_size=12)


def reached(ways: list[Way], true: int, goal: Needs) -> bool:
    """By going through all ways until nothing new is brought about."""
    false, before = ~true, None
    while before != (true, false):
        before = true, false
        for (need, bar), add, delete in ways:
            if not (need & ~true or bar & ~false):
                true, false = true | add, false | delete
    return not (goal[0] & ~true or goal[1] & ~false)


@given(WAYS, st.lists(st.tuples(BITS, st.tuples(BITS, BITS)), min_size=1, max_size=12))
def test_what_was_enough_before_tells_the_same_of_another_state(
    ways: list[Way], asked: list[tuple[int, Needs]]
) -> None:
    for goal in {goal for _, goal in asked}:
        relaxation = Relaxation(ways)
        for true, _ in asked:
            assert relaxation.reaches(true, goal) == reached(ways, true, goal)
