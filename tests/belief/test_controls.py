"""Control questions: what is known is asked, as long as it matters whether answers are worth
anything."""

from dataclasses import replace
from random import Random

from hypothesis import given
from hypothesis import strategies as st

from tests.belief.test_belief import plan_of
from tpvqa.belief.answers.trust import Trust
from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.belief.costs import Costs
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.belief.weighing.controls import Controls, worth_asking
from tpvqa.belief.weighing.evidence import Evidence
from tpvqa.pddl import Literal, load_task
from tpvqa.questions import FactQuestion, FactWay, QuestionBook, Way
from tpvqa.tasks import find_task
from tpvqa.vlm import Answer, Reply

PRECONDITION: FactWay = Way.PRECONDITION


def asked(right: float, seed: int, *, still_shown: bool = False) -> tuple[Evidence, list[bool]]:
    """What control questions come to, at the start of a task, of answers right in so many cases;
    and to which of them yes was right."""
    files = find_task("serve_breakfast")
    task = load_task(files.domain, files.problem)
    book = QuestionBook.load(files.questions, task)
    belief = Belief(FaultModel(task))
    calibration = Calibration.default()
    evidence = Evidence(belief, calibration, Trust.after(calibration.rows))
    controls, random = Controls(evidence, Costs()), Random(seed)
    literals = {literal.atom for a in plan_of(task) for literal in _changed(a)}
    facts = [Literal(atom) for atom in sorted(literals) if book.asked(Literal(atom), None)]
    plain = [book.fact(fact, way=PRECONDITION) for fact in facts]
    questions = [replace(question, still_shown=still_shown) for question in plain]
    truths = list[bool]()

    def likely(question: FactQuestion) -> float:
        return belief.probability(question.atom, question.alike)

    for look in range(100):
        question = controls.next(questions, likely, lambda _: [None])
        if question is None:
            break
        truths.append(likely(question) > 0.5)
        says = truths[-1] == (random.random() < right)
        reply = Reply.YES if says else Reply.NO
        evidence.take(question, Answer(question, reply), look, None)
    return evidence, truths


def _changed(action: object) -> list[Literal]:
    return [effect.literal for effect in getattr(action, "effects")]  # noqa: B009


def test_answers_that_are_worth_nothing_are_suspected_before_anything_is_done() -> None:
    nothing = [asked(0.5, seed)[0].worth.nothing for seed in range(8)]
    good = [asked(0.95, seed)[0].worth.nothing for seed in range(8)]
    assert sum(nothing) / 8 > 5 * sum(good) / 8


def test_good_answers_are_soon_believed() -> None:
    assert all(len(asked(1.0, seed)[1]) <= 6 for seed in range(3))


def test_what_a_picture_may_still_show_is_not_asked_where_it_is_known_not_to_hold() -> None:
    assert set(asked(0.5, 0)[1]) == {True, False}
    assert set(asked(0.5, 0, still_shown=True)[1]) == {True}


def test_who_always_says_yes_is_asked_what_is_not_so() -> None:
    _, truths = asked(0.5, 1)
    assert abs(sum(truths) - (len(truths) - sum(truths))) <= 2


@given(st.floats(0, 0.003), st.floats(0.51, 0.99))
def test_what_is_settled_is_not_asked_about(nothing: float, right: float) -> None:
    assert not worth_asking(nothing, right, Costs())
    assert not worth_asking(1 - nothing, right, Costs())


def test_answers_that_are_hardly_better_than_nothing_are_not_told_from_it() -> None:
    assert worth_asking(0.1, 0.8, Costs())
    assert not worth_asking(0.1, 0.55, Costs())
