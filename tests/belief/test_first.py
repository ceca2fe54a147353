"""What may be the case at first, and how probable that is."""

from collections import defaultdict
from math import isclose
from pathlib import Path
from random import Random

import pytest

from tests.ward import ward
from tpvqa.belief.filtering.first import Prior
from tpvqa.belief.filtering.priors import Priors, load_priors
from tpvqa.belief.states.mutexes import h2_mutexes
from tpvqa.belief.states.origins import Origins
from tpvqa.pddl import Atom, State, Task, load_task
from tpvqa.pddl.pattern import Pattern
from tpvqa.tasks import find_task
from tpvqa.worlds.world_file import load_world_file

NIGHT = ward()
UNKNOWN = Priors(nothing_known=True)


def priors_of(tmp_path: Path, text: str, task: Task) -> Priors:
    path = tmp_path / "priors.yaml"
    path.write_text(text)
    return load_priors(task, path)


@pytest.fixture(scope="module")
def tower() -> Task:
    return load_task("build_tower")


@pytest.fixture(scope="module")
def reachable(tower: Task) -> set[State]:
    """Every state of it that actions lead to."""
    task = tower
    seen, waiting = {task.init}, [task.init]
    while waiting:
        state = waiting.pop()
        for action in task.ground_actions():
            if task.applicable(state, action):
                after = task.apply(state, action)
                if after not in seen:
                    seen.add(after)
                    waiting.append(after)
    return seen


def test_what_is_left_open_is_spread_evenly_over_the_possible_states() -> None:
    states = Prior(NIGHT).states()
    assert len(states) == 3 * 2 * 2
    assert all(isclose(weight, 1 / 12) for _, weight in states)
    for state, _ in states:
        assert all(len(state & group) == 1 for group in NIGHT.oneof)
        assert len(state & NIGHT.unknown) == 1  # the lamp is somewhere, and in one place
        assert state - NIGHT.left_open == NIGHT.init - NIGHT.left_open


def test_clauses_leave_states_out() -> None:
    task = ward(
        "(oneof (in pump store) (in pump hall)) (oneof (needs anna pump) (needs anna lamp))"
        "(or (not (needs anna pump)) (in pump hall)) (in lamp hall)"
    )
    barred = {Atom.parse("(needs anna pump)"), Atom.parse("(in pump store)")}
    assert len(Prior(task).states()) == 3
    assert not any(barred <= state for state, _ in Prior(task).states())


def test_answers_weigh_states_as_bayes_says() -> None:
    prior, pump = Prior(NIGHT), Atom.parse("(in pump store)")
    before = prior.probability(pump)
    told = prior.see((pump,), 0.8, 0.2)
    assert isclose(before, 1 / 3)
    assert isclose(told, 0.8 / 3 + 0.2 * 2 / 3)
    weights: dict[bool, float] = defaultdict(float)
    for state, weight in prior.states():
        weights[pump in state] += weight
    assert isclose(weights[True], 0.8 / (0.8 + 2 * 0.2))
    assert isclose(prior.probability(pump), weights[True])


def test_an_answer_about_facts_alike_weighs_all_of_them() -> None:
    prior = Prior(NIGHT)
    hall, store = Atom.parse("(in pump hall)"), Atom.parse("(in pump store)")
    prior.see((hall, store), 0.9, 0.1)
    share = sum(weight for state, weight in prior.states() if state & {hall, store})
    assert isclose(share, 2 * 0.9 / (2 * 0.9 + 0.1))


def test_priors_of_ones_own(tmp_path: Path) -> None:
    text = "(in pump ?where): 0.05\n(in pump hall): 0.9\n(needs anna pump): 0.75\n"
    prior = Prior(NIGHT, priors_of(tmp_path, text, NIGHT))
    shares: dict[Atom, float] = defaultdict(float)
    for state, weight in prior.states():
        for atom in state:
            shares[atom] += weight
    assert isclose(shares[Atom.parse("(in pump hall)")], 0.9)
    assert isclose(shares[Atom.parse("(in pump store)")], 0.05)
    assert isclose(shares[Atom.parse("(needs anna lamp)")], 0.25)


def test_what_may_be_elsewhere_need_not_be_where_the_problem_says(tmp_path: Path) -> None:
    task = load_task("eat_apple")
    on = next(atom for atom in task.init if atom.predicate == "on" and "knife" in atom.arguments)
    said = priors_of(tmp_path, "(on knife ?x): 0.05\n" + f"{on.pddl()}: 0.5\n", task)
    states = Prior(task, said).states()
    assert 0.4 < sum(weight for state, weight in states if on in state) < 0.9
    groups = [group.atoms for group in task.groups_of(on) if group.exactly_one]
    assert all(len(state & group) == 1 for state, _ in states for group in groups)


def test_worlds_are_drawn_as_often_as_they_are_probable(tmp_path: Path) -> None:
    prior = Prior(NIGHT, priors_of(tmp_path, "(in pump hall): 0.8\n", NIGHT))
    random = Random(0)
    drawn = [prior.drawn(random) for _ in range(500)]
    possible = {state for state, _ in prior.states()}
    assert possible.issuperset(drawn)
    assert 0.75 < sum(Atom.parse("(in pump hall)") in state for state in drawn) / 500 < 0.85


def test_certainties_that_exclude_each_other_are_shared_out() -> None:
    said = {"(in pump hall)": 1, "(in pump store)": 1, "(held pump)": 1, "(held lamp)": 0}
    priors = Priors(tuple((Pattern.parse(form, NIGHT), p) for form, p in said.items()))
    states = Prior(NIGHT, priors).states()
    held = sum(weight for state, weight in states if Atom.parse("(held lamp)") in state)
    assert states
    assert held < 1e-3


def test_with_nothing_known_every_reachable_state_is_possible(
    tower: Task, reachable: set[State]
) -> None:
    rules = load_world_file(find_task("build_tower").world, tower)
    prior = Prior(tower, UNKNOWN, rules.undo)
    assert prior.combinations > len(reachable)
    origins = Origins(tower)
    assert all(map(origins, reachable))
    for state in sorted(reachable, key=sorted)[::60]:
        assert prior._search.allows(prior._search.bits(state))


def test_with_nothing_known_answers_lead_to_the_true_state(
    tower: Task, reachable: set[State]
) -> None:
    random = Random(1)
    truth = random.choice(sorted(reachable, key=sorted))
    prior = Prior(tower, UNKNOWN)
    for _ in range(4):
        for atom in prior.atoms:
            right = random.random() < 0.8
            yes = (atom in truth) == right
            prior.see((atom,), *((0.8, 0.2) if yes else (0.2, 0.8)))
    assert prior.covered()
    assert prior.states()[0][0] == truth


def test_states_that_cannot_have_come_about_are_told(tower: Task) -> None:
    origins = Origins(tower)
    floating = {"(on green blue)", "(on blue green)", "(clear c1)", "(clear c2)"}
    circle = frozenset(map(Atom.parse, floating)) | {
        atom for atom in tower.init if atom.arguments[0] in ("yellow", "c3")
    }
    assert not origins(circle | {Atom.parse("(on red c1)"), Atom.parse("(clear red)")})


def test_h2_counts_in_what_may_hold_at_first() -> None:
    pairs = h2_mutexes(NIGHT).pairs
    for state, _ in Prior(NIGHT).states():
        assert not any(pair <= state for pair in pairs)
    other = {Atom.parse("(in pump hall)"), Atom.parse("(in lamp store)")}
    assert frozenset(other) not in pairs
