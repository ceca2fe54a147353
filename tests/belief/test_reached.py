"""States that are listed, and the first look that weighs them."""

from collections import Counter
from math import isclose
from random import Random

from hypothesis import assume, given, settings

from tests.listing import every_state
from tests.pddl.conditional_domains import tasks
from tests.trolley import trolley
from tpvqa.belief.filtering.first import Prior
from tpvqa.belief.filtering.priors import Priors
from tpvqa.belief.states.reached import reached
from tpvqa.pddl import Atom, Task, load_task

UNKNOWN = Priors(nothing_known=True)


@settings(max_examples=60, deadline=None)
@given(tasks())
def test_all_states_are_listed_and_no_others(task: Task) -> None:
    expected = every_state(task)
    assume(len(expected) > 1)
    listed = reached(task)
    assert listed is not None
    states = listed.best({}, 1_000)
    assert states.complete
    assert Counter(listed.state(bits) for bits, _ in states.states) == Counter(expected)
    together = {frozenset((a, b)) for state in expected for a in state for b in state}
    assert listed.mutexes().pairs.isdisjoint(together)
    pairs = {frozenset((a, b)) for a in listed.atoms for b in listed.atoms}
    assert listed.mutexes().pairs == pairs - together


def test_what_is_not_listed_is_told_from_what_is() -> None:
    task = trolley()
    listed = reached(task)
    assert listed is not None
    assert all(listed.allows(listed.bits(state)) for state in every_state(task))
    assert not listed.allows(listed.bits(task.init | {Atom.parse("(at crate attic)")}))


def test_too_many_states_are_not_listed() -> None:
    assert reached(trolley(), most=10) is None
    assert reached(trolley(), work=10) is None
    assert reached(load_task("serve_breakfast"), most=1_000) is None


def test_where_nothing_is_known_answers_weigh_every_state() -> None:
    task = trolley()
    prior, states = Prior(task, UNKNOWN), every_state(task)
    hall, aboard = Atom.parse("(at crate hall)"), Atom.parse("(aboard crate)")
    parked = Atom.parse("(parked hall)")
    weights = {
        state: (0.9 if hall in state else 0.2)
        * (0.8 if aboard in state else 0.3)
        * (0.7 if {hall, parked} & state else 0.4)
        for state in states
    }
    prior.see((hall,), 0.9, 0.2)
    prior.see((aboard,), 0.8, 0.3)
    prior.see((hall, parked), 0.7, 0.4)
    total = sum(weights.values())
    assert {state for state, _ in prior.states()} == states
    for state, weight in prior.states():
        assert isclose(weight, weights[state] / total)
    for atom in prior.atoms:
        held = sum(weight for state, weight in weights.items() if atom in state)
        assert isclose(prior.probability(atom), held / total)
    random = Random(0)
    drawn = [prior.drawn(random) for _ in range(600)]
    assert states.issuperset(drawn)
    assert abs(sum(hall in state for state in drawn) / 600 - prior.probability(hall)) < 0.07
