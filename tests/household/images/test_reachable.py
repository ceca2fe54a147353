from collections.abc import Callable

from hypothesis import given, settings
from hypothesis import strategies as st

from tests.household.images.conftest import task_and_rules
from tpvqa.chance import chance
from tpvqa.worlds.simulation import Simulation
from tpvqa_household.images.reachable import Reachable, kind
from tpvqa_household.images.visible import describe, visible_state


def test_the_plans_are_those_of_the_papers_table(shipped_reachable: list[Reachable]) -> None:
    names = {task.task: [(k[0], k[1]) for k in task.nominal] for task in shipped_reachable}
    assert names["clean_dishes"] == [
        ("find", "plate"),
        ("pick_up", "plate"),
        ("find", "sink"),
        ("wash", "plate"),
    ]
    assert len(names["serve_breakfast"]) == 6
    assert len(names["eat_apple"]) == 7


def test_a_dropped_plate_is_a_state_of_its_own(clean_dishes: Reachable) -> None:
    seen = set(map(describe, clean_dishes.classes()))
    assert "near(plate), on(plate, floor)" in seen
    assert "clean(plate), near(plate), on(plate, floor)" in seen


def test_outcomes_of_an_action_look_different(shipped_reachable: list[Reachable]) -> None:
    for task in shipped_reachable:
        for of in task.nominal:
            assert task.after_success(of)
            assert task.after_failure(of)
            assert not task.after_success(of) & task.after_failure(of)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    choices=st.lists(st.integers(0, 10**6), min_size=1, max_size=25),
    name=st.sampled_from(["clean_dishes", "serve_breakfast", "eat_apple"]),
)
def test_no_run_of_a_simulation_leaves_the_reachable_states(
    shipped_reachable: list[Reachable], seed: int, choices: list[int], name: str
) -> None:
    """Whatever actions of its plans are tried in whatever order, with many faults."""
    found = next(task for task in shipped_reachable if task.task == name)
    task, rules = task_and_rules(name)
    simulation = Simulation(task, rules, failure=0.4, disturbance=0.6, spontaneous=0.3, seed=seed)
    actions = [action for action in task.ground_actions() if kind(action, task) in found.steps]
    for choice in choices:
        simulation.execute(actions[choice % len(actions)])
        assert simulation.state in found.states
        assert visible_state(simulation.state) in found.classes()


def test_simulations_reach_what_was_enumerated(
    clean_dishes: Reachable, simulate: Callable[..., Simulation]
) -> None:
    """The enumeration is no larger than what trials can come to."""
    met = set()
    for seed in range(100):
        simulation = simulate("clean_dishes", failure=0.1, disturbance=0.15, seed=seed)
        task = simulation.task
        actions = [a for a in task.ground_actions() if kind(a, task) in clean_dishes.steps]
        draw = chance(seed, 0, "which action")
        for _ in range(200):
            simulation.execute(draw.choice(actions))
            met.add(simulation.state)
    assert met == set(clean_dishes.states)
