"""What it costs to go on where nothing tells joint states apart."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.annotated import AnnotatedPlan
from tpvqa.belief.commitment import Commitments
from tpvqa.belief.costs import Costs
from tpvqa.belief.faults import FaultModel, JointState, Rates
from tpvqa.belief.outlook import Outlook
from tpvqa.belief.sight import Sight
from tpvqa.belief.skills import SkillState
from tpvqa.pddl import load_task
from tpvqa.planning.regression import regress

FOLDER = Path(__file__).parents[1] / "fixtures" / "drawer"
TASK = load_task(FOLDER / "domain.pddl", FOLDER / "problem.pddl")
OPEN, DISINFECT, CLOSE = PLAN = tuple(
    TASK.action(name, ["drawer"]) for name in ("open_drawer", "disinfect", "close_drawer")
)
DIRTY = TASK.apply(TASK.init, OPEN)
CLEAN = TASK.apply(DIRTY, DISINFECT)


def known(failure: float, *seen: str) -> tuple[FaultModel, Outlook, Sight]:
    """The plan is known, skills fail so often, and these facts are seen."""
    model = FaultModel(TASK)
    sight = Sight(model, lambda atom: atom.predicate in seen)
    ahead = Outlook(model, Costs(), sight)
    ahead.add(AnnotatedPlan(TASK, PLAN, regress(TASK, PLAN)))
    ahead.learned(lambda _: SkillState(failure, 0.0, 1 / (1 - failure)), Rates(failure))
    return model, ahead, sight


@given(st.floats(0.05, 0.4))
def test_a_try_that_nothing_shows_brings_as_near_as_it_costs(failure: float) -> None:
    """Else what is put off would look better than what is done."""
    model, ahead, sight = known(failure, "open", "shut")
    dirty, clean = (model.number(JointState(state)) for state in (DIRTY, CLEAN))
    before = ahead.to_go(dirty)
    shares = {clean: 1 - failure, dirty: failure}
    after = Commitments(model, ahead, sight).made(DISINFECT, shares.items())
    assert 1 + sum(shares[n] * cost for n, cost in after.items()) == pytest.approx(before)


def test_what_no_plan_is_known_for_is_not_cheaper_than_what_is_planned() -> None:
    model, ahead, _ = known(0.25)
    elsewhere = model.number(JointState(frozenset()))
    assert ahead.best(elsewhere) is None
    assert ahead.to_go(elsewhere) > ahead.to_go(model.number(JointState(TASK.init)))
