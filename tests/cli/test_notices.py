"""What a user is told before a trial."""

from tpvqa.belief.calibrating.fitting import fit
from tpvqa.belief.calibrating.labelled_answer import LabelledAnswer
from tpvqa.cli.notices import about_calibration
from tpvqa.pddl import task_from_text
from tpvqa.questions import Way
from tpvqa.vlm import Reply

TASK = task_from_text(
    """(define (domain d) (:predicates (lit ?x) (told ?x))
      (:action switch :parameters (?x) :precondition (and) :effect (lit ?x)))""",
    "(define (problem p) (:domain d) (:objects lamp) (:init) (:goal (lit lamp)))",
)


def of(predicate: str) -> list[LabelledAnswer]:
    return [
        LabelledAnswer(
            way=Way.EFFECT,
            predicate=predicate,
            text="Is it so?",
            truth=n % 2 == 0,
            reply=Reply.YES if n % 2 == 0 else Reply.NO,
            p_yes=None,
            trial=str(n),
            look=n,
            view=None,
        )
        for n in range(40)
    ]


def test_a_calibration_of_another_domain_is_told() -> None:
    (notice,) = about_calibration("v", fit(of("open"), "v"), TASK)
    assert "another domain (open" in notice
    for known in ("lit", "switch"):  # a fact, and an action that was asked about
        assert about_calibration("v", fit(of(known), "v"), TASK) == []
    assert len(about_calibration("w", fit(of("lit"), "v"), TASK)) == 1
