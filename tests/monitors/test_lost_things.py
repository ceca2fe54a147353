"""Things that fall where nothing that the task knows says that they are."""

from collections import Counter
from pathlib import Path

import pytest

from tpvqa.assembly import Trial
from tpvqa.belief.filtering.faults import FaultModel, JointState
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.events import Ended
from tpvqa.events.events import Acting, Asked
from tpvqa.pddl import Atom, load_task, task_from_text

TOYS = Path(__file__).parents[1] / "fixtures" / "toys"
OF_MANY = 80
"""Five times the answers that settle a question where a VLM is trusted as in .65."""

ALIKE = 14
"""So many answers that agree say all that there is to it, where nothing is known of a VLM."""


@pytest.mark.parametrize("vlm", ["oracle", "oracle:0.9"])
def test_a_container_that_falls_to_an_unknown_floor_is_given_up_for_another(vlm: str) -> None:
    files = {"domain": "domain.pddl", "problem": "collect.pddl", "questions": "questions.yaml"}
    config = TrialConfig().but(
        monitor="belief",
        vlm=vlm,
        world=f"scripted:{TOYS / 'script.yaml'}",
        task={name: str(TOYS / file) for name, file in files.items()},
    )
    writer = MemoryWriter()
    with Trial(config) as trial:
        trial.run(writer)
    end = writer.events[-1]
    assert isinstance(end, Ended)
    assert end.completed
    assert end.actions < 30
    asked = Counter[str]()
    for event in writer.events:
        if isinstance(event, Acting):
            asked.clear()
        elif isinstance(event, Asked):
            asked.update(question.text for question in event.questions)
            assert max(asked.values()) <= OF_MANY


def test_what_is_answered_alike_is_not_asked_for_ever() -> None:
    """Both containers fall to a floor that the task does not know: every *no* is right."""
    files = {"domain": "domain.pddl", "problem": "collect.pddl", "questions": "questions.yaml"}
    lost = Path(__file__).parents[1] / "proof" / "given" / "lost.yaml"
    config = TrialConfig().but(
        monitor="belief",
        vlm="oracle",
        world=f"scripted:{lost}",
        task={name: str(TOYS / file) for name, file in files.items()},
        limits={"actions": 20},
    )
    writer = MemoryWriter()
    with Trial(config) as trial:
        trial.run(writer)
    end = writer.events[-1]
    assert isinstance(end, Ended)
    assert not end.believed_goal
    asked, alike = Counter[str](), 0
    for event in writer.events:  # its answers are all right, so that one scene's all agree
        if isinstance(event, Acting):
            asked.clear()
        elif isinstance(event, Asked):
            asked.update(question.text for question in event.questions)
            alike = max(alike, *asked.values())
    assert 3 < alike <= ALIKE


def test_what_was_held_may_be_nowhere_and_its_hand_is_free() -> None:
    task = load_task(TOYS / "domain.pddl", TOYS / "collect.pddl")
    model, blue = FaultModel(task), "blue_container"
    state = task.apply(task.init, task.action("find", (blue, "table")))
    begun = model.number(JointState(task.init))
    there = model.become(begun, state)
    held = model.outcomes(task.action("pick_up", (blue,)))[there].intended
    assert held is not None
    places = {Atom("on", (blue, place)) for place in ("table", "goal_area")}
    shares = {
        share: model.state(number)
        for share, number in model.undone(held)
        if Atom("in_hand", (blue,)) not in model.state(number)
    }
    lost = [share for share, after in shares.items() if places.isdisjoint(after)]
    assert len(lost) == 1
    assert lost[0] < 0.1 * sum(shares) + 1e-9
    assert all(Atom("hand_empty") in after for after in shares.values())


def test_facts_of_no_object_and_hands_that_were_full_at_first_are_undone_too() -> None:
    task = load_task(TOYS / "domain.pddl", TOYS / "collect.pddl")
    blue = Atom("in_hand", ("blue_container",))
    held = task.init - {Atom("hand_empty"), Atom("on", ("blue_container", "table"))} | {blue}
    model = FaultModel(task)
    model.begin(held)
    begun = model.number(JointState(held))
    placed = model.outcomes(task.action("place", ("blue_container", "table")))[begun].intended
    assert placed is not None
    for share, after in model.undone(placed):
        assert 0 < share <= 1
        state = model.state(after)
        assert (blue in state) != (Atom("hand_empty") in state)


def test_what_is_lost_is_not_held_twice() -> None:
    """A hand that changed its tool takes the old one back only where that is free."""
    task = task_from_text(
        """(define (domain d) (:requirements :strips :typing) (:types tool)
        (:predicates (rack ?t - tool) (held ?t - tool))
        (:action swap :parameters (?t ?u - tool) :precondition (and (held ?t) (rack ?u))
          :effect (and (held ?u) (rack ?t) (not (held ?t)) (not (rack ?u)))))""",
        """(define (problem p) (:domain d) (:objects saw drill - tool)
        (:init (held drill) (rack saw)) (:goal (held saw)))""",
    )
    model = FaultModel(task)
    begun = model.number(JointState(task.init))
    swapped = model.outcomes(task.action("swap", ("drill", "saw")))[begun].intended
    assert swapped is not None
    for _, after in model.undone(swapped):
        for group in task.mutex_groups:
            assert len(group.atoms & model.state(after)) <= 1
