"""Where a plan is long: states without one, ways away from the goal, many sure facts."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from tpvqa.belief.answers.trust import Trust
from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.annotated import AnnotatedPlan
from tpvqa.belief.deciding.commitment import Commitments
from tpvqa.belief.deciding.inquiry import DOUBT, Budget, Inquirer
from tpvqa.belief.deciding.outlook import FURTHER, LONG, Outlook
from tpvqa.belief.deciding.seen import Seen
from tpvqa.belief.deciding.table import Choice, Table
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, JointState, Rates
from tpvqa.belief.filtering.sight import Sight
from tpvqa.belief.weighing.evidence import Evidence
from tpvqa.pddl import Action, Atom, Task, load_task
from tpvqa.planning.regression import regress
from tpvqa.questions import FactQuestion, Way

DOMAIN = """
(define (domain rooms)
  (:predicates (at ?r) (beside ?r ?s))
  (:action go :parameters (?r ?s) :precondition (and (at ?r) (beside ?r ?s))
    :effect (and (at ?s) (not (at ?r)))))
"""


class Line:
    """A robot that has to go from the first of some rooms in a line to the last."""

    def __init__(self, folder: Path, rooms: int):
        names = [f"r{n}" for n in range(rooms)]
        beside = " ".join(f"(beside {a} {b}) (beside {b} {a})" for a, b in pairwise(names))
        (folder / "d.pddl").write_text(DOMAIN)
        (folder / "p.pddl").write_text(
            f"(define (problem p) (:domain rooms) (:objects {' '.join(names)})"
            f" (:init (at r0) {beside}) (:goal (at {names[-1]})))"
        )
        self.task: Task = load_task(folder / "d.pddl", folder / "p.pddl")
        self.model = FaultModel(self.task)
        sight, costs = Sight(self.model), Costs()
        self.ahead = Outlook(self.model, costs, sight)
        way = [self.go(n, n + 1) for n in range(rooms - 1)]
        needs = regress(self.task, way, self.task.init)
        self.ahead.add(AnnotatedPlan(self.task, way, needs))
        commitments = Commitments(self.model, self.ahead, sight)
        self.seen = Seen(self.model, self.ahead, sight, commitments, costs)
        self.number = self.model.number(JointState(self.task.init))
        for action in way[:3]:
            self.number = self.then(action)

    def go(self, start: int, end: int) -> Action:
        """The action that goes from a room to another."""
        return self.task.action("go", (f"r{start}", f"r{end}"))

    def then(self, action: Action) -> int:
        """Where an action leads from where the robot stands."""
        there = self.model.outcomes(action)[self.number].intended
        assert there is not None
        return there

    def standing(self, *rooms: int) -> int:
        """The joint state in which the robot stands in some rooms: in none without a plan."""
        state = self.task.init - {Atom("at", ("r0",))}
        return self.model.number(JointState(state | {Atom("at", (f"r{n}",)) for n in rooms}))


@pytest.mark.parametrize("rooms", [9, 60])
def test_where_no_plan_is_known_the_goal_is_not_much_farther_than_from_here(
    tmp_path: Path, rooms: int
) -> None:
    line = Line(tmp_path, rooms)
    before = line.ahead.to_go(line.standing())
    line.ahead.stands_at(line.standing(rooms - 2))
    after = line.ahead.to_go(line.standing())
    step = before / (rooms + 1)
    assert after == pytest.approx(before if rooms == 9 else (1 + FURTHER) * step)


@pytest.mark.parametrize(("rooms", "long"), [(9, False), (60, True)])
def test_to_go_away_from_the_goal_costs_the_risks_that_it_puts_off(
    tmp_path: Path, rooms: int, long: bool
) -> None:
    line = Line(tmp_path, rooms)
    away, nearer = line.go(3, 2), line.go(3, 4)
    rates = Rates(disturbance=0.5)
    dearer = [
        sum(share * more for share, _, more in line.seen.successors(each, line.number, 1.0, rates))
        for each in (away, nearer)
    ]
    assert (dearer[0] > 0.1) is long
    assert dearer[1] == 0.0


@pytest.mark.parametrize(("rooms", "asked"), [(9, False), (10 * LONG, True)])
def test_the_longer_a_task_is_the_surer_facts_are_asked_about(
    tmp_path: Path, rooms: int, asked: bool
) -> None:
    line = Line(tmp_path, rooms)
    belief = Belief(line.model)
    inquirer = Inquirer(line.model, Evidence(belief, Calibration.default(), Trust()), Costs())
    question = FactQuestion("Is it there?", Way.EFFECT, Atom("at", ("r0",)))
    doubt = DOUBT / 2  # what is done is right with all but that, and else costs the task
    weights, costs = np.array([1 - doubt, doubt]), np.array([[0.0, 1.0], [5000.0, 1.0]])
    choices = tuple(Choice(line.go(0, n), line.task.init) for n in (1, 1))
    numbers = line.standing(0), line.standing(1)
    found = inquirer.best(
        [question],
        Table(choices, numbers, weights, costs, np.ones((1, 2, 2))),
        Budget(questions=100, looks=100),
        picture=None,
        views=lambda _: [None],
        stake=line.ahead.stake,
    )
    assert (found is not None) is asked
