"""The look before the first plan: asks until few initial states are left that may be the case."""

from collections.abc import Callable, Generator, Mapping, Sequence
from math import fsum, inf
from typing import Any

from tpvqa.belief.answers.last_answer import Picture
from tpvqa.belief.deciding.inquiry import DOUBT, Budget
from tpvqa.belief.deciding.seeking import LIKELY
from tpvqa.belief.filtering.belief import MOST, Belief
from tpvqa.belief.filtering.first import Prior
from tpvqa.belief.weighing.evidence import Evidence
from tpvqa.events.decision import Decision
from tpvqa.monitors.inspection import Inspection, Replies
from tpvqa.monitors.protocol import Check
from tpvqa.monitors.requests import Ask, Look, PlanFrom, Request
from tpvqa.monitors.silence import nothing_answered
from tpvqa.monitors.verdict import Verdict
from tpvqa.observation import Observation
from tpvqa.pddl import Atom, Literal, State
from tpvqa.planning import Plan
from tpvqa.questions import FactQuestion, FactWords, QuestionBook
from tpvqa.vlm import Answer, Reply

SAME = 3
"""Looks in a row at which nothing new is seen, before no more are taken."""
STALE = 6
"""Rounds of questions in a row that settle nothing more, before no more are asked."""
LESS = 0.9
"""Something is settled where so much of what was in doubt is left, or less."""
FEW = 20
"""Initial states, of equal weight, that are weighed instead of looked for."""
PLANNED = 6
"""Initial states from which a first plan is sought, at most."""
SAID = 2
"""Facts that a reason names, at most."""


def first_look(
    prior: Prior,
    evidence: Evidence,
    book: QuestionBook,
    inspection: Inspection,
    *,
    views: Callable[[FactQuestion], Sequence[str | None]],
    budget: Callable[[], Budget],
    picture: Callable[[Observation], Picture],
) -> Generator[Request, Any, None]:
    """Ask about all that may hold or not, and again about what is still in doubt.

    It ends when few states carry nearly all probability: then a belief weighs what is worth
    asking; or it ends when nothing more can be seen, when asking settles no more (what is out of
    sight may leave many states, and errors that last some doubt), or the budget is used up.

    Args:
        prior: How probable the initial states are; weighed with the answers.
        evidence: Turns answers into what they are worth.
        book: The questions.
        inspection: Keeps what was looked at and answered.
        views: From where a question may still find an answer, the next one first.
        budget: What may still be asked and looked at.
        picture: What tells the picture of one look from that of another.
    """
    questions: dict[str, FactQuestion] = {}
    for atom in prior.atoms:
        if book.asked(Literal(atom)):
            question = book.fact(Literal(atom))
            questions.setdefault(question.text, question)
    # With fewer answers there are too many states for a search to be worth its time.
    enough = evidence.answers_to_be_sure() / 2 if prior.combinations > 10 * MOST else 0
    rounds = barren = stale = 0
    least = inf
    while barren < SAME and (rounds < enough or not prior.covered() or prior.spread() > FEW):
        wanted = [each for each in questions.values() if _in_doubt(each, prior) and views(each)]
        allowed = budget()
        if not wanted or allowed.looks < 1 or allowed.questions < 1:
            return
        inspection.view = views(wanted[0])[0]
        observation: Observation = yield Look(inspection.view)
        inspection.picture = seen = picture(observation)
        inspection.looks += 1
        fresh = [
            each
            for each in wanted
            if inspection.view in views(each) and not evidence.asked_of(each.text, seen)
        ][: allowed.questions]
        barren = 0 if fresh else barren + 1
        if not fresh:
            continue
        answers: list[Answer] = yield Ask(tuple(fresh))
        inspection.questions += len(fresh)
        rounds += 1
        for question, answer in zip(fresh, answers, strict=True):
            before = prior.probability(question.atom, question.alike)
            evidence.take(question, answer, seen, inspection.view)
            if answer.reply in (Reply.YES, Reply.NO):
                told = Replies(question.atoms, before)
                inspection.replies.setdefault(question.text, told).replies.append(answer.reply)
        doubt = fsum(_doubt(each, prior) for each in questions.values() if views(each))
        stale = stale + 1 if doubt > LESS * least else 0
        least = min(least, doubt)
        if stale >= STALE and rounds >= enough:
            return


def _doubt(question: FactQuestion, prior: Prior) -> float:
    probable = prior.probability(question.atom, question.alike)
    return min(probable, 1 - probable)


def _in_doubt(question: FactQuestion, prior: Prior) -> bool:
    return _doubt(question, prior) > DOUBT


def first_verdict(belief: Belief, prior: Prior, words: FactWords, seen: Inspection) -> Check:
    """With what a trial begins: the most probable initial state that there is a plan from.

    A plan that has nothing to do would end the trial; so the goal must be about sure for one.
    Where nothing at all was answered it ends at once.

    Args:
        belief: What is believed.
        prior: Whose facts are told.
        words: Says facts.
        seen: What was looked at and answered.
    """
    done = belief.where(belief.model.task.goal_holds) >= 1 - LIKELY
    states = [state for state, _ in belief.states()]
    begun, plan = states[0], None
    if not seen.replies and (silent := nothing_answered(seen.questions)):
        return Verdict(Decision.GIVE_UP, silent, begun)
    if not done:
        states = [state for state in states if not belief.model.task.goal_holds(state)]
    for state in states[:PLANNED]:
        result = yield PlanFrom(state)
        if isinstance(result, Plan):
            begun, plan = state, result
            break
    chances = {atom: belief.probability(atom) for atom in sorted(prior.atoms)}
    return Verdict(
        Decision.GO_ON, _reason(belief, chances, words, begun, seen), begun, None, chances, plan
    )


def _reason(
    belief: Belief, chances: Mapping[Atom, float], words: FactWords, state: State, seen: Inspection
) -> str:
    least = sorted(chances, key=lambda atom: (abs(chances[atom] - 0.5), atom))[:SAID]
    unsure = [atom for atom in least if DOUBT < chances[atom] < 1 - DOUBT]
    said = ", ".join(f"{words.of(atom)} {chances[atom]:.2f}" for atom in unsure)
    left = len(belief.weights)
    states = "one initial state is" if left == 1 else f"{left} initial states are"
    asked = f"after {seen.questions} questions at {seen.looks} looks " if seen.questions else ""
    weight = dict(belief.states())[state]
    return f"{asked}{states} possible, this one with {weight:.2f}" + (
        f"; least sure is {said}" if said else ""
    )
