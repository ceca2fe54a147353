"""What a plan needs: sufficient wherever it holds, and small."""

from functools import cache
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.pddl.feature_domains import SAMPLES
from tests.planning.random_states import arbitrary, scrambled, walk
from tpvqa.errors import PlannerError
from tpvqa.pddl import Action, Atom, Literal, State, Task, load_task, task_from_text, validate
from tpvqa.planning import Plan
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.regression import regress
from tpvqa.tasks import shipped_tasks

SOLVABLE = [sample for sample in SAMPLES if sample.cost is not None]
NAMES = [*(files.name for files in shipped_tasks()), *(sample.name for sample in SOLVABLE)]


@cache
def planned(name: str) -> tuple[Task, tuple[Action, ...]]:
    sample = next((sample for sample in SOLVABLE if sample.name == name), None)
    task = load_task(name) if sample is None else task_from_text(sample.domain, sample.problem)
    plan = FastDownward().plan(task)
    assert isinstance(plan, Plan)
    return task, plan.actions


def forced(state: State, literals: frozenset[Literal]) -> State:
    """The state, changed as little as needed for the literals to hold."""
    true = {literal.atom for literal in literals if literal.positive}
    false = {literal.atom for literal in literals if not literal.positive}
    return (state - false) | true


@settings(max_examples=400, deadline=None)
@given(st.sampled_from(NAMES), st.integers(0, 10_000))
def test_where_the_needs_hold_the_rest_of_the_plan_works(name: str, seed: int) -> None:
    task, actions = planned(name)
    needs = regress(task, actions)
    random = Random(seed)
    step = random.randrange(len(needs))
    start = random.choice([walk(task, random, 6), scrambled(task, random), arbitrary(task, random)])
    state = forced(start, needs[step])
    result = validate(task, actions[step:], state)
    assert result.valid, str(result)


@pytest.mark.parametrize("name", NAMES)
def test_the_needs_hold_along_the_plan_itself(name: str) -> None:
    task, actions = planned(name)
    replay = validate(task, actions)
    for state, needs in zip(replay.states, regress(task, actions), strict=True):
        assert all(literal.holds(state) for literal in needs)
        assert all(literal.atom.predicate in task.fluents for literal in needs)


def test_the_papers_plan() -> None:
    task, actions = planned("clean_dishes")
    assert [sorted(map(str, needs)) for needs in regress(task, actions)][1:] == [
        ["free(left)", "near(plate)", "not on(sink, fridge)", "on(plate, table)"],
        ["in_hand(plate, left)", "near(plate)", "not on(sink, fridge)"],
        ["in_hand(plate, left)", "near(sink)"],
        ["clean(plate)"],
    ]


def test_from_another_state() -> None:
    task, actions = planned("clean_dishes")
    state = task.init - {Atom.parse("near tv")} | {Atom.parse("near plate")}
    needs = regress(task, actions[1:], state)
    assert len(needs) == len(actions)
    assert needs[-1] == {Literal(Atom("clean", ("plate",)))}


def test_only_valid_plans_can_be_regressed() -> None:
    task, actions = planned("clean_dishes")
    with pytest.raises(PlannerError, match=r"only a valid plan.*step 1, pick_up\(plate"):
        regress(task, actions[1:])
