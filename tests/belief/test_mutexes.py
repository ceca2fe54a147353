"""Pairs that never hold together, against what random walks and a plain search reach."""

from pathlib import Path
from random import Random

import pytest

from tests.pddl.feature_domains import SAMPLES, Sample
from tpvqa.belief.states.constraints import Constraints
from tpvqa.belief.states.disturbances import disturbances
from tpvqa.belief.states.mutexes import Mutexes, h2_mutexes
from tpvqa.belief.states.transitions import Transition, of_action
from tpvqa.pddl import Atom, State, Task, load_task, task_from_text
from tpvqa.tasks import find_task
from tpvqa.worlds.undo import UndoRule
from tpvqa.worlds.world_file import load_world_file

SHIPPED = ["build_tower", "clean_dishes", "eat_apple", "serve_breakfast"]


def undo_rules(task: Task, name: str) -> tuple[UndoRule, ...]:
    return load_world_file(find_task(name).world, task).undo


def pair(one: str, other: str) -> frozenset[Atom]:
    return frozenset((Atom.parse(one), Atom.parse(other)))


def visited(task: Task, rules: tuple[UndoRule, ...], *, seed: int, steps: int) -> set[State]:
    """States that a random walk of actions and disturbances comes through."""
    random, state = Random(seed), task.init
    history: list[Atom] = []
    states = {state}
    for _ in range(steps):
        undone = [
            after
            for atom in sorted(state)
            for rule in rules
            for _, after in rule.results(atom, state, history, task)
        ]
        acted = [task.apply(state, a) for a in task.ground_actions() if task.applicable(state, a)]
        if not acted and not undone:
            break
        after = random.choice(undone if undone and random.random() < 0.3 else acted or undone)
        history += sorted(state - after)
        state = after
        states.add(state)
    return states


def contradicted(found: Mutexes, states: set[State]) -> list[frozenset[Atom]]:
    return [
        atoms
        for atoms in (*found.pairs, *(frozenset({atom}) for atom in found.never))
        if any(atoms <= state for state in states)
    ]


@pytest.mark.parametrize("name", SHIPPED)
def test_no_walk_with_disturbances_reaches_a_pair(name: str) -> None:
    task = load_task(name)
    rules = undo_rules(task, name)
    further = disturbances(task, rules)
    found = h2_mutexes(task, further)
    constraints = Constraints.of(task, found.pairs, never=found.never, further=further)
    for seed in range(3):
        states = visited(task, rules, seed=seed, steps=100)
        assert contradicted(found, states) == []
        assert all(constraints.violated(state) == [] for state in states)
        assert not any(state & constraints.unreachable for state in states)


@pytest.mark.parametrize("sample", SAMPLES, ids=lambda sample: sample.name)
def test_no_walk_reaches_a_pair_whatever_pddl_is_used(sample: Sample) -> None:
    task = task_from_text(sample.domain, sample.problem)
    found = h2_mutexes(task)
    for seed in range(10):
        assert contradicted(found, visited(task, (), seed=seed, steps=25)) == []


def reached_plainly(task: Task, transitions: list[Transition]) -> set[frozenset[Atom]]:
    """Haslum and Geffner's h², word for word: single atoms and pairs that are reached."""
    atoms = task.atoms() | task.init
    reached = {frozenset((one, other)) for one in task.init for other in task.init}
    while True:
        before = len(reached)
        for needed, added, deleted, earlier in transitions:
            able = all(frozenset((a, b)) in reached for a in needed for b in needed)
            if not able or not all(frozenset((atom,)) in reached for atom in earlier):
                continue
            kept = {
                atom
                for atom in atoms - deleted
                if frozenset((atom,)) in reached
                and all(frozenset((atom, each)) in reached for each in needed)
            }
            reached |= {frozenset((one, other)) for one in added for other in kept | added}
        if len(reached) == before:
            return reached


@pytest.mark.parametrize("disturbed", [False, True])
@pytest.mark.parametrize("name", ["build_tower", "eat_apple"])
def test_bits_find_what_sets_find(name: str, disturbed: bool) -> None:
    task = load_task(name)
    further = disturbances(task, undo_rules(task, name)) if disturbed else frozenset()
    reached = reached_plainly(
        task, [*(of_action(action, task) for action in task.ground_actions()), *further]
    )
    found = h2_mutexes(task, further)
    atoms = {a for a in task.atoms() | task.init if a.predicate in task.fluents - task.derived}
    assert found.never == {atom for atom in atoms if frozenset((atom,)) not in reached}
    possible = sorted(atoms - found.never)
    assert found.pairs == {
        frozenset((one, other))
        for one in possible
        for other in possible
        if one < other and frozenset((one, other)) not in reached
    }


@pytest.mark.parametrize("name", SHIPPED)
def test_it_finds_all_that_the_invariants_say(name: str) -> None:
    task = load_task(name)
    found = h2_mutexes(task, disturbances(task, undo_rules(task, name)))
    known = (task.atoms() | task.init) - found.never
    for group in task.mutex_groups:
        members = sorted(group.atoms & known)
        assert {
            frozenset((one, other)) for one in members for other in members if one < other
        } <= found.pairs


def test_it_finds_what_the_invariants_miss() -> None:
    found = h2_mutexes(load_task("build_tower"))
    assert pair("on(red, blue)", "on(blue, red)") in found.pairs
    assert pair("on(red, c1)", "incolumn(red, c2)") in found.pairs
    task = load_task("eat_apple")
    # No action puts an apple back into the fridge, but a slip of the hand does.
    halved = pair("halved(apple)", "on(apple, fridge)")
    assert halved in h2_mutexes(task).pairs
    assert halved not in h2_mutexes(task, disturbances(task, undo_rules(task, "eat_apple"))).pairs


def test_pairs_within_a_group_are_not_said_twice() -> None:
    task = load_task("build_tower")
    constraints = Constraints.of(task, h2_mutexes(task).pairs)
    assert len(constraints.pairs) == 30
    for group in task.mutex_groups:
        assert not any(each <= group.atoms for each in constraints.pairs)


def test_too_large_a_task_is_given_up_and_it_says_why() -> None:
    found = h2_mutexes(load_task("eat_apple"), limit=1_000)
    assert not found.pairs
    assert "more than the limit of 1,000" in found.gave_up
    assert h2_mutexes(load_task("eat_apple")).gave_up == ""


SHELF = """(define (domain shelf) (:requirements :typing)
  (:types thing place)
  (:constants shelf box floor - place)
  (:predicates (at ?x - thing ?p - place) (held ?x - thing) (tall ?p - place))
  (:action take :parameters (?x - thing ?p - place)
    :precondition (at ?x ?p) :effect (and (held ?x) (not (at ?x ?p))))
  (:action put :parameters (?x - thing ?p - place)
    :precondition (and (held ?x) (tall ?p)) :effect (and (at ?x ?p) (not (held ?x)))))"""
CUP = """(define (problem cup) (:domain shelf) (:objects cup - thing)
  (:init (at cup shelf) (tall shelf) (tall box)) (:goal (at cup box)))"""


def rules_of(task: Task, text: str, tmp_path: Path) -> tuple[UndoRule, ...]:
    path = tmp_path / "world.yaml"
    path.write_text(text)
    return load_world_file(path, task).undo


FALLS = """undo:
  - fact: (held ?x)
    outcomes:
      - add: ["(at ?x floor)"]
"""
STAYS = """undo:
  - fact: (held ?x)
    outcomes:
      - last: (at ?x ?before)
        add: ["(at ?x ?before)", "(held ?x)"]
"""
VANISHES = """undo:
  - fact: (at ?x ?p)
    outcomes:
      - say: it is gone
"""


def test_what_only_a_mishap_brings_about_can_be_acted_upon(tmp_path: Path) -> None:
    task = task_from_text(SHELF, CUP)
    floor = Atom.parse("at(cup, floor)")
    assert floor not in task.atoms()
    further = disturbances(task, rules_of(task, FALLS, tmp_path))
    found = h2_mutexes(task, further)
    assert pair("at(cup, floor)", "held(cup)") in found.pairs
    assert floor in Constraints.of(task).unreachable
    assert floor not in Constraints.of(task, found.pairs, further=further).unreachable


def test_a_group_that_mishaps_break_is_not_kept(tmp_path: Path) -> None:
    task = task_from_text(SHELF, CUP)
    (group,) = Constraints.of(task).exactly_one
    both = disturbances(task, rules_of(task, STAYS, tmp_path))
    assert pair("at(cup, box)", "held(cup)") in h2_mutexes(task).pairs
    assert pair("at(cup, box)", "held(cup)") not in h2_mutexes(task, both).pairs
    broken = Constraints.of(task, further=both)
    assert (broken.exactly_one, broken.at_most_one) == ((), ())
    gone = Constraints.of(task, further=disturbances(task, rules_of(task, VANISHES, tmp_path)))
    assert (gone.exactly_one, gone.at_most_one) == ((), (group,))
