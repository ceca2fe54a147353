"""Answers beside the truth, from pictures whose facts are known."""

from collections.abc import Callable, Iterator

from tpvqa.belief import LabelledAnswer
from tpvqa.errors import CalibrationError
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Atom, Literal, load_task
from tpvqa.questions import FactQuestion, QuestionBook, Way
from tpvqa.tasks import find_task
from tpvqa.vlm import VLM
from tpvqa.worlds.images.manifest import Picture, PictureSet
from tpvqa.worlds.images.shipped_tasks import TASKS
from tpvqa.worlds.images.world import VIEW


def ask_pictures(
    vlm: VLM,
    pictures: PictureSet,
    *,
    hidden: bool = False,
    done: Callable[[], None] = lambda: None,
) -> list[LabelledAnswer]:
    """Ask everything about every picture that it shows.

    A question is asked once, and its answer counts as one to a precondition and as one to an
    effect: both are asked in the same words. Pictures of the same visible state are the looks of
    one trial, as the images world draws them.

    Args:
        vlm: Who answers.
        pictures: The set.
        hidden: Whether to ask about what a picture does not show, too. A robot mostly looks at
            what it asks about, so answers about the rest are seldom what it will hear: on a
            picture of a plate on the table there is a table, though the robot is near the plate.
        done: Called after each picture.

    Raises:
        CalibrationError: The set knows no fact that is asked about in the shipped tasks.
        TpvqaError: A picture cannot be read, or the VLM not be asked.
    """
    questions = list(_questions(pictures))
    if not questions:
        raise CalibrationError(
            f"{pictures.folder}: no fact of this set is asked about in {', '.join(TASKS)}. "
            "Name a set of the household, or calibrate from episodes"
        )
    rows: list[LabelledAnswer] = []
    for look, picture in enumerate(pictures.manifest.pictures):
        asked = [each for each in questions if hidden or _shows(picture, each)]
        rows += _ask(vlm, pictures, picture, look, asked)
        done()
    return rows


def _questions(pictures: PictureSet) -> Iterator[FactQuestion]:
    """Every question about the set's facts, once."""
    facts = [Atom.parse(text) for text in pictures.manifest.facts]
    texts: set[str] = set()
    for name in TASKS:
        files = find_task(name)
        task = load_task(files.domain, files.problem)
        book = QuestionBook.load(files.questions, task)
        for atom in facts:
            known = atom.predicate in task.predicates and set(atom.arguments) <= set(task.objects)
            if not known or not book.asked(Literal(atom)):
                continue
            text = book.fact(Literal(atom)).text
            if text not in texts:
                texts.add(text)
                yield book.fact(Literal(atom))


def _shows(picture: Picture, question: FactQuestion) -> bool:
    return any(atom.pddl() in picture.seen for atom in question.atoms)


def _ask(
    vlm: VLM, pictures: PictureSet, picture: Picture, look: int, questions: list[FactQuestion]
) -> Iterator[LabelledAnswer]:
    frame = Frame(
        id=picture.file.rpartition(".")[0],
        view=VIEW,
        data=pictures.read(picture),
        source=picture.file,
    )
    true = picture.true_state
    for question, answer in zip(
        questions, vlm.ask(Observation(look, 0.0, {VIEW: frame}), questions), strict=True
    ):
        for way in (Way.PRECONDITION, Way.EFFECT):
            yield LabelledAnswer(
                way=way,
                predicate=question.subject,
                text=question.text,
                truth=question.true_in(true.__contains__),
                reply=answer.reply,
                p_yes=answer.p_yes,
                trial=picture.visible,
                look=look,
                view=VIEW,
            )
