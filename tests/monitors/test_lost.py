"""What tells that no plan leads on is asked about, though no plan needs it."""

from pathlib import Path

from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.outlook import Outlook
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.belief.filtering.sight import Sight
from tpvqa.monitors.lost import lost
from tpvqa.pddl import Atom, Task, load_task

DOMAIN = """
(define (domain office) (:requirements :strips)
  (:predicates (on-desk ?k) (held ?k) (in-shaft ?k) (opened ?k))
  (:action take :parameters (?k) :precondition (on-desk ?k)
    :effect (and (held ?k) (not (on-desk ?k))))
  (:action drop :parameters (?k) :precondition (held ?k)
    :effect (and (in-shaft ?k) (not (held ?k))))
  (:action unlock :parameters (?k) :precondition (held ?k) :effect (opened ?k)))
"""
PROBLEM = """
(define (problem one) (:domain office) (:objects key) (:init (on-desk key)) (:goal (opened key)))
"""
DESK, SHAFT = Atom.parse("(on-desk key)"), Atom.parse("(in-shaft key)")


def office(folder: Path) -> Task:
    (folder / "domain.pddl").write_text(DOMAIN)
    (folder / "problem.pddl").write_text(PROBLEM)
    return load_task(folder / "domain.pddl", folder / "problem.pddl")


def test_where_a_key_may_lie_that_nobody_gets_out_again_is_asked_about(tmp_path: Path) -> None:
    task = office(tmp_path)
    model, gone = FaultModel(task), task.init - {DESK} | {SHAFT}
    belief = Belief(model)
    belief.begin([(task.init, 0.4), (gone, 0.6)])
    ahead = Outlook(model, Costs(), Sight(model), task)
    assert lost(belief, ahead) == frozenset()  # nobody knows yet that no plan leads on
    ahead.give_up_on(gone)
    assert lost(belief, ahead) == {DESK, SHAFT}
    belief.begin([(gone, 1.0)])
    assert lost(belief, ahead) == {DESK, SHAFT}
    belief.begin([(task.init, 0.99), (gone, 0.01)])
    assert lost(belief, ahead) == frozenset()


def test_so_is_what_has_to_hold_and_may_hold_no_more(tmp_path: Path) -> None:
    task = office(tmp_path)
    model, nowhere = FaultModel(task), task.init - {DESK}
    belief = Belief(model)
    belief.begin([(nowhere, 1.0)])
    ahead = Outlook(model, Costs(), Sight(model), task)
    ahead.give_up_on(nowhere)
    assert lost(belief, ahead) == {DESK}
