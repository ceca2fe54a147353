"""Facts in the words of their questions, whatever these begin with."""

from pathlib import Path

import pytest

from tpvqa.pddl import Atom, Literal, task_from_text
from tpvqa.questions import FactWords, QuestionBook

DOMAIN = """(define (domain stage) (:requirements :typing) (:types lamp bar)
  (:predicates (hung ?l - lamp ?b - bar) (ready ?l - lamp))
  (:action hang :parameters (?l - lamp ?b - bar) :precondition (ready ?l)
    :effect (and (hung ?l ?b) (not (ready ?l)))))"""
PROBLEM = """(define (problem p) (:domain stage) (:objects spot - lamp front_bar - bar)
  (:init (ready spot)) (:goal (hung spot front_bar)))"""


@pytest.mark.parametrize(
    ("question", "said"),
    [
        ("Is the {l} on the {b}?", "spot on the front bar"),
        ("Does the {l} hang on the {b}?", "spot hangs on the front bar"),
        ("Does the {b} carry the {l}?", "front bar carries the spot"),
        ("Has the {l} been hung on the {b}?", "spot hung on the front bar"),
        ("Can the {l} be seen on the {b}?", "spot can be seen on the front bar"),
        ("Has the robot tied the {l} to the {b}?", "robot has tied the spot to the front bar"),
        ('["Do you see it: {l}, {b}?", "Is the {l} up on the {b}?"]', "spot up on the front bar"),
        ("Do you see the {l} on the {b}?", "hung(spot, front_bar)"),
    ],
)
def test_a_fact_is_said_as_it_is_asked_about(question: str, said: str, tmp_path: Path) -> None:
    task = task_from_text(DOMAIN, PROBLEM)
    file = tmp_path / "questions.yaml"
    asked = question if question.startswith("[") else f'"{question}"'
    file.write_text(f"predicates:\n  hung: {asked}\n")
    words = FactWords(QuestionBook.load(file, task))
    assert words.of(Atom("hung", ("spot", "front_bar"))) == said


def test_what_is_never_asked_keeps_the_words_of_its_question(tmp_path: Path) -> None:
    task = task_from_text(
        DOMAIN.replace("hung", "cablesTied"), PROBLEM.replace("hung", "cablestied")
    )
    never = 'never_asked:\n  - fact: "(cablesTied ?l ?b)"\n'
    file = tmp_path / "questions.yaml"
    file.write_text(f'predicates:\n  cablesTied: "Are the cables of {{l}} tied to {{b}}?"\n{never}')
    book = QuestionBook.load(file, task)
    tied = Atom("cablestied", ("spot", "front_bar"))
    assert not book.asked(Literal(tied))
    assert FactWords(book).of(tied) == "cables of spot tied to front bar"
