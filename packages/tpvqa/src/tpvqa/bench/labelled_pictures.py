"""Answers beside the truth, from pictures whose facts are known."""

from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from pathlib import Path

from tpvqa.belief import LabelledAnswer
from tpvqa.errors import CalibrationError
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Atom, Literal, State, Task, load_task
from tpvqa.questions import FactQuestion, QuestionBook, Way
from tpvqa.tasks import shipped_tasks
from tpvqa.vlm import VLM
from tpvqa.vlm.sight import ask_seeing
from tpvqa.worlds.pictures import VIEW, Picture, PictureSet, media_type
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
        asked = [each for each in questions if hidden or shows(picture, each[0])]
        rows += _ask(vlm, pictures, picture, look, asked)
        done()
    return rows


def questions_about(
    pictures: PictureSet[P],
    books: Sequence[QuestionBook] | None = None,
    *,
    in_all_words: bool = False,
) -> list[tuple[FactQuestion, Task]]:
    """Every question about the facts of a set, once, each with a task that it is of.

    Args:
        pictures: The set.
        books: The questions; by default those of the shipped tasks of the set's domain.
        in_all_words: Whether to ask in every wording that a file gives, and not in the first alone.

    Raises:
        CalibrationError: The set knows no fact that there is a question about.
    """
    domain = pictures.manifest.domain
    books = shipped_books(domain) if books is None else books
    found = list(_questions(pictures, books, in_all_words=in_all_words))
    if not found:
        names = ", ".join(repr(book.task.name) for book in books)
        asked = f"the problem {names}" if names else f"a shipped task of {domain!r}"
        raise CalibrationError(
            f"{pictures.folder}: no fact of this set, of the domain {domain!r}, is asked about in "
            f"{asked}. Name a set of that "
            "domain, your own --domain, --problem and --questions, or take episodes"
        )
    return found


def shipped_books(domain: str, questions: Path | None = None) -> list[QuestionBook]:
    """The questions of the shipped tasks of a domain; in other words, where a file gives them."""
    tasks = [(files, load_task(files.domain, files.problem)) for files in shipped_tasks()]
    return [
        QuestionBook.load(questions or files.questions, task)
        for files, task in tasks
        if task.domain_name == domain
    ]


def _questions(
    pictures: PictureSet[P], books: Sequence[QuestionBook], *, in_all_words: bool
) -> Iterator[tuple[FactQuestion, Task]]:
    """Every question about the set's facts, once."""
    facts = [Atom.parse(text) for text in pictures.facts]
    texts: set[str] = set()
    for book in books:
        task = book.task
        for atom in facts:
            known = atom.predicate in task.predicates and set(atom.arguments) <= set(task.objects)
            if not known or not book.asked(Literal(atom)):
                continue
            first = book.fact(Literal(atom))
            for each in (first, *(book.in_other_words(first) if in_all_words else ())):
                if each.text not in texts:
                    texts.add(each.text)
                    yield each, task


def shows(picture: P, question: FactQuestion) -> bool:
    """Whether a picture shows what the right answer is."""
    return any(atom.pddl() in picture.seen for atom in question.atoms)


def yes_is_right(question: FactQuestion, picture: Picture, task: Task) -> bool:
    """Whether yes is the right answer to a question about a picture.

    Facts that follow by axioms need not be said of it, nor those that no action changes.
    """
    true = _extended(picture, task) if task.derived else picture.true_state
    return question.true_in(true.__contains__)


@lru_cache(maxsize=4096)
def _extended(picture: Picture, task: Task) -> State:
    static = frozenset(atom for atom in task.init if atom.predicate not in task.fluents)
    stated = {atom for atom in picture.true_state if atom.predicate not in task.derived}
    return task.extend(static | stated)


def look_at(pictures: PictureSet[P], picture: P, look: int) -> Observation:
    """A look at a picture of a set.

    Raises:
        TpvqaError: It cannot be read.
    """
    frame = Frame(
        id=picture.file.rpartition(".")[0],
        view=VIEW,
        data=pictures.read(picture),
        media_type=media_type(picture.file),
        source=picture.file,
    )
    return Observation(look, 0.0, {VIEW: frame})


def _ask(
    vlm: VLM,
    pictures: PictureSet[P],
    picture: P,
    look: int,
    asked: list[tuple[FactQuestion, Task]],
) -> Iterator[LabelledAnswer]:
    seen = look_at(pictures, picture, look)
    answers = ask_seeing(vlm, seen, [question for question, _ in asked])
    for (question, task), answer in zip(asked, answers, strict=True):
        for way in (Way.PRECONDITION, Way.EFFECT):
            yield LabelledAnswer(
                way=way,
                predicate=question.subject,
                text=question.text,
                truth=yes_is_right(question, picture, task),
                reply=answer.reply,
                p_yes=answer.p_yes,
                trial=picture.scene,
                look=look,
                view=VIEW,
            )
