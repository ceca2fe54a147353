"""Examples from a set of labelled pictures."""

from collections.abc import Iterator, Sequence

from tpvqa.bench.labelled_pictures import questions_about, shows, yes_is_right
from tpvqa.questions import QuestionBook
from tpvqa.training.example import Example
from tpvqa.worlds.pictures import PictureSet, media_type
from tpvqa.worlds.pictures.manifest import P


def examples_of(
    pictures: PictureSet[P], books: Sequence[QuestionBook] | None = None
) -> Iterator[Example]:
    """Every question about every picture that shows its answer.

    Args:
        pictures: The set.
        books: The questions; by default those of the shipped tasks of the set's domain.

    Raises:
        CalibrationError: The set knows no fact that there is a question about.
        PictureSetError: A picture cannot be read.
    """
    questions = questions_about(pictures, books)
    for picture in pictures.manifest.pictures:
        data = pictures.read(picture)
        for question, task in questions:
            if shows(picture, question):
                yield Example(
                    data,
                    media_type(picture.file),
                    question.text,
                    yes_is_right(question, picture, task),
                    question.subject,
                    picture.group,
                )
