"""What is asked of every VLM: looks, and questions about them whose right answers are known."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from tpvqa.bench.labelled_pictures import look_at, questions_about, shows, yes_is_right
from tpvqa.observation import Observation
from tpvqa.questions import FactQuestion, Question, QuestionBook
from tpvqa.worlds.pictures import PictureSet
from tpvqa.worlds.pictures.manifest import P

OF_PICTURES = "pictures that show the same facts, true and false alike"
"""What makes a group of pictures: errors that last are the scene's, however often it is taken."""


@dataclass(frozen=True, slots=True)
class Labelled:
    """A question whose right answer is known.

    Attributes:
        question: What is asked.
        truth: Whether yes is right.
        fact: What is asked about, the same in all words: a fact or an action as PDDL.
        wording: Which words.
        scene: Tells true states apart: errors that last are the same there.
    """

    question: Question
    truth: bool
    fact: str
    wording: str
    scene: str


@dataclass(frozen=True, slots=True)
class LabelledLook:
    """A look and what is asked about it.

    Attributes:
        name: Tells it from others, for people.
        cluster: What hangs together: the same for looks that are not independent of each other.
        read: Gives the look, with its number.
        asked: The questions.
    """

    name: str
    cluster: str
    read: Callable[[int], Observation]
    asked: tuple[Labelled, ...]


def named(wording: str, question: Question) -> str:
    """What the words of a question are called, where a file gives it in several wordings.

    Args:
        wording: What those of the file are called.
        question: It.
    """
    number = question.wording if isinstance(question, FactQuestion) else 0
    return f"{wording}, wording {number + 1}" if number else wording


def looks_at_pictures(
    pictures: PictureSet[P],
    books: Mapping[str, Sequence[QuestionBook] | None],
    *,
    hidden: bool = False,
) -> list[LabelledLook]:
    """Every picture of a set, with the questions about the facts that it shows.

    Pictures that look alike hang together. What is asked is a fact; as a precondition and as an
    effect it is asked in the same words, so it is asked once.

    Args:
        pictures: The set.
        books: The questions by their wording; None for those of the shipped tasks.
        hidden: Whether to ask about what a picture does not show, too.

    Raises:
        CalibrationError: There is no question about a fact of the set.
    """
    asked = {
        name: questions_about(pictures, book, in_all_words=True) for name, book in books.items()
    }

    def of(picture: P) -> Iterator[Labelled]:
        for name, questions in asked.items():
            for each, task in questions:
                if hidden or shows(picture, each):
                    truth = yes_is_right(each, picture, task)
                    yield Labelled(each, truth, each.atom.pddl(), named(name, each), picture.scene)

    found = [
        LabelledLook(
            picture.file, picture.scene, partial(look_at, pictures, picture), tuple(of(picture))
        )
        for picture in pictures.manifest.pictures
    ]
    return [look for look in found if look.asked]
