"""Ways that are followed whatever is answered, as answers say too little."""

from pathlib import Path

import pytest

from tpvqa.assembly import Trial
from tpvqa.belief.weighing.settling import LITTLE, Settling, says_little
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.events import Ended
from tpvqa.events.events import PlanMade
from tpvqa.monitors.ways import UNSEEN

HOSPITAL = Path(__file__).parents[2] / "examples" / "hospital"


@pytest.mark.slow
def test_a_long_way_is_handed_over_whole() -> None:
    """It was handed over a step at a time: each was a change of plan, and ten are allowed."""
    task = {name: str(HOSPITAL / f"{name}.pddl") for name in ("domain", "problem")}
    task["questions"] = str(HOSPITAL / "questions.yaml")
    config = TrialConfig().but(
        monitor="belief", vlm="recorded:qwen2.5-vl-72b", world="symbolic", task=task, seed=500
    )
    writer = MemoryWriter()
    with Trial(config) as trial:
        trial.run(writer)
    end = writer.events[-1]
    assert isinstance(end, Ended)
    planned = [each for each in writer.events if isinstance(each, PlanMade)]
    first, unseen = planned[0], [each for each in planned if each.planner == UNSEEN]
    assert unseen
    assert len(unseen[0].plan) > len(first.plan) / 2
    assert end.actions > 2 * len(first.plan)


def test_a_mind_is_changed_by_answers_that_settle_something_or_could() -> None:
    assert says_little(Settling(0.6, new=0.6), LITTLE - 0.01, redone=0.001)
    assert not says_little(Settling(0.6, new=0.6), LITTLE, redone=0.001)
    assert not says_little(Settling(0.6, new=0.9), LITTLE - 0.01, redone=0.001)
    assert not says_little(Settling(0.6, new=0.6), LITTLE - 0.01, redone=0.06)
