"""A rival that believes every answer: it asks about everything, and plans from what was said.

That is how the ViPlan benchmark (Merler et al. 2025) has a VLM ground a planner.
"""

from collections.abc import Generator, Sequence
from typing import Any

from tpvqa.errors import PluginError
from tpvqa.events.decision import Decision
from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.requests import Ask, Look, Request
from tpvqa.monitors.verdict import Verdict
from tpvqa.pddl import Action, Atom, Literal, State
from tpvqa.questions import FactQuestion, QuestionBook
from tpvqa.vlm import Answer, Reply


class Grounder:
    """What is answered about every fact is the state; one unexpected answer, and all is asked anew.

    Before there is a plan every fact is asked about that changes and can be shown. Facts that are
    affirmed hold, all others do not. Before an action all its preconditions are asked, after it all
    its effects, as they follow from the believed state. Where one answer is not as expected, or the
    skill reports a failure, the plan is over: everything is asked again, and planned anew. It ends
    where there is no plan, and where the skill fails at the action that was tried just before. An
    action whose preconditions are denied is not done, and counts against the limit of actions all
    the same.

    Facts that no question is about are as the problem says, and then as actions make them. The
    published procedure takes from its simulator which conditional effects an action truly had; here
    nobody is told, and they are those of the believed state.
    """

    name = "grounder"

    def __init__(self) -> None:
        self._last: Action | None = None
        self._denied = 0

    @classmethod
    def from_spec(cls, arguments: str = "") -> "Grounder":
        """Make it from `grounder`.

        Raises:
            PluginError: There are arguments.
        """
        if arguments:
            raise PluginError(f"'grounder:{arguments}' is not understood. Write grounder.")
        return cls()

    @property
    def unsure(self) -> bool:
        """Always: what the problem says of the initial state is not taken for true."""
        return True

    def first(self, book: QuestionBook) -> Check:
        """Ask about everything; the plan is made from that."""
        state, said = yield from _enumerated(book, book.task.init)
        return Verdict(Decision.GO_ON, said, state)

    def before(self, step: Step) -> Check:
        """Go on where all preconditions are answered as expected."""
        wrong = yield from _unexpected(step.book.preconditions(step.action, step.state))
        if not wrong:
            return Verdict(Decision.GO_ON, "all preconditions are as expected")
        self._last = step.action
        self._denied += 1
        if step.actions_left is not None and self._denied >= step.actions_left:
            reason = f"{wrong}; with {self._denied} denied actions the limit of actions is reached"
            return Verdict(Decision.GIVE_UP, reason)
        return (yield from _anew(step, step.state, wrong))

    def after(self, step: Step) -> Check:
        """Go on where all effects are answered as expected."""
        last, self._last = self._last, step.action
        if step.reported:
            if last == step.action:
                return Verdict(Decision.GIVE_UP, "the skill failed at the same action twice")
            return (yield from _anew(step, step.state, "the skill reports a failure"))
        after = step.task.apply(step.state, step.action)
        wrong = yield from _unexpected(step.book.effects(step.action, step.state))
        if not wrong:
            return Verdict(Decision.GO_ON, "all effects are as expected", after)
        return (yield from _anew(step, after, wrong))


def _anew(step: Step, expected: State, why: str) -> Check:
    state, said = yield from _enumerated(step.book, expected)
    return Verdict(Decision.REPLAN, f"{why}; {said}", state)


def _unexpected(questions: Sequence[FactQuestion]) -> Generator[Request, Any, str]:
    """Ask, and tell the answers that are not as expected; empty where all are."""
    if not questions:
        return ""
    yield Look()
    answers: list[Answer] = yield Ask(tuple(questions))
    wrong = [answer for answer in answers if not answer.agrees]
    return "; ".join(f"{each.question.text} {each.reply}" for each in wrong)


def _enumerated(book: QuestionBook, otherwise: State) -> Generator[Request, Any, tuple[State, str]]:
    """The state that the answers to all questions make, and that in words.

    Args:
        book: The questions.
        otherwise: What holds of the facts that no question is about.
    """
    asked: dict[str, list[Atom]] = {}
    questions: dict[str, FactQuestion] = {}
    for atom in sorted(book.task.atoms()):
        if atom.predicate in book.task.fluents and book.asked(Literal(atom)):
            question = book.fact(Literal(atom))
            questions.setdefault(question.text, question)
            asked.setdefault(question.text, []).append(atom)
    known = otherwise - {atom for atoms in asked.values() for atom in atoms}
    if not questions:
        return known, "there is nothing to ask"
    yield Look()
    answers: list[Answer] = yield Ask(tuple(questions.values()))
    held = {
        atom
        for answer in answers
        if answer.reply is Reply.YES
        for atom in asked[answer.question.text]
    }
    return known | held, f"of {len(answers)} facts asked about {len(held)} are affirmed"
