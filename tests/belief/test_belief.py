"""The filter against brute force over all joint states, and its laws."""

from fractions import Fraction
from math import isclose, isfinite

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.belief.brute_force import World, act, marginal
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, Rates
from tpvqa.pddl import Action, Atom, Task, load_task
from tpvqa.tasks import find_task
from tpvqa.worlds.world_file import WorldRules, load_world_file

RATES = Rates(0.25, 0.25, 0.0625, 0.125)
EXACT = (Fraction(1, 4), Fraction(1, 4), Fraction(1, 16), Fraction(1, 8))


def plan_of(task: Task) -> list[Action]:
    lines = {
        "clean_dishes": """find plate tv, pick_up plate table left, find sink plate,
            wash plate sink left""",
        "serve_breakfast": """find bread sink, pick_up bread counter left, find plate bread,
            place bread plate left, find tv plate, turn_on tv""",
        "eat_apple": """find fridge tv, open fridge, find apple fridge, pick_up apple fridge left,
            find knife apple, pick_up knife counter right, cut_in_half apple knife left right""",
    }[task.name]
    words = [line.split() for line in lines.split(",")]
    return [task.action(name, arguments) for name, *arguments in words]


@pytest.mark.parametrize("repeats", [1, 2])
def test_the_filter_is_brute_force_over_all_joint_states(
    task: Task, rules: WorldRules, model: FaultModel, repeats: int
) -> None:
    belief = Belief(model, smallest=0.0, most=10**6)
    brute: dict[World, Fraction] = {(task.init, ()): Fraction(1)}
    for number, action in enumerate(each for each in plan_of(task) for _ in range(repeats)):
        if number > 8:
            break
        belief.act(action, RATES)
        brute = act(brute, action, task, rules, EXACT)
        atoms = {atom for state, _ in brute for atom in state}
        for atom in atoms:
            assert isclose(belief.probability(atom), marginal(brute, atom), abs_tol=1e-12)
        # An answer, right in 3 of 4 cases, that the first fact in doubt does not hold.
        doubted = sorted(a for a in atoms if 0 < marginal(brute, a) < 1)
        if doubted:
            belief.see((doubted[0],), 0.25, 0.75)
            brute = {
                (state, ended): weight * (Fraction(1, 4) if doubted[0] in state else Fraction(3, 4))
                for (state, ended), weight in brute.items()
            }
            total = sum(brute.values())
            brute = {world: weight / total for world, weight in brute.items()}
    assert len(belief.weights) > 3


def test_dropping_improbable_states_changes_no_marginal_by_more_than_was_dropped(
    task: Task, model: FaultModel
) -> None:
    exact, rough = Belief(model, smallest=0.0, most=10**6), Belief(model, smallest=3e-3, most=12)
    dropped = 0.0
    for action in plan_of(task) * 2:
        whole = Belief(model, smallest=0.0, most=10**6)
        whole.weights = rough.weights
        for belief in (exact, rough, whole):
            belief.act(action, RATES)
        dropped += sum(weight for n, weight in whole.weights.items() if n not in rough.weights)
    assert dropped > 0
    for atom in {atom for state, _ in exact.states() for atom in state}:
        assert abs(exact.probability(atom) - rough.probability(atom)) <= dropped + 1e-12


SERVE = load_task("serve_breakfast")
MODEL = FaultModel(SERVE, load_world_file(find_task("serve_breakfast").world, SERVE))
FACTS = sorted(atom for atom in SERVE.atoms() if atom.predicate in ("on", "in_hand", "near"))
answers = st.lists(st.tuples(st.sampled_from(FACTS), st.floats(0.02, 0.98)), min_size=1, max_size=6)
steps = st.lists(st.sampled_from(plan_of(SERVE)), min_size=1, max_size=4)


def after(actions: list[Action]) -> Belief:
    belief = Belief(MODEL, smallest=0.0)
    for action in actions:
        belief.act(action, RATES)
    return belief


@settings(max_examples=40, deadline=None)
@given(steps, answers)
def test_probabilities_sum_to_one_and_stay_between_zero_and_one(
    actions: list[Action], told: list[tuple[Atom, float]]
) -> None:
    belief = after(actions)
    for atom, if_true in told:
        belief.open((atom,), 0.01)
        belief.see((atom,), if_true, 1 - if_true)
        assert isclose(sum(belief.weights.values()), 1.0, abs_tol=1e-9)
        assert all(0 <= belief.probability(each) <= 1 for each in FACTS)
        for group in SERVE.mutex_groups:
            total = sum(belief.probability(each) for each in group.atoms)
            assert total <= 1 + 1e-9
            if group.exactly_one:
                assert isclose(total, 1.0, abs_tol=1e-9)


@settings(max_examples=40, deadline=None)
@given(steps, answers, st.randoms(use_true_random=False))
def test_the_order_of_independent_answers_does_not_matter(
    actions: list[Action], told: list[tuple[Atom, float]], random: object
) -> None:
    one, other = after(actions), after(actions)
    shuffled = list(told)
    random.shuffle(shuffled)  # type: ignore[attr-defined]
    for belief, order in ((one, told), (other, shuffled)):
        for atom, if_true in order:
            belief.see((atom,), if_true, 1 - if_true)
    for atom in FACTS:
        assert isclose(one.probability(atom), other.probability(atom), abs_tol=1e-9)


@given(steps)
@settings(max_examples=20, deadline=None)
def test_what_is_impossible_in_every_joint_state_changes_nothing(actions: list[Action]) -> None:
    belief = after(actions)
    before = dict(belief.weights)
    assert belief.weigh(lambda number: 0.0) == 0.0
    assert belief.weights == before


def test_certain_contradictions_give_numbers() -> None:
    """Yes to both on(bread, counter) and in_hand(bread, left), over and over."""
    belief = after(plan_of(SERVE)[:2])
    on, held = Atom("on", ("bread", "counter")), Atom("in_hand", ("bread", "left"))
    for _ in range(200):
        belief.see((on,), 0.999, 0.001)
        belief.see((held,), 0.999, 0.001)
        assert isfinite(belief.probability(on))
    assert isclose(belief.probability(on) + belief.probability(held), 1.0, abs_tol=1e-6)


def test_what_is_seen_is_believed_even_if_no_action_made_it_so() -> None:
    belief = Belief(MODEL)
    moved, home = Atom("on", ("plate", "sink")), Atom("on", ("plate", "table"))
    assert belief.probability(moved) == 0
    for _ in range(6):
        belief.open((moved,), 0.002)
        belief.see((moved,), 0.9, 0.1)
    assert belief.probability(moved) > 0.9
    assert belief.probability(home) < 0.1
    state, _ = belief.most_probable()
    assert moved in state
    assert home not in state


def test_a_thing_that_is_not_where_it_was_is_somewhere_else() -> None:
    belief = Belief(MODEL)
    home = Atom("on", ("plate", "table"))
    belief.open((home,), 0.01)
    for _ in range(8):
        belief.see((home,), 0.1, 0.9)
    assert belief.probability(home) < 0.01
    places = [
        group for group in SERVE.groups_of(home) if group.exactly_one and len(group.atoms) > 3
    ]
    assert all(
        isclose(sum(map(belief.probability, group.atoms)), 1.0, abs_tol=1e-9) for group in places
    )


def test_shares_of_the_last_outcome_follow_the_evidence() -> None:
    belief = Belief(MODEL)
    find = plan_of(SERVE)[0]
    belief.act(find, RATES)
    shares = belief.outcome_shares()
    assert isclose(shares["success"], 0.75)
    assert isclose(shares["failure"], 0.25)
    belief.see((Atom("near", ("bread",)),), 0.05, 0.95)
    shares = belief.outcome_shares()
    assert isclose(shares["failure"], 0.25 * 0.95 / (0.25 * 0.95 + 0.75 * 0.05))


def test_what_is_lost_after_a_success_is_told_from_what_a_failure_undoes() -> None:
    """Else whoever drops what it carries is taken to have failed to go."""
    belief = Belief(MODEL)
    for action in plan_of(SERVE)[:2]:  # the bread is in the hand
        belief.act(action, Rates(0.0, 0.0, 0.0))
    belief.act(plan_of(SERVE)[2], Rates(0.25, 0.25, 0.0625))
    shares = belief.outcome_shares()
    fell, stayed = shares["fell"], shares["stayed"]
    assert isclose(fell + stayed, shares["success"])
    assert isclose(fell / (fell + stayed), 0.0625)
    belief.see((Atom("in_hand", ("bread", "left")),), 0.001, 0.999)
    belief.see((Atom("near", ("plate",)),), 0.999, 0.001)
    assert belief.outcome_shares()["fell"] > 0.9


def test_what_is_so_in_half_of_the_starts_may_come_undone() -> None:
    """It may have been brought about; what was probably so at first was not."""
    task = load_task("eat_apple")
    reached = task.apply(task.init, task.action("find", ["fridge", "tv"]))
    opened, find = task.action("open", ["fridge"]), task.action("find", ["apple", "fridge"])
    after, lid = task.apply(reached, opened), Atom("opened", ("fridge",))
    for starts, was in (([(after, 0.5), (reached, 0.5)], 0.5), ([(after, 1.0)], 1.0)):
        belief = Belief(FaultModel(task))
        belief.begin(starts)
        belief.act(find, Rates(0.25, 0.25, 0.2, 0.2))
        assert (belief.probability(lid) < was) is (len(starts) > 1)
