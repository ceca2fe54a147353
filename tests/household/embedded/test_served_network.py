"""The embedded network behind a server: what comes back over HTTP is what it says at home."""

from collections.abc import Sequence

import pytest

from tests.doubles import worded
from tests.vlm.chat_server import Act, ChatServer, Request
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import load_task
from tpvqa.questions import Question, QuestionBook
from tpvqa.tasks import find_task
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.openai_compatible import OpenAICompatibleVLM
from tpvqa_household.embedded import EmbeddedVLM
from tpvqa_household.images.manifest import load_pictures

NETWORK = EmbeddedVLM()


def answerer(pictures: Sequence[bytes], question: str) -> float | str:
    """What the network says about what came over the wire."""
    frames = {str(n): Frame(str(n), str(n), data) for n, data in enumerate(pictures)}
    (answer,) = NETWORK.ask(Observation(0, 0.0, frames), [worded(question)])
    if answer.p_yes is None or answer.reply is Reply.CANNOT_SEE:
        return "The picture does not show that."
    return answer.p_yes


@pytest.fixture(scope="module")
def looks() -> list[Observation]:
    pictures = load_pictures()
    chosen = pictures.manifest.pictures[:: len(pictures.manifest.pictures) // 3][:3]
    return [
        Observation(n, float(n), {"front": Frame(picture.file, "front", pictures.read(picture))})
        for n, picture in enumerate(chosen)
    ]


@pytest.fixture(scope="module")
def questions() -> list[Question]:
    task = load_task("serve_breakfast")
    book = QuestionBook.load(find_task("serve_breakfast").questions, task)
    place = task.action("place", ["bread", "plate", "left"])
    return [
        *book.preconditions(place, task.init),
        *book.effects(place, task.init),
        book.did(place),
        worded("Is the weather fine?"),
    ]


def served(server: ChatServer, looks: list[Observation], questions: list[Question]) -> list[Answer]:
    vlm = OpenAICompatibleVLM("network", base_url=server.url)
    try:
        return [answer for look in looks for answer in vlm.ask(look, questions)]
    finally:
        vlm.close()


def at_home(looks: list[Observation], questions: list[Question]) -> list[Answer]:
    return [answer for look in looks for answer in NETWORK.ask(look, questions)]


def seen(answer: Answer) -> Reply:
    """What a language model can say of it: it has no third answer."""
    return answer.reply if answer.reply in (Reply.YES, Reply.NO) else Reply.UNKNOWN


@pytest.mark.parametrize("logprobs", [True, False])
def test_the_answers_are_those_of_the_network(
    looks: list[Observation], questions: list[Question], logprobs: bool
) -> None:
    expected = at_home(looks, questions)
    with ChatServer(answerer, logprobs=logprobs) as server:
        found = served(server, looks, questions)
    assert [answer.reply for answer in found] == [seen(answer) for answer in expected]
    assert {Reply.YES, Reply.NO, Reply.UNKNOWN} == {answer.reply for answer in found}
    for answer, original in zip(found, expected, strict=True):
        if answer.reply is Reply.UNKNOWN:
            assert answer.p_yes is None
        elif logprobs:
            assert answer.p_yes == pytest.approx(original.p_yes, abs=1e-6)
        else:
            assert (answer.p_yes, answer.source) == (None, "word")


def test_trouble_on_the_way_changes_no_answer(
    looks: list[Observation], questions: list[Question]
) -> None:
    troubles = [Act(500, "oops"), Act(429, {}, {"Retry-After": "0.01"}), Act(reset=True)]

    def troubled(request: Request, before: int) -> Act | None:
        return troubles[len(request.question) % 3] if before == 0 else None

    with ChatServer(answerer, script=troubled) as server:
        found = served(server, looks[:1], questions)
    expected = [seen(answer) for answer in at_home(looks[:1], questions)]
    assert [answer.reply for answer in found] == expected
    assert len(server.requests) == 2 * len({question.text for question in questions})
