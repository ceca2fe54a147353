"""Which choices there are."""

from math import inf, isfinite
from pathlib import Path

import pytest

from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.annotated import AnnotatedPlan
from tpvqa.belief.deciding.choices import Chooser
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, Rates
from tpvqa.belief.filtering.sight import Sight
from tpvqa.belief.learning.skills import SkillState
from tpvqa.pddl import Atom, load_task, task_from_text
from tpvqa.planning.regression import regress

FOLDER = Path(__file__).parents[1] / "fixtures" / "drawer"
TASK = load_task(FOLDER / "domain.pddl", FOLDER / "problem.pddl")
OPEN, DISINFECT, CLOSE = (
    TASK.action(name, ["drawer"]) for name in ("open_drawer", "disinfect", "close_drawer")
)


def cost_of_disinfecting(failure: float) -> float:
    """Where it was done, with .06 in vain, as nothing shows, and the next try fails so often."""
    model = FaultModel(TASK)
    sight = Sight(model, lambda atom: atom.predicate in ("open", "shut"))
    belief = Belief(model)
    dirty = TASK.apply(TASK.init, OPEN)
    clean = TASK.apply(dirty, DISINFECT)
    belief.begin([(clean, 0.94), (dirty, 0.06)])
    chooser = Chooser(model, Costs(), sight)
    plan = (OPEN, DISINFECT, CLOSE)
    chooser.ahead.add(AnnotatedPlan(TASK, plan, regress(TASK, plan)))
    chooser.ahead.learned(lambda _: SkillState(failure, 0.0, 1.3), Rates(0.25, 0.0, 0.0))
    table = chooser.table(belief, Rates(0.25, 0.0, 0.0), plan)
    place = [choice.action for choice in table.choices].index(DISINFECT)
    return float(table.expected[place])


def test_what_nothing_shows_is_not_repeated_for_ever() -> None:
    """After many tries in a row the next one is predicted to fail, and changes no belief."""
    assert isfinite(cost_of_disinfecting(0.25))
    assert cost_of_disinfecting(0.9999) == inf


def test_what_was_done_and_promised_nothing_is_not_done_again() -> None:
    """Q-MDP, which takes all to be known after the next action, would do it for ever."""
    model = FaultModel(TASK)
    dirty = TASK.apply(TASK.init, OPEN)
    clean = TASK.apply(dirty, DISINFECT)
    belief, plan = Belief(model), (OPEN, DISINFECT, CLOSE)
    belief.begin([(clean, 0.4), (dirty, 0.6)])
    chooser = Chooser(model, Costs())
    chooser.ahead.add(AnnotatedPlan(TASK, plan, regress(TASK, plan)))

    def disinfecting() -> float:
        table = chooser.table(belief, Rates(0.25, 0.0, 0.0), plan)
        return float(table.expected[[each.action for each in table.choices].index(DISINFECT)])

    def done(failure: float) -> float:
        chooser.acted(belief, DISINFECT)
        belief.act(DISINFECT, Rates(failure, 0.0, 0.0))
        return disinfecting()

    assert isfinite(disinfecting())
    assert isfinite(done(0.9))
    assert done(0.99) == inf
    chooser.acted(belief, OPEN)  # another one
    assert isfinite(disinfecting())


def test_what_was_set_out_for_twice_is_done() -> None:
    """To open is worth it for a small doubt, to disinfect is not once it is open: without an end
    the drawer was opened and closed."""
    model = FaultModel(TASK)
    belief, plan = Belief(model), (OPEN, DISINFECT, CLOSE)
    clean = TASK.apply(TASK.apply(TASK.apply(TASK.init, OPEN), DISINFECT), CLOSE)
    belief.begin([(clean, 0.975), (TASK.init, 0.025)])
    chooser = Chooser(model, Costs())
    chooser.ahead.add(AnnotatedPlan(TASK, plan, regress(TASK, plan)))

    def disinfecting() -> float:
        chooser.acted(belief, OPEN)
        belief.act(OPEN, Rates(0.0, 0.0, 0.0))
        table = chooser.table(belief, Rates(0.0, 0.0, 0.0), plan)
        return float(table.expected[[each.action for each in table.choices].index(DISINFECT)])

    assert disinfecting() == inf
    chooser.acted(belief, CLOSE)
    belief.act(CLOSE, Rates(0.0, 0.0, 0.0))
    assert isfinite(disinfecting())


BOXES = task_from_text(
    """(define (domain boxes) (:requirements :strips :typing) (:types thing box)
  (:predicates (in ?x - thing ?b - box) (in_hand ?x - thing) (hand_empty))
  (:action take :parameters (?x - thing ?b - box)
    :precondition (and (in ?x ?b) (hand_empty))
    :effect (and (in_hand ?x) (not (in ?x ?b)) (not (hand_empty))))
  (:action put :parameters (?x - thing ?b - box) :precondition (in_hand ?x)
    :effect (and (in ?x ?b) (not (in_hand ?x)) (hand_empty))))""",
    """(define (problem egg) (:domain boxes) (:objects egg - thing red blue - box)
  (:init (in egg red) (hand_empty)) (:goal (in egg blue)))""",
)


PUT = "put", ["egg", "blue"]


@pytest.mark.parametrize(("likely", "reports"), [(0.75, True), (0.25, False)])
def test_where_nothing_can_be_done_any_more_it_is_still_worth_knowing_how_it_ends(
    likely: float, reports: bool
) -> None:
    """What fell beside the boxes is out of reach: the answer decides what is reported, no more."""
    costs, plan = Costs(), tuple(BOXES.action(*each) for each in (("take", ["egg", "red"]), PUT))
    model = FaultModel(BOXES)
    belief = Belief(model)
    there = BOXES.apply(BOXES.apply(BOXES.init, plan[0]), plan[1])
    lost = there - {Atom("in", ("egg", "blue"))}
    belief.begin([(there, likely), (lost, 1 - likely)])
    chooser = Chooser(model, costs)
    chooser.ahead.add(AnnotatedPlan(BOXES, plan, regress(BOXES, plan)))
    table = chooser.table(belief, Rates(0.25, 0.0, 0.0), plan)
    assert table.best.action is None
    done, gave_up = (n for n, each in enumerate(table.choices) if each.action is None)
    assert (table.expected[done] < table.expected[gave_up]) == reports
    known = table.weights @ table.costs.min(axis=1)
    worth = float(table.expected.min() - known)
    assert worth == pytest.approx(min(likely, 1 - likely) * costs.misreport)


SAFE = task_from_text(
    """(define (domain vault) (:requirements :strips :typing) (:types place)
  (:predicates (robot_at ?p - place) (key_at ?p - place) (key_held) (open) (lies ?p - place)
    (locked ?p - place))
  (:action drive :parameters (?from ?to - place) :precondition (robot_at ?from)
    :effect (and (robot_at ?to) (not (robot_at ?from))))
  (:action take :parameters (?p - place) :precondition (and (robot_at ?p) (key_at ?p) (lies ?p))
    :effect (and (key_held) (not (key_at ?p))))
  (:action unlock :parameters (?p - place)
    :precondition (and (robot_at ?p) (key_held) (locked ?p)) :effect (open)))""",
    """(define (problem p) (:domain vault) (:objects desk safe - place)
  (:init (robot_at desk) (key_at desk) (lies desk) (locked safe)) (:goal (open)))""",
)


def test_where_no_plan_leads_on_no_action_does() -> None:
    """The key in the locked safe: wherever the robot drives, of which no planner was asked, nothing
    is saved by it. One such state of .01 decided what was done for forty actions."""
    take, there = SAFE.action("take", ["desk"]), SAFE.action("drive", ["desk", "safe"])
    plan = (take, there, SAFE.action("unlock", ["safe"]))
    locked_in = SAFE.init - {Atom("key_at", ("desk",))} | {Atom("key_at", ("safe",))}
    held = SAFE.apply(SAFE.init, take)
    model = FaultModel(SAFE)
    belief, chooser = Belief(model), Chooser(model, Costs())
    belief.begin([(SAFE.init, 0.6), (held, 0.39), (locked_in, 0.01)])
    chooser.ahead.add(AnnotatedPlan(SAFE, plan, regress(SAFE, plan)))
    chooser.ahead.give_up_on(locked_in)
    table = chooser.table(belief, Rates(), plan)
    lost = [
        float(cost)
        for choice, cost in zip(table.choices, table.costs[2], strict=True)
        if choice.action is not None
    ]
    assert {take, there} <= {choice.action for choice in table.choices}
    assert max(lost) - min(lost) < 1
    assert min(lost) >= chooser.ahead.failure
