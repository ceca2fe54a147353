"""Before an action its preconditions, after it its effects; what is denied is taken out."""

from collections.abc import Generator, Sequence
from dataclasses import replace
from typing import Any

from tpvqa.events.decision import Decision
from tpvqa.monitors.asker import Asks, check_effects, give_up, tally
from tpvqa.monitors.doubting import doubted
from tpvqa.monitors.measuring import is_of_number, measured
from tpvqa.monitors.memory import FactMemory
from tpvqa.monitors.numbers_back import numbers_back
from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.requests import Request
from tpvqa.monitors.verdict import Verdict
from tpvqa.pddl import Atom, Literal, State
from tpvqa.pddl.lasting import Phase
from tpvqa.planning.propositional import propositional
from tpvqa.questions import FactQuestion, Way
from tpvqa.vlm import Answer, Reply


class CorrectingMonitor:
    """Takes denied preconditions out of the believed state and replans; repeats what had no effect.

    Args:
        asker: Who asks, and says what the answers come to.
        alternatives: Whether to ask where else a thing is, once a fact about it is denied.
        goal: Whether to ask, after the last action, if the goal holds.
    """

    def __init__(self, asker: Asks, *, alternatives: bool = True, goal: bool = False):
        self._asker, self.alternatives, self.goal = asker, alternatives, goal
        self._memory: FactMemory | None = None

    def before(self, step: Step) -> Check:
        """Check the preconditions: go on, or replan from the corrected state."""
        questions = step.book.preconditions(step.action, step.state)
        denied, answers = yield from self._asker.ask(questions)
        if denied is None:
            return give_up(questions)
        if not denied and not (_looks_meanwhile(step) and _denied(answers)):
            return Verdict(Decision.GO_ON, tally("preconditions", answers))
        corrected = yield from self._correct(step, answers)
        if corrected == step.state:
            # A fact with nothing before it stays: one more look, then the robot acts.
            denied, answers = yield from self._asker.ask(questions)
            if denied is None:
                return give_up(questions)
            if not denied:
                return Verdict(
                    Decision.GO_ON, f"{tally('preconditions', answers)} at the second look"
                )
            corrected = yield from self._correct(step, answers)
        if corrected == step.state:
            reason = f"{tally('preconditions', answers)}; looked twice, nothing else to believe"
            return Verdict(Decision.GO_ON, reason)
        return self._replan(step, "preconditions", answers, corrected)

    def after(self, step: Step) -> Check:
        """Check the effects: go on, or repeat the action; after the last one the goal, too.

        What the robot measures of numbers is believed, and what nobody sees of them is doubted
        where the action fails again and again.
        """
        if _phase(step) is Phase.CANCEL and not step.reported:
            return (yield from self._after_cancelling(step))
        verdict = measured(step, (yield from check_effects(self._asker, step)))
        if step.task.numeric is not None:
            verdict = doubted(step, verdict, self._remember(step))
        if verdict.decision is Decision.REPLAN and verdict.state is not None:
            self._remember(step).record(step.state, verdict.state)
            return verdict
        if verdict.state is None or verdict.decision is Decision.REPEAT:
            return verdict
        self._remember(step).record(step.state, verdict.state)
        last = step.index + 1 == len(step.plan.actions)
        if last and (self.goal or step.task.numeric is not None):
            step = replace(step, state=verdict.state)
            questions = self._about_the_goal(step)
            return (yield from self._check_goal(step, verdict, questions))
        return verdict

    def _after_cancelling(self, step: Step) -> Check:
        """What was cancelled does not run, whatever became of its effects: to cancel it once more
        would change nothing. What is denied of them is looked for, and planned from there.
        """
        questions = step.book.effects(step.action, step.state)
        denied, answers = yield from self._asker.ask(questions)
        if denied is None:
            return give_up(questions)
        stopped = replace(step, state=step.task.apply(step.state, step.action))
        self._remember(step).record(step.state, stopped.state)
        if _denied(answers):
            corrected = yield from self._correct(stopped, answers)
            if corrected != stopped.state:
                return self._replan(stopped, "effects", answers, corrected)
        return Verdict(Decision.GO_ON, tally("effects", answers), stopped.state)

    def _about_the_goal(self, step: Step) -> tuple[FactQuestion, ...]:
        """What is asked in the end: numbers at least, as they change unseen."""
        questions = step.book.goal(step.state)
        return questions if self.goal else tuple(q for q in questions if is_of_number(q.atom))

    def _check_goal(self, step: Step, verdict: Verdict, questions: Sequence[FactQuestion]) -> Check:
        """Replan where a part of the goal is denied."""
        if not questions:
            return verdict
        answers = yield from self._asker.tell(tuple(questions))
        if all(answer.agrees is not False for answer in answers):
            return verdict
        corrected = yield from self._correct(step, answers)
        if corrected == step.state:
            return verdict
        return self._replan(step, "parts of the goal", answers, corrected)

    def _replan(
        self, step: Step, what: str, answers: Sequence[Answer], corrected: State
    ) -> Verdict:
        self._remember(step).correct(step.state, corrected, _denied(answers))
        reason = f"{tally(what, answers)}; {_change(step.state, corrected)}"
        return Verdict(Decision.REPLAN, reason, corrected)

    def _correct(self, step: Step, answers: Sequence[Answer]) -> Generator[Request, Any, State]:
        """Take the denied facts out, believing an alternative where exactly one is affirmed."""
        memory = self._remember(step)
        denied = _denied(answers)
        seen: list[Atom] = []
        unseen: list[Atom] = []
        if self.alternatives:
            for literal in denied:
                affirmed, refused = yield from self._look_elsewhere(step, literal)
                seen += affirmed
                unseen += refused
        corrected = memory.take_out(step.state, denied, seen=seen, unseen=unseen)
        facts = [literal for literal in denied if not is_of_number(literal.atom)]
        if facts != denied and not propositional(step.task, corrected).in_reach:
            # What is said of numbers would leave no way to the goal: it is not taken at its word.
            denied = facts
            corrected = memory.take_out(step.state, denied, seen=seen, unseen=unseen)
        if corrected == step.state or step.task.numeric is None:
            return corrected
        return (yield from numbers_back(self._asker, step, memory, denied, corrected))

    def _look_elsewhere(
        self, step: Step, denied: Literal
    ) -> Generator[Request, Any, tuple[list[Atom], list[Atom]]]:
        """Which alternative of a denied fact the VLM affirms, if exactly one, and which not."""
        if not denied.positive:
            return [], []
        asked_already = step.book.fact(denied, way=Way.ALTERNATIVE).text
        atoms_by_text: dict[str, list[Atom]] = {}
        questions: dict[str, FactQuestion] = {}
        for atom in self._remember(step).alternatives(denied.atom):
            literal = Literal(atom)
            # Where a "no" would say nothing (near another thing), a "yes" decides nothing.
            if step.book.asked(literal) and step.book.asked(literal.negate()):
                question = step.book.fact(literal, way=Way.ALTERNATIVE)
                if question.text != asked_already:
                    questions.setdefault(question.text, question)
                    atoms_by_text.setdefault(question.text, []).append(atom)
        if not questions:
            return [], []
        answers = yield from self._asker.tell(tuple(questions.values()))

        def told(reply: Reply) -> list[list[Atom]]:
            return [atoms_by_text[a.question.text] for a in answers if a.reply is reply]

        affirmed = told(Reply.YES)
        refused = [atom for atoms in told(Reply.NO) for atom in atoms]
        return affirmed[0] if len(affirmed) == 1 else [], refused

    def _remember(self, step: Step) -> FactMemory:
        if self._memory is None:
            self._memory = FactMemory(step.task)
        return self._memory


def _looks_meanwhile(step: Step) -> bool:
    """Whether it is a look at what runs: each single fact is needed, and none outvotes another."""
    return _phase(step) is Phase.WHILE


def _phase(step: Step) -> Phase | None:
    lasting = step.task.lasting
    return None if lasting is None else lasting.phase_of(step.action.name)


def _denied(answers: Sequence[Answer]) -> list[Literal]:
    """What the answers deny of the facts that they are about."""
    return [
        answer.question.literal
        for answer in answers
        if answer.agrees is False and isinstance(answer.question, FactQuestion)
    ]


def _change(before: State, after: State) -> str:
    gone = ", ".join(map(str, sorted(before - after)))
    new = ", ".join(map(str, sorted(after - before)))
    return f"believing {new or 'nothing'} instead of {gone or 'nothing'}"
