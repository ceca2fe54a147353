"""Answers beside the truth, from pictures whose facts are known."""

from collections.abc import Callable, Iterator, Sequence

from tpvqa.belief import LabelledAnswer
from tpvqa.errors import CalibrationError
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Atom, Literal, load_task
from tpvqa.questions import FactQuestion, QuestionBook, Way
from tpvqa.tasks import shipped_tasks
from tpvqa.vlm import VLM
from tpvqa.vlm.sight import ask_seeing
from tpvqa.worlds.pictures import VIEW, PictureSet, media_type
from tpvqa.worlds.pictures.manifest import P


def ask_pictures(
    vlm: VLM,
    pictures: PictureSet[P],
    books: Sequence[QuestionBook] | None = None,
    *,
    hidden: bool = False,
    done: Callable[[], None] = lambda: None,
) -> list[LabelledAnswer]:
    """Ask everything about every picture that it shows.

    A question is asked once, and its answer counts as one to a precondition and as one to an
    effect: both are asked in the same words. Pictures that look alike are the looks of one trial,
    as a world draws them.

    Args:
        vlm: Who answers.
        pictures: The set.
        books: The questions; by default those of the shipped tasks of the set's domain.
        hidden: Whether to ask about what a picture does not show, too. A robot mostly looks at
            what it asks about, so answers about the rest are seldom what it will hear: on a
            picture of a plate on the table there is a table, though the robot is near the plate.
        done: Called after each picture.

    Raises:
        CalibrationError: The set knows no fact that there is a question about.
        TpvqaError: A picture cannot be read, or the VLM not be asked.
    """
    questions = questions_about(pictures, books)
    rows: list[LabelledAnswer] = []
    for look, picture in enumerate(pictures.manifest.pictures):
        asked = [each for each in questions if hidden or shows(picture, each)]
        rows += _ask(vlm, pictures, picture, look, asked)
        done()
    return rows


def questions_about(
    pictures: PictureSet[P], books: Sequence[QuestionBook] | None = None
) -> list[FactQuestion]:
    """Every question about the facts of a set, once.

    Args:
        pictures: The set.
        books: The questions; by default those of the shipped tasks of the set's domain.

    Raises:
        CalibrationError: The set knows no fact that there is a question about.
    """
    domain = pictures.manifest.domain
    books = list(_shipped(domain)) if books is None else books
    questions = list(_questions(pictures, books))
    if not questions:
        names = ", ".join(book.task.name for book in books) or f"a shipped task of {domain!r}"
        raise CalibrationError(
            f"{pictures.folder}: no fact of this set is asked about in {names}. Name a set of that "
            "domain, your own --domain, --problem and --questions, or take episodes"
        )
    return questions


def _shipped(domain: str) -> Iterator[QuestionBook]:
    """The questions of the shipped tasks of a domain."""
    for files in shipped_tasks():
        task = load_task(files.domain, files.problem)
        if task.domain_name == domain:
            yield QuestionBook.load(files.questions, task)


def _questions(pictures: PictureSet[P], books: Sequence[QuestionBook]) -> Iterator[FactQuestion]:
    """Every question about the set's facts, once."""
    facts = [Atom.parse(text) for text in pictures.facts]
    texts: set[str] = set()
    for book in books:
        task = book.task
        for atom in facts:
            known = atom.predicate in task.predicates and set(atom.arguments) <= set(task.objects)
            if not known or not book.asked(Literal(atom)):
                continue
            text = book.fact(Literal(atom)).text
            if text not in texts:
                texts.add(text)
                yield book.fact(Literal(atom))


def shows(picture: P, question: FactQuestion) -> bool:
    """Whether a picture tells the answer to a question."""
    return any(atom.pddl() in picture.seen for atom in question.atoms)


def _ask(
    vlm: VLM, pictures: PictureSet[P], picture: P, look: int, questions: list[FactQuestion]
) -> Iterator[LabelledAnswer]:
    frame = Frame(
        id=picture.file.rpartition(".")[0],
        view=VIEW,
        data=pictures.read(picture),
        media_type=media_type(picture.file),
        source=picture.file,
    )
    true = picture.true_state
    for question, answer in zip(
        questions, ask_seeing(vlm, Observation(look, 0.0, {VIEW: frame}), questions), strict=True
    ):
        for way in (Way.PRECONDITION, Way.EFFECT):
            yield LabelledAnswer(
                way=way,
                predicate=question.subject,
                text=question.text,
                truth=question.true_in(true.__contains__),
                reply=answer.reply,
                p_yes=answer.p_yes,
                trial=picture.scene,
                look=look,
                view=VIEW,
            )
