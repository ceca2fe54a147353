"""What it costs to go on where nothing tells joint states apart."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.annotated import AnnotatedPlan
from tpvqa.belief.deciding.commitment import Commitments
from tpvqa.belief.deciding.outlook import Outlook
from tpvqa.belief.filtering.faults import FaultModel, JointState, Rates
from tpvqa.belief.filtering.sight import Sight
from tpvqa.belief.learning.skills import SkillState
from tpvqa.pddl import Atom, load_task
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


def test_what_nothing_shows_does_not_make_the_next_action_look_dearer() -> None:
    """It may as well be undone by later ones, which is not counted either."""
    for seen, shown in (
        (("open", "shut"), {False}),
        (("open", "shut", "contaminated"), {True, False}),
    ):
        model, _, sight = known(0.25, *seen)
        number: int | None = model.number(JointState(TASK.init))
        for action in (OPEN, DISINFECT):
            assert number is not None
            number = model.outcomes(action)[number].intended
        assert number is not None
        assert model.state(number) == CLEAN
        undone = {model.state(other): other for _, other in model.undone(number)}
        assert DIRTY in undone
        assert {other == undone[DIRTY] for _, other in sight.undone(number)} == shown


def test_the_way_of_an_unlikely_state_is_compared_though_likely_ones_share_another(
    tmp_path: Path,
) -> None:
    """Where the drawer may still be dirty it is disinfected again, whatever else is in doubt."""
    text = (FOLDER / "domain.pddl").read_text()
    marks = " ".join(f"(mark{n} ?d)" for n in range(2))
    text = text.replace("(contaminated ?d", f"{marks} (contaminated ?d", 1)
    wipe = "".join(
        f"(:action wipe{n} :parameters (?d) :precondition (open ?d) :effect (not (mark{n} ?d)))"
        for n in range(2)
    )
    end = text.rindex(")")
    (tmp_path / "domain.pddl").write_text(text[:end] + wipe + text[end:])
    task = load_task(tmp_path / "domain.pddl", FOLDER / "problem.pddl")
    drawer = ["drawer"]
    plan = [task.action(name, drawer) for name in ("open_drawer", "disinfect", "close_drawer")]
    dirty = task.apply(task.init, plan[0])
    clean = task.apply(dirty, plan[1])
    model = FaultModel(task)
    sight = Sight(model, lambda atom: atom.predicate in ("open", "shut"))
    ahead = Outlook(model, Costs(), sight)
    ahead.add(AnnotatedPlan(task, plan, regress(task, plan)))
    ahead.learned(lambda _: SkillState(0.25, 0.0, 4 / 3), Rates(0.25))
    marked = ((), ("mark0",), ("mark1",), ("mark0", "mark1"))
    likely = [
        model.number(JointState(clean | {Atom(name, ("drawer",)) for name in names}))
        for names in marked
    ]
    unlikely = model.number(JointState(dirty))
    shares = [*((n, 0.2) for n in likely), (unlikely, 0.2 - 1e-9)]
    found = Commitments(model, ahead, sight).made(plan[1], shares)
    assert found[unlikely] < ahead.failure / 2
