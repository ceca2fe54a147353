"""Scripted stand-ins for the neighbours of what a test is about."""

from collections.abc import Callable, Sequence
from typing import Any

from tpvqa.config import TrialConfig
from tpvqa.monitors import Ask, Check, Look, Verdict
from tpvqa.observation import Observation
from tpvqa.pddl import Atom
from tpvqa.questions import FactQuestion, Question, Way
from tpvqa.vlm import Answer, Reply, TruthSource
from tpvqa.vlm.making import make_vlm
from tpvqa.worlds import World
from tpvqa.worlds.capabilities import truth_of

_PARTS = {
    "failure": "simulation",
    "disturbance": "simulation",
    "spontaneous": "simulation",
    "redo": "simulation",
    "domain": "task",
    "problem": "task",
    "questions": "task",
    "world_file": "task",
}


def configured(**settings: Any) -> TrialConfig:
    """A configuration whose settings are named without their parts."""
    parts: dict[str, Any] = {}
    for name, value in settings.items():
        part = _PARTS.get(name)
        if part is None:
            key = "name" if name == "task" else "spec"
            named = name in ("task", "world", "vlm", "monitor", "planner")
            known = parts.get(name, {})
            parts[name] = {**known, key: value} if named and isinstance(value, str) else value
        else:
            parts.setdefault(part, {})[name] = value
    return TrialConfig.model_validate(parts)


def made(spec: str, **context: object) -> Any:
    """The VLM of a specification."""
    return make_vlm(spec, context)[0]


def known_truth(world: World) -> TruthSource:
    """What is true in a simulated world."""
    truth = truth_of(world)
    assert truth is not None
    return truth


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
