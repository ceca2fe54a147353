"""A decision in one sentence, from the numbers that it was made of."""

from collections.abc import Iterable, Sequence

from tpvqa.belief.calibrating.replies_in_words import words
from tpvqa.belief.deciding.annotated import AnnotatedPlan
from tpvqa.events.decision import Decision
from tpvqa.monitors.grounds import Grounds
from tpvqa.monitors.inspection import Replies
from tpvqa.monitors.saying_done import EVEN
from tpvqa.monitors.stated_risk import IN_DOUBT, as_stated
from tpvqa.pddl import Action, Literal, State, holds, literals
from tpvqa.vlm import Reply

SAID = 2
"""Facts that a reason names, at most."""
SURE = 0.9
"""What is surer than this and was not asked about needs no words."""
OPEN = 0.05
"""What is less probable than this, or its contrary, is in no doubt that anything has to settle."""
LITTLE = 0.5
"""Where answers settle less than this, that is why no plan is worth trying."""


def reason(
    grounds: Grounds, decision: Decision, action: Action | None, state: State, place: int | None
) -> str:
    """Why something is decided: what is needed next and how probable it is, then what follows.

    Args:
        grounds: What it is made of.
        decision: What is decided.
        action: The action to execute; None to end here.
        state: The most probable joint state in which this is what to do.
        place: Which step of the plan that is; None for none.
    """
    failing = (grounds.failing,) if grounds.failing and decision is not Decision.DONE else ()
    return "; ".join(
        (*failing, _reason(grounds, decision, action, state, place), *_checked(grounds))
    )


def _checked(grounds: Grounds) -> list[str]:
    """What was asked about though it is known, to see what answers are worth."""
    asked = dict.fromkeys(each.family for each in grounds.now.controls)
    known = [grounds.told[family] for family in asked if family in grounds.told]
    if not known:
        return []
    first, more = known[0], f" and {len(known) - 1} more" if len(known) > 1 else ""
    heard = words(first.replies) or "no answer"
    said = f"{grounds.words.of(first.atoms[0])} {_figure(first.before)}, {heard}"
    return [f"asked what is known to see what answers are worth ({said}{more})"]


def _reason(
    grounds: Grounds, decision: Decision, action: Action | None, state: State, place: int | None
) -> str:
    if action is None:
        doubt = f"{IN_DOUBT}: " if _stopped(grounds, decision) else ""
        return doubt + "; ".join((*_of_goal(grounds, decision), _end(grounds, decision)))
    missing = [each for each in _needs(grounds) if not each.holds(state)]
    planned = action if place is None else grounds.step.plan.actions[place]
    said = grounds.step.book.say(planned)  # as its step says it: what is rebound is the same skill
    number = "" if place is None else f" (step {place + 1})"
    if grounds.followed:
        return f"{_decided(grounds)}; {_next(grounds, decision, said, number, place)}"
    if decision is Decision.GO_ON and place == grounds.next:
        return "; ".join((*_why_on(grounds, action, missing), f"{said}{number}"))
    if decision is Decision.REPEAT:
        mended = {*_effects(grounds, action, state)}
        missing = [each for each in missing if each in mended] or missing
    facts = [_fact(grounds, each) for each in missing[:SAID]]
    there = _instead(grounds, missing[:SAID], state) or _news(grounds, state)
    if decision is Decision.REPEAT:
        if not facts and grounds.plan is not None:
            facts = [f"{_listed(grounds, there)} would be mended by it"]
        facts = facts or _brought(grounds, action, state)
        return "; ".join((*facts, f"{said} again"))
    if decision is Decision.REPLAN:
        return "; ".join((*facts, f"replanning{_since(grounds, there, ' from')}"))
    if place is not None and place > grounds.next:
        since = f"{_already(grounds, place, there[:SAID])}{_since(grounds, there)}"
        return "; ".join((*facts, f"on to {said}{number}, {since}"))
    undone = _undone(grounds, planned, state) or there
    return "; ".join((*facts, f"back to {said}{number}{_since(grounds, undone)}"))


def _next(grounds: Grounds, decision: Decision, said: str, number: str, place: int | None) -> str:
    """What is done next of what is followed unseen."""
    if decision is Decision.REPEAT:
        return f"{said} again"
    if place is None or place == grounds.next:
        return f"{said}{number}"
    return f"{'on' if place > grounds.next else 'back'} to {said}{number}"


def _already(grounds: Grounds, place: int, told: Sequence[Literal]) -> str:
    """What follows from facts for which a step is done before its turn: that what comes before it
    would bring about no more than they say, where it needs none of them; else that it can be."""
    actions = grounds.step.plan.actions
    brought = {each.literal for a in actions[grounds.next : place] for each in a.effects}
    needed = {*literals(actions[place].precondition)}
    done = needed.isdisjoint(told) and not brought.isdisjoint(told)
    return f"{'as what comes before it is' if done else 'which can be'} done already"


def _needs(grounds: Grounds) -> list[Literal]:
    """What the next step and the rest of the plan rest on, the least probable first."""
    if grounds.plan is None or grounds.next >= len(grounds.plan.needs):
        return []
    return sorted(grounds.plan.needs[grounds.next], key=lambda n: (grounds.probability(n), n.atom))


def _effects(grounds: Grounds, action: Action, state: State) -> list[Literal]:
    """What an action can bring about in a state: what it does only on a condition, where that
    holds."""
    there = grounds.step.task.extend(state)
    return [each.literal for each in action.effects if holds(each.condition, there)]


def _brought(grounds: Grounds, action: Action, state: State) -> list[str]:
    """The least probable of what an action brings about, of what is needed where any of it is."""
    brought, needed = {*_effects(grounds, action, state)}, {*_needs(grounds)}
    effects = sorted(brought, key=lambda n: (n not in needed, grounds.probability(n), n.atom))
    return [_fact(grounds, each, needing=False) for each in effects[:1]]


def _why_on(grounds: Grounds, action: Action, missing: Sequence[Literal]) -> list[str]:
    """What speaks for the next step: what it rests on that was asked or sensed, or is in doubt."""
    said, task = grounds.step.book.say(action), grounds.step.task
    needs = [need for need in _needs(grounds) if need not in missing]
    doubted = [n for n in needs if grounds.known(n.atom) or grounds.probability(n) < SURE]
    parts = [_fact(grounds, each) for each in doubted[:SAID]]
    if not parts:
        parts = _most_telling(grounds)
    if not doubted and needs:
        together = grounds.belief.where(lambda state: all(n.holds(state) for n in needs))
        parts.append(f"all that the plan needs now holds with {_figure(together)}")
    for need in missing[:1]:
        parts.append(f"{grounds.say(need)} {_figure(grounds.probability(need))} is for later")
    able = grounds.belief.where(lambda state: task.applicable(state, action))
    return parts or [f"{said} can be done with {_figure(able)}"]


def _most_telling(grounds: Grounds) -> list[str]:
    """The fact asked about or sensed, though not needed next, whose probability changed most."""
    now = grounds.belief.probability
    changes = {
        told.atoms: abs(now(told.atoms[0], told.atoms[1:]) - told.before)
        for told in grounds.told.values()
    }
    for atom, noticed in grounds.noticed.items():
        changes.setdefault((atom,), abs(now(atom) - noticed.before))
    if not changes:
        return []
    atoms = max(changes, key=lambda each: (changes[each], each))
    return [_fact(grounds, Literal(atoms[0]), needing=False)]


def _of_goal(grounds: Grounds, decision: Decision) -> list[str]:
    """What of the goal was asked about or sensed, or is in doubt."""
    sure = 1.0 if _stopped(grounds, decision) else SURE
    goal = _goal(grounds)
    doubted = [n for n in goal if grounds.known(n.atom) or grounds.probability(n) < sure]
    return [_fact(grounds, each, needing=False) for each in doubted[:SAID]]


def _goal(grounds: Grounds) -> list[Literal]:
    """What the goal is made of, the least probable first."""
    if grounds.plan is None:
        return []
    return sorted(grounds.plan.needs[-1], key=lambda n: (grounds.probability(n), n.atom))


def _stopped(grounds: Grounds, decision: Decision) -> bool:
    """Whether it ends without "done" for the sake of the risk that is stated alone."""
    likely = grounds.belief.where(grounds.step.task.goal_holds) >= EVEN
    return grounds.risk is not None and decision is Decision.GIVE_UP and likely


def _settling(grounds: Grounds) -> str:
    """What would settle what is in doubt of the goal."""
    doubted = next(iter(_goal(grounds)), None)
    if doubted is None:
        return ""
    if not grounds.step.book.asked(Literal(doubted.atom)):
        return f"; no question tells whether {grounds.say(doubted)}"
    who = "" if grounds.questions_left else "more questions, or "
    return f"; {who}a person's word on {grounds.say(doubted)} would settle it"


def _never_seen(grounds: Grounds) -> str:
    """What of the goal no question and no sensor has told anything of."""
    hidden = [
        grounds.say(each)
        for each in _goal(grounds)
        if not grounds.step.book.asked(Literal(each.atom))
        and not grounds.known(each.atom)
        and _figure(grounds.probability(each)) != "1.00"
    ]
    return f"; nothing shows {' and '.join(hidden[:SAID])}" if hidden else ""


def _end(grounds: Grounds, decision: Decision) -> str:
    probability = grounds.belief.where(grounds.step.task.goal_holds)
    goal = _figure(probability)
    why = ""
    if grounds.actions_left is not None and grounds.actions_left <= 0:
        why = "no action is left, and "
    elif decision is Decision.GIVE_UP and _too_few(grounds):
        why = f"too few actions are left ({grounds.actions_left}), and "
    elif not grounds.questions_left:
        why = "no question is left, and "
    if _stopped(grounds, decision) and grounds.risk is not None:
        return f"{why}{as_stated(probability, grounds.risk)}{_settling(grounds)}"
    if decision is Decision.DONE and grounds.risk is not None:
        return f"{why}{as_stated(probability, grounds.risk)}"
    if decision is Decision.DONE:
        return f"{why}the goal holds with {goal}{_never_seen(grounds)}"
    if not why and grounds.step.replans_left == 0:
        why = "no change of plan is left, and "
    if not why and grounds.failing:
        why = "no other way is known, and "
    if not why:
        why = "no plan is worth trying, and "
        if grounds.settles < LITTLE:
            why = (
                f"no plan is worth trying, as answers settle {_figure(grounds.settles)} of what "
                "is in doubt, and "
            )
    doubt = _settling(grounds) if OPEN < probability < 1 - OPEN and not grounds.failing else ""
    return f"{why}the goal holds with only {goal}{doubt}"


def _too_few(grounds: Grounds) -> bool:
    if grounds.plan is None or grounds.actions_left is None:
        return False
    return grounds.actions_left < len(grounds.plan.actions) - grounds.next


def _fact(grounds: Grounds, need: Literal, *, needing: bool = True) -> str:
    """A fact with how probable it is, since when, and what rests on it."""
    told, noticed = grounds.answers(need.atom), grounds.noticed.get(need.atom)
    text = f"{grounds.say(need)} {_figure(grounds.probability(need))}"
    if told is not None or noticed is not None:
        first = noticed or told  # it notices before anything is asked
        assert first is not None
        before = first.before if need.positive else 1 - first.before
        alone = told is None or len(told.atoms) == 1
        if alone and _figure(before) != _figure(grounds.probability(need)):
            text = f"{grounds.say(need)} {_figure(before)} → {_figure(grounds.probability(need))}"
        by = [] if noticed is None else list(noticed.by)
        by += [] if told is None else [f"after {words(told.replies)}"]
        text += f" {' and '.join(by)}"
        if told is not None and noticed is None and _against(grounds, told):
            others = any(need.atom not in each.atoms for each in grounds.told.values())
            text += f", {'by what else was answered' if others else 'which seem to be misread'}"
    elif not grounds.step.book.asked(Literal(need.atom)):
        pass  # bookkeeping that nothing shows
    elif not grounds.questions_left:
        text += " (no question left)"
    elif grounds.out_of_view(need.atom):
        text += " (out of view)"
    else:
        text += " (not worth asking)"
    place = None if grounds.plan is None else grounds.plan.needing(need.atom, grounds.next)
    if needing and place is not None and grounds.plan is not None:
        text += f", which {_consumer(grounds, grounds.plan, place)} needs"
    return text


def _against(grounds: Grounds, told: Replies) -> bool:
    """Whether a fact has become more probable against most of its answers, or less so."""
    risen = grounds.belief.probability(told.atoms[0], told.atoms[1:]) - told.before
    more = told.replies.count(Reply.YES) - told.replies.count(Reply.NO)
    return risen * more < 0 and _figure(risen + told.before) != _figure(told.before)


def _consumer(grounds: Grounds, plan: AnnotatedPlan, place: int) -> str:
    if place >= len(plan.actions):
        return "the goal"
    return f"{grounds.step.book.say(plan.actions[place])} (step {place + 1})"


def _instead(grounds: Grounds, missing: Iterable[Literal], state: State) -> list[Literal]:
    """What holds where something that is needed does not: where the thing is that is not here."""
    task, found = (
        grounds.step.task,
        dict.fromkeys(
            atom
            for need in missing
            for group in grounds.step.task.groups_of(need.atom)
            for atom in sorted(group.atoms & state)
            if atom != need.atom
        ),
    )
    asked = [atom for atom in found if grounds.step.book.asked(Literal(atom))]
    return [Literal(atom) for atom in asked if task.groups_of(atom)]


def _undone(grounds: Grounds, action: Action, state: State) -> list[Literal]:
    """What an action brings about that was believed, and is not any more."""
    lost = [
        effect.literal
        for effect in action.effects
        if effect.literal.holds(grounds.step.state) and not effect.literal.holds(state)
    ]
    asked = [each for each in lost if grounds.step.book.asked(Literal(each.atom))] or lost
    return [Literal(each.atom, not each.positive) for each in asked]


def _news(grounds: Grounds, state: State) -> list[Literal]:
    """What is believed now that was not before."""
    new = sorted(state - grounds.step.state)
    shown = [atom for atom in new if grounds.step.book.asked(Literal(atom))] or new
    lost = [Literal(atom, positive=False) for atom in sorted(grounds.step.state - state)]
    return [Literal(atom) for atom in shown] or lost[:1]


def _since(grounds: Grounds, told: Sequence[Literal], since: str = ":") -> str:
    """For what something is decided: what is believed, or what may be the case all the same."""
    likely = all(round(grounds.probability(each), 2) >= EVEN for each in told[:SAID])
    return f"{since if likely else ' in case'} {_listed(grounds, told)}"


def _listed(grounds: Grounds, told: Sequence[Literal]) -> str:
    figures = (
        f"{grounds.say(each)} ({_figure(grounds.probability(each))})" for each in told[:SAID]
    )
    return " and ".join(figures) or "what was believed"


def _decided(grounds: Grounds) -> str:
    return f"what was decided, as answers settle {_figure(grounds.settles)} of what is in doubt"


def _figure(probability: float) -> str:
    return f"{min(max(probability, 0.0), 1.0):.2f}"
