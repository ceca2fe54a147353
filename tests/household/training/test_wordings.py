"""Training asks what the package asks, and no words mean two things."""

import pytest

from tpvqa.pddl import Literal, load_task
from tpvqa.questions import QuestionBook, Way
from tpvqa.tasks import find_task
from tpvqa_household.training.asking import Asking
from tpvqa_household.training.subjects import ACTION_WAYS, Subject, action_subject, subject_of
from tpvqa_household.training.wordings import wordings

TASKS = ("clean_dishes", "serve_breakfast", "eat_apple")
ASKING = Asking.about("clean_dishes")


@pytest.fixture(scope="module", params=TASKS)
def book(request: pytest.FixtureRequest) -> QuestionBook:
    name = str(request.param)
    return QuestionBook.load(find_task(name).questions, load_task(name))


def first(subject: Subject) -> str:
    return next(iter(wordings(subject))).text


def test_the_questions_of_the_tasks_are_the_first_wordings(book: QuestionBook) -> None:
    for action in book.task.ground_actions():
        for way in ACTION_WAYS:
            question = getattr(book, str(way))(action)
            assert question.text == first(action_subject(way, action))
        for effect in action.effects:
            literal = Literal(effect.literal.atom)
            if book.asked(literal, action):
                subject = subject_of(literal.atom)
                asked = book.fact(literal, way=Way.EFFECT).text
                assert asked == first(subject)
                assert subject in ASKING.subjects


def test_every_wording_is_known_and_means_one_thing() -> None:
    meaning: dict[tuple[int, ...], tuple[Subject, bool]] = {}
    for subject in ASKING.subjects:
        for wording in wordings(subject):
            tokens = ASKING.lexicon.tokens(wording.text)
            assert isinstance(tokens, tuple), wording
            said = (subject, wording.inverted)
            assert meaning.setdefault(tokens, said) == said


def test_every_way_of_asking_has_several_wordings() -> None:
    for subject in ASKING.subjects:
        assert len({wording.text for wording in wordings(subject)}) >= 3
