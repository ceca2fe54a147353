"""The most probable consistent states against looking at every state there is."""

from itertools import chain, combinations
from math import isclose

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.states.constraints import Group
from tpvqa.belief.states.likeliest import Clause, Likeliest, Variable
from tpvqa.pddl import Atom, Literal, State

ATOMS = tuple(Atom("fact", (name,)) for name in "abcdefg")
Scores = dict[Atom, float]


@st.composite
def variables(draw: st.DrawFn) -> list[Variable]:
    """The facts dealt out to choices."""
    order, found = draw(st.permutations(ATOMS)), []
    while order:
        size = draw(st.integers(1, 3))
        found.append(Variable(tuple(sorted(order[:size])), draw(st.booleans())))
        order = order[size:]
    return found


some = st.lists(st.sampled_from(ATOMS), min_size=2, max_size=4, unique=True)
groups = st.lists(st.builds(lambda a, n: Group(tuple(a), n), some, st.booleans()), max_size=3)
literals = st.builds(Literal, st.sampled_from(ATOMS), st.booleans())
clauses = st.lists(st.lists(literals, min_size=1, max_size=3).map(tuple), max_size=3)
numbers = st.floats(-5, 5).map(lambda x: round(x, 3))
scores = st.dictionaries(st.sampled_from(ATOMS), numbers)
factors = st.lists(st.tuples(some, numbers), max_size=2)


def consistent(state: State, groups: list[Group], clauses: list[Clause]) -> bool:
    """By the definition, one constraint after the other."""
    held = [len(state.intersection(group.atoms)) for group in groups]
    return all(
        number <= 1 and number >= group.needed for number, group in zip(held, groups, strict=True)
    ) and all(any(each.positive == (each.atom in state) for each in c) for c in clauses)


@given(variables(), groups, clauses, scores, factors, st.integers(1, 40))
def test_the_best_states_are_those_of_brute_force(
    choices: list[Variable],
    others: list[Group],
    clauses: list[Clause],
    scores: Scores,
    factors: list[tuple[list[Atom], float]],
    most: int,
) -> None:
    everything = [*others, *(Group(each.atoms, each.needed) for each in choices)]
    states = map(frozenset, chain(*(combinations(ATOMS, n) for n in range(len(ATOMS) + 1))))

    def score(state: State) -> float:
        return sum(scores.get(atom, 0.0) for atom in state) + sum(
            value for atoms, value in factors if state.intersection(atoms)
        )

    brute = sorted(map(score, (s for s in states if consistent(s, everything, clauses))))[::-1]
    search = Likeliest(choices, others, clauses)
    found = search.best(
        scores, most, factors=[(search.bits(atoms), value) for atoms, value in factors]
    )
    assert len(found.states) == min(most, len(brute))
    assert len({bits for bits, _ in found.states}) == len(found.states)
    for (bits, told), expected in zip(found.states, brute, strict=False):
        state = search.state(bits)
        assert consistent(state, everything, clauses)
        assert search.allows(bits)
        assert isclose(score(state), expected, abs_tol=1e-6)
        assert isclose(told, expected, abs_tol=1e-6)
    assert found.complete or len(brute) >= most


@given(variables(), groups, clauses, st.frozensets(st.sampled_from(ATOMS)))
def test_what_is_allowed_is_what_is_consistent(
    choices: list[Variable], others: list[Group], clauses: list[Clause], state: State
) -> None:
    everything = [*others, *(Group(each.atoms, each.needed) for each in choices)]
    search = Likeliest(choices, others, clauses)
    assert search.allows(search.bits(state)) == consistent(state, everything, clauses)


def test_states_of_too_low_a_score_are_left_out() -> None:
    search = Likeliest([Variable(ATOMS, True)])
    scores = {atom: -float(place) for place, atom in enumerate(ATOMS)}
    found = search.best(scores, 10, within=2.5)
    assert [search.state(bits) for bits, _ in found.states] == [{atom} for atom in ATOMS[:3]]
    assert found.complete


def test_what_is_certain_leaves_no_choice() -> None:
    a, b, c = ATOMS[:3]
    search = Likeliest([Variable((b,), False)], [Group((a, b), True)], certain=frozenset({a}))
    assert [search.state(bits) for bits, _ in search.best({b: 9.0}, 5).states] == [{a}]
    contradiction = Likeliest(
        [Variable((b,), False)], [Group((a, c), True)], certain=frozenset({a, c})
    )
    assert contradiction.best({}, 5).states == ()


@pytest.mark.parametrize("most", [1, 5])
def test_a_test_of_whole_states_is_asked(most: int) -> None:
    search = Likeliest([Variable((atom,), False) for atom in ATOMS[:3]], keeps=lambda s: len(s) < 2)
    found = search.best(dict.fromkeys(ATOMS[:3], 1.0), most)
    assert all(len(search.state(bits)) < 2 for bits, _ in found.states)
    assert len(found.states) == min(most, 4)
