"""Things that fall where nothing that the task knows says that they are."""

from collections import Counter
from pathlib import Path

import pytest

from tpvqa.assembly import Trial
from tpvqa.belief.faults import FaultModel, JointState
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.events import Ended
from tpvqa.events.events import Acting, Asked
from tpvqa.pddl import Atom, load_task

TOYS = Path(__file__).parents[1] / "fixtures" / "toys"
OF_MANY = 80
"""Five times the answers that settle a question where a VLM is trusted as in .65."""


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
