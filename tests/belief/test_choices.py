"""Which choices there are."""

from math import inf, isfinite
from pathlib import Path

from tpvqa.belief.annotated import AnnotatedPlan
from tpvqa.belief.belief import Belief
from tpvqa.belief.choices import Chooser
from tpvqa.belief.costs import Costs
from tpvqa.belief.faults import FaultModel, Rates
from tpvqa.belief.sight import Sight
from tpvqa.belief.skills import SkillState
from tpvqa.pddl import load_task
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
