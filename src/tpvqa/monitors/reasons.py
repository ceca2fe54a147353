"""A decision in one sentence, from the numbers that it was made of."""

from collections.abc import Mapping, Sequence

from tpvqa.belief.annotated import AnnotatedPlan
from tpvqa.belief.belief import Belief
from tpvqa.belief.evidence import words
from tpvqa.monitors.protocol import Step
from tpvqa.monitors.verdict import Decision
from tpvqa.pddl import Action, Atom, Literal, State
from tpvqa.vlm import Reply

SAID = 2
"""Facts that a reason names, at most."""


def because(
    step: Step,
    belief: Belief,
    told: Mapping[Atom, Sequence[Reply]],
    plan: AnnotatedPlan | None,
    *,
    unseen: bool,
    spent: bool,
) -> str:
    """What was seen since the last action, with what it makes probable and what needs it.

    Args:
        step: Where the trial stands.
        belief: What is believed.
        told: The replies since the last action, by fact.
        plan: The plan that is followed, with its needs.
        unseen: Whether some question got no answer.
        spent: Whether nothing more may be asked.
    """
    if not told:
        if spent:
            return "nothing more may be asked"
        if unseen:
            return "what was asked about cannot be seen from here"
        return "no answer would be worth its price"
    needed = {} if plan is None else {atom: plan.needing(atom, step.index) for atom in told}

    def doubt(atom: Atom) -> tuple[bool, float, Atom]:
        return needed.get(atom) is None, abs(belief.probability(atom) - 0.5), atom

    parts = []
    for atom in sorted(told, key=doubt)[:SAID]:
        part = f"{atom} {_figure(belief.probability(atom))} after {words(told[atom])}"
        place = needed.get(atom)
        if plan is not None and place is not None:
            part += f", which {_needing(step, plan, place)} needs"
        parts.append(part)
    return "; ".join(parts)


def _needing(step: Step, plan: AnnotatedPlan, place: int) -> str:
    if place >= len(plan.actions):
        return "the goal"
    return f"{step.book.say(plan.actions[place])} (step {place + 1})"


def deciding(
    step: Step,
    belief: Belief,
    decision: Decision,
    action: Action | None,
    state: State,
    place: int | None,
) -> str:
    """What is decided, with how probable it makes it."""
    goal = belief.where(step.task.goal_holds)
    if decision is Decision.DONE:
        return f"the goal holds with {_figure(goal)}"
    if decision is Decision.GIVE_UP or action is None:
        return f"no plan is worth trying, and the goal holds with only {_figure(goal)}"
    said = step.book.say(action)
    if decision is Decision.REPEAT:
        return f"{said} again"
    if decision is Decision.REPLAN:
        return f"replanning from {_news(step, belief, state)}"
    number = "" if place is None else f" (step {place + 1})"
    if place is not None and place > step.index + 1:
        return f"on to {said}{number}: what comes before it is done"
    if place is not None and place < step.index:
        return f"back to {said}{number}: {_news(step, belief, state)}"
    return f"{said}{number}"


def _news(step: Step, belief: Belief, state: State) -> str:
    """What is believed now that was not before, or else the whole state's probability."""
    new = [atom for atom in sorted(state - step.state) if step.book.asked(Literal(atom))]
    new = new or sorted(state - step.state)
    if not new:
        lost = sorted(step.state - state)
        if not lost:
            return "what was believed"
        return f"not {lost[0]} ({_figure(1 - belief.probability(lost[0]))})"
    return " and ".join(f"{atom} ({_figure(belief.probability(atom))})" for atom in new[:SAID])


def _figure(probability: float) -> str:
    return f"{min(max(probability, 0.0), 1.0):.2f}"
