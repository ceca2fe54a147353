"""Plans gone through from many states at once: as one state after the other tells it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.belief.test_belief import plan_of
from tests.planning.random_states import random_states
from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.annotated import AnnotatedPlan
from tpvqa.belief.deciding.choices import Chooser
from tpvqa.belief.deciding.needed import Needed
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, JointState, Rates
from tpvqa.pddl import Atom, load_task, task_from_text
from tpvqa.planning.regression import regress
from tpvqa.tasks import find_task
from tpvqa.worlds.world_file import load_world_file

BLOCKS = load_task("build_tower")
ROOMS = 24
CORRIDOR = task_from_text(
    """(define (domain corridor) (:requirements :typing) (:types room)
    (:predicates (at ?r - room) (next ?a ?b - room))
    (:action go :parameters (?a ?b - room) :precondition (and (at ?a) (next ?a ?b))
      :effect (and (at ?b) (not (at ?a)))))""",
    f"""(define (problem far) (:domain corridor)
    (:objects {" ".join(f"r{n}" for n in range(ROOMS))} - room)
    (:init (at r0) {" ".join(f"(next r{n} r{n + 1})" for n in range(ROOMS - 1))})
    (:goal (at r{ROOMS - 1})))""",
)


@given(st.data())
def test_steps_that_change_something_are_those_that_do_so_one_by_one(data: st.DataObject) -> None:
    model = FaultModel(BLOCKS)
    actions = st.sampled_from(sorted(BLOCKS.ground_actions(), key=str))
    plan = data.draw(st.lists(actions, min_size=1, max_size=20))
    masks = model.masks(plan)
    assert masks is not None
    needed = Needed(masks)
    seed = data.draw(st.integers(0, 1000))
    for state in random_states(BLOCKS, seed=seed, count=5):
        first = data.draw(st.integers(0, len(plan)))
        number = model.number(JointState(state, ()))
        changes, holding = needed.walk(first, model.holding(number))
        here, truly = state, list[bool]()
        for action in plan[first:]:
            applicable = BLOCKS.applicable(here, action)
            after = BLOCKS.apply(here, action) if applicable else here
            truly.append(after != here)
            here = after
        assert changes == truly
        assert holding == model.holding(model.number(JointState(here, ())))
        assert model.goal_within(holding) == BLOCKS.goal_holds(here)


def test_where_masks_do_not_tell_all_there_are_none() -> None:
    files = find_task("clean_dishes")
    task = load_task(files.domain, files.problem)
    rebinding = FaultModel(task, load_world_file(files.world, task))
    assert rebinding.masks(plan_of(task)) is None
    goal = CORRIDOR.problem_text.replace("(:goal (at r23))", "(:goal (next r0 r1))")
    already = task_from_text(CORRIDOR.domain_text, goal)
    assert FaultModel(already).masks(already.ground_actions()) is None


def costs(*, quick: bool, missing: Atom | None, monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """What is expected of the first step of a long plan, with and without a static fact."""
    task, model = CORRIDOR, FaultModel(CORRIDOR)
    if not quick:
        monkeypatch.setattr(model, "masks", lambda _: None)
    chooser, belief = Chooser(model, Costs()), Belief(model)
    plan = [task.action("go", [f"r{n}", f"r{n + 1}"]) for n in range(ROOMS - 1)]
    chooser.ahead.add(AnnotatedPlan(task, tuple(plan), regress(task, tuple(plan), task.init)))
    chooser.settles = 0.0
    if missing is not None:
        belief.open((missing,), 0.5)
    found = list[float]()
    for action in plan[:3]:
        found += chooser.table(belief, Rates(), plan).costs.ravel().tolist()
        chooser.acted(belief, action)
        belief.act(action, Rates(0.25, 0.25, 0.0))
    return found


@pytest.mark.parametrize("missing", [None, Atom("next", ("r20", "r21"))])
def test_a_long_way_costs_the_same_however_its_rest_is_gone_through(
    missing: Atom | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    quick = costs(quick=True, missing=missing, monkeypatch=monkeypatch)
    assert quick == costs(quick=False, missing=missing, monkeypatch=monkeypatch)
