from collections.abc import Callable

from tpvqa.worlds.simulation import Simulation
from tpvqa_household.images.paper import PaperSimulation


def test_a_disturbing_failure_returns_to_what_an_earlier_action_showed(
    simulate: Callable[..., Simulation],
) -> None:
    returned = 0
    for seed in range(40):
        plain = simulate("eat_apple", failure=0.4, disturbance=1.0, seed=seed)
        simulation = PaperSimulation.like(plain)
        task = simulation.task
        met = [simulation.state]
        for name, *arguments in (
            ("find", "fridge", "tv"),
            ("open", "fridge"),
            ("find", "apple", "fridge"),
            ("pick_up", "apple", "fridge", "left"),
        ):
            outcome = simulation.execute(task.action(name, arguments))
            if outcome.succeeded:
                met.append(outcome.after)
            else:
                assert outcome.after in met
                returned += outcome.after != outcome.before
    assert returned > 10


def test_without_disturbances_it_is_the_plain_simulation(
    simulate: Callable[..., Simulation],
) -> None:
    for seed in range(20):
        plain = simulate("serve_breakfast", disturbance=0.0, seed=seed)
        paper = PaperSimulation.like(plain)
        for name, *arguments in (
            ("find", "bread", "sink"),
            ("pick_up", "bread", "counter", "left"),
        ):
            action = plain.task.action(name, arguments)
            assert plain.execute(action).after == paper.execute(action).after


def test_faults_are_those_of_the_plain_simulation(simulate: Callable[..., Simulation]) -> None:
    for seed in range(50):
        plain = simulate(seed=seed)
        paper = PaperSimulation.like(plain)
        action = plain.task.action("find", ("plate", "tv"))
        assert plain.execute(action).succeeded == paper.execute(action).succeeded
