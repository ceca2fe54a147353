"""How a trial begins: what may hold at first, and how a simulated world truly is."""

from typing import TYPE_CHECKING

from tpvqa.belief.filtering.priors import Priors
from tpvqa.chance import chance
from tpvqa.pddl import State, Task

if TYPE_CHECKING:
    from tpvqa.belief.filtering.faults import FaultRules


def opened(task: Task, priors: Priors) -> Task:
    """The task in which all that the priors name may hold at first.

    Raises:
        PlannerError: The worker could not ground it.
    """
    if priors.nothing_known or not (priors.facts or priors.elsewhere):
        return task
    from tpvqa.belief.states.places import further_places  # late: its needs take a while

    can_hold = task.atoms() | task.init
    everything = {atom for group in task.mutex_groups for atom in group.atoms} - can_hold
    more = {atom for atom in priors.stated(everything, task) if task.fits(atom)}
    if priors.elsewhere:
        more |= further_places(task)
    return task.opened_to(more) if more else task


def drawn_start(
    task: Task, priors: Priors, rules: "FaultRules", seed: int, episode: int
) -> State | None:
    """The true initial state of a simulated world; None for the problem's own.

    It is drawn as the problem and the priors say. Where nothing is known it is the problem's own:
    that says what the robot knows, not how the world came about.
    """
    unsure = task.left_open or priors.opens
    if priors.nothing_known or not (unsure or priors.elsewhere):
        return None
    from tpvqa.belief.filtering.doubts import moved  # late, as all that they need takes a while
    from tpvqa.belief.filtering.first import Prior
    from tpvqa.belief.states.surprise import Surprise

    random = chance(seed, episode, "start")
    state = Prior(task, priors, rules.undo).drawn(random) if unsure else task.init
    if priors.elsewhere:
        state = moved(task, state, priors.elsewhere, Surprise(task, rules.undo), random)
    return state
