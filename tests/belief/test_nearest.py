"""The nearest consistent state against looking at every state there is."""

from itertools import pairwise, product
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.states.constraints import Constraints
from tpvqa.belief.states.nearest import Nearest
from tpvqa.errors import BeliefError, ContradictionError
from tpvqa.pddl import Atom, State, load_task

ATOMS = [Atom("fact", (name,)) for name in "abcdefg"]

Groups = tuple[frozenset[Atom], ...]
Instance = tuple[Constraints, State, frozenset[Atom], dict[Atom, bool]]


def groups(most: int) -> st.SearchStrategy[Groups]:
    some = st.frozensets(st.sampled_from(ATOMS), min_size=1, max_size=4)
    return st.lists(some, max_size=most, unique=True).map(tuple)


@st.composite
def instances(draw: st.DrawFn) -> Instance:
    """Constraints that may contradict each other, and a state that may violate them."""
    few = st.frozensets(st.sampled_from(ATOMS), max_size=2)
    pair = st.frozensets(st.sampled_from(ATOMS), min_size=2, max_size=2)
    return (
        Constraints(
            draw(groups(3)), draw(groups(4)), draw(st.frozensets(pair, max_size=4)), draw(few)
        ),
        draw(st.frozensets(st.sampled_from(ATOMS))),
        draw(few),
        draw(st.dictionaries(st.sampled_from(ATOMS), st.booleans(), max_size=2)),
    )


def found_in(instance: Instance) -> State | None:
    constraints, state, can_hold, wish = instance
    try:
        return Nearest(constraints, state, can_hold).where(wish)
    except ContradictionError:
        return None


def is_consistent(constraints: Constraints, state: State) -> bool:
    """By the definition, one constraint after the other."""
    return (
        all(len(group & state) == 1 for group in constraints.exactly_one)
        and all(len(group & state) <= 1 for group in constraints.at_most_one)
        and not any(pair <= state for pair in constraints.pairs)
    )


def fewest_changes(instance: Instance) -> int | None:
    """Of all consistent states that are as wished; None where there is none."""
    constraints, state, can_hold, wish = instance
    coming_in = constraints.unreachable - can_hold - wish.keys() - state
    changes = []
    for values in product((False, True), repeat=len(ATOMS)):
        other = frozenset(atom for atom, value in zip(ATOMS, values, strict=True) if value)
        if (
            all((atom in other) == holds for atom, holds in wish.items())
            and not other & coming_in
            and is_consistent(constraints, other)
        ):
            changes.append(len(state ^ other))
    return min(changes, default=None)


@given(instances())
def test_no_consistent_state_is_nearer(instance: Instance) -> None:
    constraints, state, _, wish = instance
    found = found_in(instance)
    assert (None if found is None else len(found ^ state)) == fewest_changes(instance)
    if found is not None:
        assert is_consistent(constraints, found)
        assert all((atom in found) == holds for atom, holds in wish.items())


@given(instances())
def test_a_state_is_violated_where_it_is_not_consistent(instance: Instance) -> None:
    constraints, state, _, _ = instance
    assert (constraints.violated(state) == []) == is_consistent(constraints, state)


@given(instances(), st.randoms(use_true_random=False))
def test_the_order_of_the_arguments_does_not_matter(instance: Instance, random: Random) -> None:
    constraints, state, can_hold, wish = instance

    def shuffled(groups: Groups) -> Groups:
        return tuple(random.sample(groups, len(groups)))

    other = Constraints(
        shuffled(constraints.exactly_one),
        shuffled(constraints.at_most_one),
        constraints.pairs,
        constraints.unreachable,
    )
    again = dict(random.sample(list(wish.items()), len(wish)))
    assert found_in((other, state, can_hold, again)) == found_in(instance)


@given(instances(), st.permutations(ATOMS))
def test_the_names_of_the_facts_do_not_change_how_near_it_is(
    instance: Instance, names: list[Atom]
) -> None:
    constraints, state, can_hold, wish = instance
    renamed = dict(zip(ATOMS, names, strict=True))

    def other(atoms: frozenset[Atom]) -> frozenset[Atom]:
        return frozenset(renamed[atom] for atom in atoms)

    found = found_in(instance)
    again = found_in(
        (
            Constraints(
                tuple(map(other, constraints.exactly_one)),
                tuple(map(other, constraints.at_most_one)),
                frozenset(map(other, constraints.pairs)),
                other(constraints.unreachable),
            ),
            other(state),
            other(can_hold),
            {renamed[atom]: holds for atom, holds in wish.items()},
        )
    )
    assert (again is None) == (found is None)
    if found is not None and again is not None:
        assert len(again ^ other(state)) == len(found ^ state)


def at(thing: int | str, place: int | str) -> Atom:
    return Atom("at", (str(thing), str(place)))


def permutations(things: int) -> tuple[Constraints, State]:
    """Every thing is in one of as many places, and every place holds one."""
    places = range(things)
    return (
        Constraints(
            tuple(frozenset(at(n, p) for p in places) for n in places)
            + tuple(frozenset(at(n, p) for n in places) for p in places)
        ),
        frozenset(at(n, n) for n in places),
    )


def test_what_is_in_the_way_moves() -> None:
    constraints, state = permutations(4)
    after = Nearest(constraints, state).where({at(0, 0): False, at(0, 2): True})
    assert after == frozenset((at(0, 2), at(1, 1), at(2, 0), at(3, 3)))


def test_of_equally_near_states_it_is_the_first_by_name() -> None:
    constraints, state = permutations(4)
    after = Nearest(constraints, state).where({at(2, 2): False})
    assert after == frozenset((at(0, 2), at(1, 1), at(2, 0), at(3, 3)))


@pytest.mark.parametrize("things", [1, 5, 200])
def test_what_shifts_along_a_chain_is_found(things: int) -> None:
    """Thing n can be at place n or n + 1; only the last place is free."""
    constraints = Constraints(
        tuple(frozenset((at(n, n), at(n, n + 1))) for n in range(things)),
        tuple(frozenset((at(n, n), at(n - 1, n))) for n in range(1, things)),
    )
    state = frozenset(at(n, n) for n in range(things))
    after = Nearest(constraints, state).where({at(0, 0): False})
    assert after == frozenset(at(n, n + 1) for n in range(things))


def test_pairs_are_kept_apart() -> None:
    atoms = [at("thing", n) for n in range(9)]
    constraints = Constraints(pairs=frozenset(frozenset(both) for both in pairwise(atoms)))
    state = frozenset(atoms[::2])
    after = Nearest(constraints, state).where({atoms[3]: True})
    assert after == state - {atoms[2], atoms[4]} | {atoms[3]}


def test_a_search_that_leads_nowhere_is_given_up() -> None:
    constraints, state = permutations(12)
    with pytest.raises(BeliefError, match=r"3 repairs do not make not at.*0\) consistent"):
        Nearest(constraints, state, most=3).where({at(0, 0): False})


ON_TABLE, IN_HAND, FREE = (
    Atom("on", ("apple", "table")),
    Atom("in_hand", ("apple", "left")),
    Atom("free", ("left",)),
)


def household() -> tuple[Constraints, State]:
    task = load_task("eat_apple")
    return Constraints.of(task), task.init


def test_what_is_in_the_hand_is_nowhere_else() -> None:
    constraints, state = household()
    (place,) = (atom for atom in state if atom.predicate == "on" and "apple" in atom.arguments)
    held = Nearest(constraints, state).where({IN_HAND: True})
    assert held ^ state == {IN_HAND, place, FREE}
    assert Nearest(constraints, held).where({ON_TABLE: True}) == held - {IN_HAND} | {ON_TABLE, FREE}


def test_what_cannot_hold_together_is_said() -> None:
    constraints, state = household()
    with pytest.raises(
        ContradictionError, match=r"has on\(apple, table\), in_hand\(apple, left\)$"
    ):
        Nearest(constraints, state).where({ON_TABLE: True, IN_HAND: True})
    nowhere = {atom: False for atom in constraints.groups_of if atom.predicate == "near"}
    with pytest.raises(ContradictionError, match=r"not near\(tv\)"):
        Nearest(constraints, state).where(nowhere)


def test_what_cannot_be_reached_comes_in_only_where_it_is_wished_for() -> None:
    constraints, state = household()
    on_tv = Atom("on", ("apple", "tv"))
    places = {a for a in constraints.groups_of if a.predicate in ("on", "in_hand")}
    others = {a: False for a in places if a.arguments[0] == "apple" and a != on_tv}
    assert on_tv in constraints.unreachable
    assert on_tv in Nearest(constraints, state).where({on_tv: True})
    assert on_tv in Nearest(constraints, state, [on_tv]).where(others)
    with pytest.raises(ContradictionError):
        Nearest(constraints, state).where(others)


def test_facts_without_constraints_are_as_they_are_wished() -> None:
    clean, halved = Atom("clean", ("plate",)), Atom("halved", ("apple",))
    nearest = Nearest(Constraints(), frozenset((clean,)))
    assert nearest.where({clean: False, halved: True}) == frozenset((halved,))
    assert nearest.where({}) == frozenset((clean,))
