"""The most probable consistent state against looking at every state there is."""

import sys
from collections.abc import Mapping
from itertools import pairwise, product
from math import inf
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpvqa.belief.choosing import Solver
from tpvqa.belief.consistency import (
    UNASKED,
    Consistent,
    Constraints,
    Contradiction,
    least_margin,
    most_probable,
)
from tpvqa.errors import BeliefError, ContradictionError, MissingExtraError
from tpvqa.pddl import Atom, load_task

ATOMS = [Atom("fact", (name,)) for name in "abcdefg"]
NEARLY = 1e-4  # OR-Tools weighs in millionths

Instance = tuple[dict[Atom, float], Constraints, dict[Atom, bool]]


def groups(most: int) -> st.SearchStrategy[tuple[frozenset[Atom], ...]]:
    some = st.frozensets(st.sampled_from(ATOMS), min_size=1, max_size=4)
    return st.lists(some, max_size=most, unique=True).map(tuple)


@st.composite
def instances(draw: st.DrawFn) -> Instance:
    """Constraints that may contradict each other, with equal and unequal log odds."""
    values = st.sampled_from([-1.5, 0.0, 1.5]) if draw(st.booleans()) else st.floats(-5, 5)
    pair = st.frozensets(st.sampled_from(ATOMS), min_size=2, max_size=2)
    return (
        draw(st.dictionaries(st.sampled_from(ATOMS), values)),
        Constraints(
            draw(groups(3)),
            draw(groups(4)),
            draw(st.frozensets(pair, max_size=4)),
            draw(st.frozensets(st.sampled_from(ATOMS), max_size=1)),
        ),
        draw(st.dictionaries(st.sampled_from(ATOMS), st.booleans(), max_size=1)),
    )


def speaks_of(instance: Instance) -> list[Atom]:
    log_odds, constraints, fixed = instance
    return sorted({*log_odds, *fixed, *constraints.atoms})


def best_score(instance: Instance, **more: bool) -> float | None:
    """The greatest score of all consistent states; None where there is none."""
    log_odds, constraints, fixed = instance
    atoms = speaks_of(instance)
    best = None
    for values in product((False, True), repeat=len(atoms)):
        state = frozenset(atom for atom, value in zip(atoms, values, strict=True) if value)
        impossible = constraints.unreachable - log_odds.keys() - fixed.keys()
        if (
            all((atom in state) == value for atom, value in fixed.items())
            and not state & impossible
            and not constraints.violated(state)
        ):
            score = sum(log_odds.get(atom, UNASKED) for atom in state)
            best = score if best is None else max(best, score)
    return best


def agrees_with_looking_at_all(instance: Instance, solver: Solver) -> None:
    log_odds, constraints, fixed = instance
    atoms = speaks_of(instance)
    best = best_score(instance)
    if best is None:
        with pytest.raises(ContradictionError):
            most_probable(log_odds, constraints, fixed=fixed, solver=solver)
        return
    found = most_probable(log_odds, constraints, fixed=fixed, margins=atoms, solver=solver)
    assert found.proven
    assert found.score == pytest.approx(best, abs=NEARLY)
    assert found.score == pytest.approx(sum(log_odds.get(a, UNASKED) for a in found.state))
    assert constraints.violated(found.state) == []
    assert all((atom in found.state) == value for atom, value in fixed.items())
    for atom in atoms:
        other = None
        barred = atom in constraints.unreachable - log_odds.keys()
        if atom not in fixed and not barred:
            flipped = {**fixed, atom: atom not in found.state}
            other = best_score((log_odds, constraints, flipped))
        expected = inf if other is None else best - other
        assert found.margins[atom] == pytest.approx(expected, abs=NEARLY), atom


@given(instances())
def test_state_and_margins_are_those_of_looking_at_every_state(instance: Instance) -> None:
    agrees_with_looking_at_all(instance, "auto")
    agrees_with_looking_at_all(instance, "direct")


@settings(max_examples=15)
@given(instances())
def test_cp_sat_finds_the_same(instance: Instance) -> None:
    pytest.importorskip("ortools")
    agrees_with_looking_at_all(instance, "cp_sat")


@settings(max_examples=25)
@given(instances(), st.data())
def test_what_is_left_entangled_goes_to_or_tools_and_comes_out_the_same(
    instance: Instance, data: st.DataObject
) -> None:
    pytest.importorskip("ortools")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("tpvqa.belief.choosing.SMALL", 0)
        agrees_with_looking_at_all(instance, "auto")


def outcome(instance: Instance) -> Consistent | None:
    log_odds, constraints, fixed = instance
    try:
        return most_probable(log_odds, constraints, fixed=fixed, margins=speaks_of(instance))
    except ContradictionError:
        return None


@given(instances(), st.randoms(use_true_random=False))
def test_the_order_of_the_arguments_does_not_matter(instance: Instance, random: Random) -> None:
    log_odds, constraints, fixed = instance

    def shuffled(groups: tuple[frozenset[Atom], ...]) -> tuple[frozenset[Atom], ...]:
        return tuple(random.sample(groups, len(groups)))

    other = Constraints(
        shuffled(constraints.exactly_one),
        shuffled(constraints.at_most_one),
        constraints.pairs,
        constraints.unreachable,
    )
    answers = dict(random.sample(list(log_odds.items()), len(log_odds)))
    assert outcome((answers, other, fixed)) == outcome(instance)


@given(instances(), st.permutations(ATOMS))
def test_the_names_of_the_facts_do_not_matter(instance: Instance, names: list[Atom]) -> None:
    log_odds, constraints, fixed = instance
    renamed = dict(zip(ATOMS, names, strict=True))

    def other(group: frozenset[Atom]) -> frozenset[Atom]:
        return frozenset(renamed[atom] for atom in group)

    found = outcome(instance)
    again = outcome(
        (
            {renamed[atom]: value for atom, value in log_odds.items()},
            Constraints(
                tuple(map(other, constraints.exactly_one)),
                tuple(map(other, constraints.at_most_one)),
                frozenset(map(other, constraints.pairs)),
                other(constraints.unreachable),
            ),
            {renamed[atom]: value for atom, value in fixed.items()},
        )
    )
    if found is None:
        assert again is None
        return
    assert again is not None
    assert again.score == pytest.approx(found.score)
    if all(margin > 0 for margin in found.margins.values()):  # one state alone is the best
        assert again.state == other(found.state)
        for atom, margin in found.margins.items():
            assert again.margins[renamed[atom]] == pytest.approx(margin)


ON_TABLE, ON_PLATE, IN_HAND, FREE = (
    Atom("on", ("apple", "table")),
    Atom("on", ("apple", "plate")),
    Atom("in_hand", ("apple", "left")),
    Atom("free", ("left",)),
)


def household() -> Constraints:
    return Constraints.of(load_task("eat_apple"))


def test_yes_to_both_is_settled_for_the_surer_answer() -> None:
    both = {ON_TABLE: 1.0, IN_HAND: 3.0, FREE: 1.0}
    found = most_probable(both, household(), margins=both)
    assert IN_HAND in found.state
    assert ON_TABLE not in found.state
    assert household().violated(found.state) == []
    # Were it on the table, the hand would be free.
    assert found.margins == pytest.approx(dict.fromkeys(both, 3.0 - (1.0 + 1.0)))


def test_a_contradiction_is_said_in_words() -> None:
    state = load_task("eat_apple").init | {ON_TABLE, IN_HAND}
    assert [str(each) for each in household().violated(state)] == [
        "free(left) and in_hand(apple, left) cannot both hold",
        "only one of in_hand(apple, left), on(apple, fridge) and on(apple, table) can hold",
    ]
    assert household().violated(load_task("eat_apple").init) == []
    nowhere = load_task("eat_apple").init - {Atom("near", ("tv",))}
    (missing,) = household().violated(nowhere)
    assert missing.missing
    assert str(missing).startswith("one of near(apple), ")
    assert str(missing).endswith(" must hold, and none does")


def test_a_thing_denied_everywhere_is_where_nobody_looked() -> None:
    denied = {ON_TABLE: -6.0, ON_PLATE: -6.0, IN_HAND: -6.0, FREE: 2.0}
    found = most_probable(denied, household())
    (place,) = {a for a in found.state if a.arguments[0] == "apple" and a.predicate != "near"}
    assert place not in denied
    assert place in load_task("eat_apple").atoms()


def test_what_cannot_be_reached_is_believed_only_when_it_is_seen() -> None:
    on_tv = Atom("on", ("apple", "tv"))
    constraints = household()
    assert on_tv in constraints.unreachable
    assert most_probable({}, constraints, margins=[on_tv]).margins[on_tv] == inf
    seen = most_probable({on_tv: 5.0, ON_TABLE: 1.0}, constraints)
    assert on_tv in seen.state
    assert ON_TABLE not in seen.state


def test_facts_without_constraints_are_as_they_are_answered() -> None:
    clean, halved = Atom("clean", ("plate",)), Atom("halved", ("apple",))
    found = most_probable({clean: 0.5, halved: -2.0}, Constraints(), margins=[clean, halved])
    assert found == Consistent(frozenset({clean}), 0.5, {clean: 0.5, halved: 2.0})


def test_what_is_fixed_wrongly_is_named() -> None:
    with pytest.raises(ContradictionError, match="cannot both hold"):
        most_probable({}, household(), fixed={ON_TABLE: True, IN_HAND: True})
    nowhere = {atom: False for atom in household().atoms if atom.predicate == "near"}
    with pytest.raises(ContradictionError, match=r"near\(apple\).*must hold, and none does"):
        most_probable({}, household(), fixed=nowhere)


def test_certainty_does_not_belong_into_log_odds() -> None:
    with pytest.raises(ValueError, match="'fixed'"):
        most_probable({ON_TABLE: inf}, household())


def test_the_closest_call_that_most_depends_on_is_asked_again() -> None:
    margins: Mapping[Atom, float] = {ON_TABLE: 1.0, ON_PLATE: 3.0, IN_HAND: inf}
    found = Consistent(frozenset(), 0.0, margins)
    assert least_margin(found, {ON_TABLE: 1.0, ON_PLATE: 1.0, IN_HAND: 9.0}) == ON_TABLE
    assert least_margin(found, {ON_TABLE: 1.0, ON_PLATE: 4.0}) == ON_PLATE
    assert least_margin(found, {IN_HAND: 1.0, ON_TABLE: 0.0}) is None


def slots(things: int, *, odd: bool) -> tuple[dict[Atom, float], Constraints]:
    """Every thing may be in any of as many slots; `odd`: and the first three things not at once."""
    places = range(things)
    at = {(n, p): Atom("at", (f"thing{n}", f"slot{p}")) for n in places for p in places}
    constraints = Constraints(
        tuple(frozenset(at[n, p] for p in places) for n in places),
        tuple(frozenset(at[n, p] for n in places) for p in places),
        frozenset(
            frozenset((at[n, 0], at[m, 1])) for n in range(3) for m in range(3) if n != m and odd
        ),
    )
    return {atom: float((3 * n + 5 * p) % 7) for (n, p), atom in at.items()}, constraints


@pytest.mark.parametrize(("odd", "solver"), [(False, "flow"), (True, "cp_sat")])
def test_what_is_large_and_entangled_goes_to_or_tools(odd: bool, solver: str) -> None:
    pytest.importorskip("ortools")
    log_odds, constraints = slots(12, odd=odd)
    found = most_probable(log_odds, constraints)
    assert (found.solver, found.proven) == (solver, True)
    assert constraints.violated(found.state) == []
    everything = most_probable(log_odds, constraints, solver="cp_sat")
    assert found.score == pytest.approx(everything.score, abs=NEARLY)
    assert found == most_probable(log_odds, constraints)


@pytest.mark.parametrize("odd", [False, True])
def test_without_or_tools_what_is_too_large_says_what_to_install(
    odd: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "ortools", None)
    monkeypatch.setitem(sys.modules, "ortools.graph.python", None)
    monkeypatch.setitem(sys.modules, "ortools.sat.python", None)
    monkeypatch.setattr("tpvqa.belief.choosing.WORK", 1_000)
    log_odds, constraints = slots(12, odd=odd)
    with pytest.raises(MissingExtraError, match=r"tpvqa\[belief\]"):
        most_probable(log_odds, constraints)
    with pytest.raises(BeliefError, match="branches"):
        most_probable(log_odds, constraints, solver="direct")


def test_without_or_tools_what_is_small_is_found_all_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "ortools", None)
    monkeypatch.setitem(sys.modules, "ortools.graph.python", None)
    monkeypatch.setattr("tpvqa.belief.choosing.SMALL", 0)
    log_odds, constraints = slots(4, odd=False)
    found = most_probable(log_odds, constraints)
    assert found.solver == "direct"
    assert constraints.violated(found.state) == []


@pytest.mark.parametrize("length", [1, 2, 77, 3_000])
def test_a_chain_is_taken_apart_from_its_ends(length: int) -> None:
    random = Random(length)
    atoms = [Atom("link", (f"n{number}",)) for number in range(length)]
    log_odds = {atom: random.uniform(-0.2, 1.0) for atom in atoms}
    pairs = frozenset(frozenset(both) for both in pairwise(atoms))
    without, having = 0.0, 0.0  # the best so far without its last link, and at all
    for atom in atoms:
        without, having = having, max(having, without + log_odds[atom])
    found = most_probable(log_odds, Constraints(pairs=pairs))
    assert found.score == pytest.approx(having)
    assert found.solver == "direct"


def test_out_of_time_is_said() -> None:
    pytest.importorskip("ortools")
    log_odds, constraints = slots(20, odd=True)
    with pytest.raises(BeliefError, match="allow more time"):
        most_probable(log_odds, constraints, seconds=0.0)


def test_contradictions_are_equal_whatever_found_them() -> None:
    assert str(Contradiction((ON_TABLE, IN_HAND))) == (
        "on(apple, table) and in_hand(apple, left) cannot both hold"
    )
