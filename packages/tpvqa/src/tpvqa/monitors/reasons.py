"""A decision in one sentence, from the numbers that it was made of."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from tpvqa.belief.annotated import AnnotatedPlan
from tpvqa.belief.belief import Belief
from tpvqa.belief.evidence import words
from tpvqa.monitors.protocol import Step
from tpvqa.monitors.verdict import Decision
from tpvqa.pddl import Action, Atom, Literal, State
from tpvqa.questions import FactWords
from tpvqa.vlm import Reply

SAID = 2
"""Facts that a reason names, at most."""
SURE = 0.9
"""What is surer than this and was not asked about needs no words."""


@dataclass(slots=True, eq=False)
class Told:
    """What was answered to a question since the last action.

    Attributes:
        atoms: The fact that it is about, and those alike.
        before: How probable it was before the first answer.
        replies: The answers.
    """

    atoms: tuple[Atom, ...]
    before: float
    replies: list[Reply] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Moment:
    """What a decision is made of.

    Attributes:
        step: Where the trial stands.
        words: Says facts.
        belief: What is believed.
        told: What was answered since the last action, by question.
        plan: The plan that is followed, with its needs.
        acted: Whether the step's action was just executed.
        unseen: Whether some question found no answer.
        questions_left: Whether anything more may be asked.
        actions_left: Actions that the trial still allows; None for any number.
    """

    step: Step
    words: FactWords
    belief: Belief
    told: Mapping[str, Told]
    plan: AnnotatedPlan | None
    acted: bool
    unseen: bool
    questions_left: bool
    actions_left: int | None

    @property
    def next(self) -> int:
        """The step of the plan that would be next if all had gone well; its length for the goal."""
        return self.step.index + self.acted

    def probability(self, literal: Literal) -> float:
        """How probable a literal is."""
        p = self.belief.probability(literal.atom)
        return p if literal.positive else 1 - p

    def say(self, literal: Literal) -> str:
        """A literal in words."""
        said = self.words.of(literal.atom)
        return said if literal.positive else f"not {said}"

    def answers(self, atom: Atom) -> Told | None:
        """What was answered about a fact, or about those alike."""
        return next((told for told in self.told.values() if atom in told.atoms), None)


def reason(
    moment: Moment, decision: Decision, action: Action | None, state: State, place: int | None
) -> str:
    """Why something is decided: what is needed next and how probable it is, then what follows.

    Args:
        moment: What it is made of.
        decision: What is decided.
        action: The action to execute; None to end here.
        state: The most probable joint state in which this is what to do.
        place: Which step of the plan that is; None for none.
    """
    if action is None:
        return "; ".join((*_of_goal(moment), _end(moment, decision)))
    missing = [each for each in _needs(moment) if not each.holds(state)]
    said = moment.step.book.say(action)
    number = "" if place is None else f" (step {place + 1})"
    if decision is Decision.GO_ON and place == moment.next:
        return "; ".join((*_why_on(moment, said, missing), f"{said}{number}"))
    if decision is Decision.REPEAT:
        mended = {effect.literal for effect in action.effects}
        missing = [each for each in missing if each in mended] or missing
    facts = [_fact(moment, each) for each in missing[:SAID]]
    there = _instead(moment, missing[:SAID], state) or _news(moment, state)
    if decision is Decision.REPEAT:
        facts = facts or [f"{there} would be mended by it"]
        return "; ".join((*facts, f"{said} again"))
    if decision is Decision.REPLAN:
        return "; ".join((*facts, f"replanning from {there}"))
    if place is not None and place > moment.next:
        return "; ".join((*facts, f"on to {said}{number}, which can be done already: {there}"))
    return "; ".join((*facts, f"back to {said}{number}: {there}"))


def _needs(moment: Moment) -> list[Literal]:
    """What the next step and the rest of the plan rest on, the least probable first."""
    if moment.plan is None or moment.next >= len(moment.plan.needs):
        return []
    return sorted(moment.plan.needs[moment.next], key=lambda n: (moment.probability(n), n.atom))


def _why_on(moment: Moment, said: str, missing: Sequence[Literal]) -> list[str]:
    """What speaks for the next step: what it rests on that was asked about, or is in doubt."""
    needs = [need for need in _needs(moment) if need not in missing]
    doubted = [n for n in needs if moment.answers(n.atom) or moment.probability(n) < SURE]
    parts = [_fact(moment, each) for each in doubted[:SAID]]
    if not parts:
        parts = _most_telling(moment)
    if not doubted and needs:
        together = moment.belief.where(lambda state: all(n.holds(state) for n in needs))
        parts.append(f"all that {said} needs holds with {_figure(together)}")
    for need in missing[:1]:
        parts.append(f"{moment.say(need)} {_figure(moment.probability(need))} is for later")
    return parts or ["nothing speaks against it"]


def _most_telling(moment: Moment) -> list[str]:
    """The fact that was asked about, though not needed next, whose probability changed most."""
    changes = {
        told: abs(moment.belief.probability(told.atoms[0], told.atoms[1:]) - told.before)
        for told in moment.told.values()
    }
    if not changes:
        return []
    told = max(changes, key=lambda each: (changes[each], each.atoms))
    return [_fact(moment, Literal(told.atoms[0]), needing=False)]


def _of_goal(moment: Moment) -> list[str]:
    """What of the goal was asked about, or is in doubt."""
    if moment.plan is None:
        return []
    goal = sorted(moment.plan.needs[-1], key=lambda n: (moment.probability(n), n.atom))
    doubted = [n for n in goal if moment.answers(n.atom) or moment.probability(n) < SURE]
    return [_fact(moment, each, needing=False) for each in doubted[:SAID]]


def _end(moment: Moment, decision: Decision) -> str:
    goal = _figure(moment.belief.where(moment.step.task.goal_holds))
    why = ""
    if moment.actions_left is not None and moment.actions_left <= 0:
        why = "no action is left, and "
    elif decision is Decision.GIVE_UP and _too_few(moment):
        why = f"the {moment.actions_left} actions left are too few, and "
    elif not moment.questions_left:
        why = "no question is left, and "
    if decision is Decision.DONE:
        return f"{why}the goal holds with {goal}"
    return f"{why or 'no plan is worth trying, and '}the goal holds with only {goal}"


def _too_few(moment: Moment) -> bool:
    if moment.plan is None or moment.actions_left is None:
        return False
    return moment.actions_left < len(moment.plan.actions) - moment.next


def _fact(moment: Moment, need: Literal, *, needing: bool = True) -> str:
    """A fact with how probable it is, since when, and what rests on it."""
    told = moment.answers(need.atom)
    text = f"{moment.say(need)} {_figure(moment.probability(need))}"
    if told is not None:
        before = told.before if need.positive else 1 - told.before
        if len(told.atoms) == 1 and _figure(before) != _figure(moment.probability(need)):
            text = f"{moment.say(need)} {_figure(before)} → {_figure(moment.probability(need))}"
        text += f" after {words(told.replies)}"
    elif not moment.step.book.asked(Literal(need.atom)):
        pass  # bookkeeping that nothing shows
    elif not moment.questions_left:
        text += " (no question left)"
    elif moment.unseen:
        text += " (out of view)"
    else:
        text += " (not worth asking)"
    place = None if moment.plan is None else moment.plan.needing(need.atom, moment.next)
    if needing and place is not None and moment.plan is not None:
        text += f", which {_consumer(moment, moment.plan, place)} needs"
    return text


def _consumer(moment: Moment, plan: AnnotatedPlan, place: int) -> str:
    if place >= len(plan.actions):
        return "the goal"
    return f"{moment.step.book.say(plan.actions[place])} (step {place + 1})"


def _instead(moment: Moment, missing: Iterable[Literal], state: State) -> str:
    """What holds where something that is needed does not: where the thing is that is not here."""
    task, found = (
        moment.step.task,
        dict.fromkeys(
            atom
            for need in missing
            for group in moment.step.task.groups_of(need.atom)
            for atom in sorted(group.atoms & state)
            if atom != need.atom
        ),
    )
    asked = [atom for atom in found if moment.step.book.asked(Literal(atom))]
    return _list(moment, [atom for atom in asked if task.groups_of(atom)])


def _news(moment: Moment, state: State) -> str:
    """What is believed now that was not before."""
    new = sorted(state - moment.step.state)
    shown = [atom for atom in new if moment.step.book.asked(Literal(atom))] or new
    if shown:
        return _list(moment, shown)
    lost = [Literal(atom, positive=False) for atom in sorted(moment.step.state - state)]
    if lost:
        return f"{moment.say(lost[0])} ({_figure(moment.probability(lost[0]))})"
    return "what was believed"


def _list(moment: Moment, atoms: Sequence[Atom]) -> str:
    return " and ".join(
        f"{moment.words.of(atom)} ({_figure(moment.belief.probability(atom))})"
        for atom in atoms[:SAID]
    )


def _figure(probability: float) -> str:
    return f"{min(max(probability, 0.0), 1.0):.2f}"
