"""What is felt as it is done tells joint states apart right then, and perhaps never after."""

from pathlib import Path

from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, Rates
from tpvqa.belief.filtering.sight import Sight
from tpvqa.pddl import load_task

WARD = Path(__file__).parents[1] / "fixtures" / "drawers"
TASK = load_task(WARD / "domain.pddl", WARD / "problem.pddl")
OPEN, DISINFECT = (TASK.action(name, ["upper"]) for name in ("open_drawer", "disinfect"))


def disinfected() -> tuple[FaultModel, set[int]]:
    """Two joint states: the drawer is clean, or it is not."""
    belief = Belief(FaultModel(TASK))
    belief.act(OPEN, Rates(0.0, 0.0, 0.0))
    belief.act(DISINFECT, Rates(0.25, 0.0, 0.0))
    return belief.model, {number for number, _ in belief.ranked()}


def test_what_is_felt_is_told_apart_after_its_own_action_alone() -> None:
    model, numbers = disinfected()
    assert len(numbers) == 2
    sight = Sight(model)
    sight.by(lambda atom: atom.predicate == "open")
    assert len({sight.look(n, DISINFECT) for n in numbers}) == 1
    assert sight.hidden(DISINFECT)
    sight.by(lambda atom: atom.predicate == "open", lambda atom: atom.predicate == "contaminated")
    assert len({sight.look(n, DISINFECT) for n in numbers}) == 2
    assert len({sight.look(n, OPEN) for n in numbers}) == 1
    assert len({sight.look(n) for n in numbers}) == 1
    assert not sight.hidden(DISINFECT)
    sight.by(lambda atom: True)
    assert len({sight.look(n) for n in numbers}) == 2
