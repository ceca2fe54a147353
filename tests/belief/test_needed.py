"""Plans gone through from many states at once: as one state after the other tells it."""

from hypothesis import given
from hypothesis import strategies as st

from tests.planning.random_states import random_states
from tpvqa.belief.faults import FaultModel, JointState
from tpvqa.belief.needed import Needed
from tpvqa.pddl import load_task

BLOCKS = load_task("build_tower")


@given(st.data())
def test_steps_that_change_something_are_those_that_do_so_one_by_one(data: st.DataObject) -> None:
    model = FaultModel(BLOCKS)
    actions = st.sampled_from(sorted(BLOCKS.ground_actions(), key=str))
    plan = data.draw(st.lists(actions, min_size=1, max_size=20))
    masks = model.masks(plan)
    assert masks is not None
    needed = Needed(masks)
    seed = data.draw(st.integers(0, 1000))
    for state in random_states(BLOCKS, seed=seed, count=5):
        first = data.draw(st.integers(0, len(plan)))
        number = model.number(JointState(state, ()))
        changes, holding = needed.walk(first, model.holding(number))
        here, truly = state, list[bool]()
        for action in plan[first:]:
            applicable = BLOCKS.applicable(here, action)
            after = BLOCKS.apply(here, action) if applicable else here
            truly.append(after != here)
            here = after
        assert changes == truly
        assert holding == model.holding(model.number(JointState(here, ())))
        assert model.goal_within(holding) == BLOCKS.goal_holds(here)
