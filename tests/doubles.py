"""Scripted stand-ins for the neighbours of what a test is about."""

from collections.abc import Callable, Sequence

from tpvqa.monitors import Ask, Check, Look, Verdict
from tpvqa.observation import Observation
from tpvqa.pddl import Atom
from tpvqa.questions import FactQuestion, Question, Way
from tpvqa.vlm import Answer, Reply

Answerer = Callable[[Question], Reply]


def replies(table: dict[str, Reply], default: Reply = Reply.YES) -> Answerer:
    """An answerer that knows some questions by their text and says `default` to all others."""
    return lambda question: table.get(question.text, default)


def knowing(*atoms: str) -> Answerer:
    """An answerer that says yes exactly to questions about these facts."""
    true = {Atom.parse(atom) for atom in atoms}
    return lambda question: truthful(question, true.__contains__)


def truthful(question: Question, holds: Callable[[Atom], bool]) -> Reply:
    """The right reply to a question about a fact."""
    assert isinstance(question, FactQuestion)
    return Reply.YES if question.true_in(holds) else Reply.NO


def worded(text: str) -> FactQuestion:
    """A question in words alone, for VLMs that look at pictures."""
    return FactQuestion(text, Way.EFFECT, Atom("asked"))


class ScriptedVLM:
    """A VLM that answers by one answerer after the other, one for each look; the last one stays."""

    name = "scripted"

    def __init__(self, *answerers: Answerer):
        self._answerers = answerers
        self.asked: list[str] = []

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        answerer = self._answerers[min(observation.look, len(self._answerers) - 1)]
        self.asked += [question.text for question in questions]
        return [Answer(question, answerer(question)) for question in questions]


def perform(check: Check, *answerers: Answerer) -> tuple[Verdict, int, list[str]]:
    """Drive a monitor without world or VLM: its verdict, the number of looks, what it asked."""
    looks, asked = 0, list[str]()
    answer: object = None
    try:
        while True:
            request = check.send(answer)
            if isinstance(request, Look):
                answer = Observation(looks)
                looks += 1
            else:
                assert isinstance(request, Ask)
                asked += [question.text for question in request.questions]
                answerer = answerers[min(max(looks - 1, 0), len(answerers) - 1)]
                answer = [Answer(question, answerer(question)) for question in request.questions]
    except StopIteration as end:
        return end.value, looks, asked
