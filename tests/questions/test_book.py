"""Asking about other domains: conditional effects, the same words twice, names, fallbacks."""

from pathlib import Path

import pytest

from tpvqa.errors import QuestionsError
from tpvqa.pddl import Action, Atom, Literal, Task, load_task
from tpvqa.questions import QuestionBook, Way

DOMAIN = """
(define (domain lamps)
  (:requirements :typing :conditional-effects :derived-predicates :disjunctive-preconditions)
  (:types lamp room - object  desk_lamp - lamp)
  (:constants hall - room)
  (:predicates (lit ?l - lamp) (in ?l - lamp ?r - room) (dark ?r - room) (power)
               (held ?l - lamp ?side - object) (connected ?a ?b - room))
  (:derived (dark ?r - room) (forall (?l - lamp) (or (not (in ?l ?r)) (not (lit ?l)))))
  (:action switch
    :parameters (?l - lamp ?r - room)
    :precondition (and (in ?l ?r) (dark ?r) (in ?l ?r))
    :effect (and (when (power) (lit ?l)) (when (not (power)) (not (lit ?l)))))
  (:action carry
    :parameters (?l - lamp ?from ?to - room)
    :precondition (or (power) (lit ?l))
    :effect (and (not (in ?l ?from)) (in ?l ?to)))
  (:action startle
    :parameters (?l - lamp ?r - room)
    :effect (when (dark ?r) (lit ?l)))
  (:action regrip
    :parameters (?l - lamp ?a ?b - room)
    :effect (and (not (held ?l ?a)) (held ?l ?b) (lit ?l))))
"""
PROBLEM = """
(define (problem evening) (:domain lamps)
  (:objects big_lamp - lamp  desk1 - desk_lamp  kitchen_2 - room)
  (:init (in big_lamp hall) (in desk1 hall) (power))
  (:goal (and (lit big_lamp))))
"""


@pytest.fixture(scope="module")
def task(tmp_path_factory: pytest.TempPathFactory) -> Task:
    folder = tmp_path_factory.mktemp("lamps")
    (folder / "domain.pddl").write_text(DOMAIN)
    (folder / "problem.pddl").write_text(PROBLEM)
    return load_task(folder / "domain.pddl", folder / "problem.pddl")


def book_of(task: Task, folder: Path, text: str) -> QuestionBook:
    path = folder / "questions.yaml"
    path.write_text(text)
    return QuestionBook.load(path, task)


def test_conditional_effects_are_asked_where_their_condition_holds_before(task: Task) -> None:
    book = QuestionBook.load(None, task)
    switch = task.action("switch", ["big_lamp", "hall"])
    on = book.effects(switch, task.init)
    off = book.effects(switch, task.init - {Atom("power")})
    assert [(each.text, each.expected) for each in on] == [("Is the big lamp lit?", True)]
    assert [(each.text, each.expected) for each in off] == [("Is the big lamp lit?", False)]


def test_a_condition_of_an_effect_may_be_a_derived_fact(task: Task) -> None:
    book = QuestionBook.load(None, task)
    startle = task.action("startle", ["desk1", "hall"])
    assert [each.text for each in book.effects(startle, task.init)] == ["Is the desk 1 lit?"]
    light = {Atom("lit", ("desk1",)), Atom("lit", ("big_lamp",))}
    assert book.effects(startle, task.init | light) == ()


def test_derived_facts_are_asked_and_nothing_twice(task: Task) -> None:
    questions = QuestionBook.load(None, task).preconditions(
        task.action("switch", ["big_lamp", "hall"]), task.init
    )
    assert [each.text for each in questions] == [
        "Is the big lamp in the hall?",
        "Is the hall dark?",
    ]
    assert {each.way for each in questions} == {Way.PRECONDITION}


def test_of_a_disjunction_the_parts_that_hold_are_asked_and_all_where_none_does(
    task: Task, tmp_path: Path
) -> None:
    book = book_of(task, tmp_path, "in_doubt: [(power)]")
    carry = task.action("carry", ["big_lamp", "hall", "kitchen_2"])
    assert [each.text for each in book.preconditions(carry, task.init)] == ["Is it true: power?"]
    dark = book.preconditions(carry, task.init - {Atom("power")})
    assert [each.text for each in dark] == ["Is it true: power?", "Is the big lamp lit?"]


def test_what_no_action_changes_is_not_asked_unless_the_file_doubts_it(
    task: Task, tmp_path: Path
) -> None:
    carry = task.action("carry", ["big_lamp", "hall", "kitchen_2"])
    book = QuestionBook.load(None, task)
    assert book.why_not(Literal(Atom("power"))) == "no action changes it"
    # that there is power is enough for the disjunction, whatever is lit
    assert book.preconditions(carry, task.init) == ()
    doubting = book_of(task, tmp_path, "in_doubt: ['(connected hall ?r)']")
    assert doubting.asked(Literal(Atom("connected", ("hall", "kitchen_2"))))
    assert not doubting.asked(Literal(Atom("connected", ("kitchen_2", "hall"))))
    with pytest.raises(QuestionsError, match=r"questions.yaml:1: .*no predicate 'powr'"):
        book_of(task, tmp_path, "in_doubt: [(powr)]")


def test_a_file_says_what_a_picture_may_show_though_it_holds_no_more(
    task: Task, tmp_path: Path
) -> None:
    book = book_of(task, tmp_path, "still_shown: ['(lit ?l)']")
    lit, power = Literal(Atom("lit", ("big_lamp",))), Literal(Atom("power"))
    assert book.fact(lit).still_shown
    assert not book.fact(power).still_shown
    assert not QuestionBook.load(None, task).fact(lit).still_shown
    with pytest.raises(QuestionsError, match=r"questions.yaml:1: .*no predicate 'powr'"):
        book_of(task, tmp_path, "still_shown: [(powr)]")
    with pytest.raises(QuestionsError, match=r"questions.yaml:1: .*without 'not'"):
        book_of(task, tmp_path, "still_shown: ['(not (lit ?l))']")


def test_a_fact_of_objects_that_no_action_is_for_is_not_asked(tmp_path: Path) -> None:
    (tmp_path / "d.pddl").write_text(
        """(define (domain d) (:requirements :typing) (:types item place)
          (:predicates (on ?x ?y))
          (:action move :parameters (?i - item ?f ?t - place)
            :precondition (on ?i ?f) :effect (and (on ?i ?t) (not (on ?i ?f)))))"""
    )
    (tmp_path / "p.pddl").write_text(
        """(define (problem p) (:domain d) (:objects cup - item shelf floor - place)
          (:init (on cup shelf) (on shelf floor)) (:goal (on cup floor)))"""
    )
    book = QuestionBook.load(None, load_task(tmp_path / "d.pddl", tmp_path / "p.pddl"))
    assert book.asked(Literal(Atom("on", ("cup", "floor"))))
    assert not book.asked(Literal(Atom("on", ("shelf", "floor"))))


def test_what_is_deleted_and_added_at_once_holds_and_is_asked_so(task: Task) -> None:
    stay = task.action("carry", ["big_lamp", "hall", "hall"])
    questions = QuestionBook.load(None, task).effects(stay, task.init)
    assert [(each.text, each.expected) for each in questions] == [
        ("Is the big lamp in the hall?", True)
    ]


def test_the_same_words_for_opposite_answers_are_not_asked_but_reported_once(
    task: Task, tmp_path: Path
) -> None:
    book = book_of(task, tmp_path, "predicates: {held: 'Is the {l} held?'}")
    notices = len(book.notices)
    regrip = task.action("regrip", ["big_lamp", "hall", "kitchen_2"])
    for _ in range(2):
        assert [each.text for each in book.effects(regrip, task.init)] == ["Is the big lamp lit?"]
    assert len(book.notices) == notices + 1
    assert "opposite answers" in book.notices[-1]


def test_names_come_from_object_then_type_then_wider_type_then_default(
    task: Task, tmp_path: Path
) -> None:
    book = book_of(
        task,
        tmp_path,
        """
        attributes: {state: "the {name} shines", article: a}
        types:
          lamp: {state: "the {name} glows", name: lamp}
          desk_lamp: {state: "the {name} beams"}
        objects:
          big_lamp: {name: Big  Lamp, article: one}
          hall: entrance hall
        predicates:
          lit: "Is it so that {l.state}, a {l}?"
          in: "Is the {l} in a {r}?"
        """,
    )
    assert book.name("big_lamp") == "Big Lamp"
    assert book.name("desk1") == "lamp"
    assert book.name("hall") == "entrance hall"
    assert book.name("kitchen_2") == "kitchen 2"
    said = {obj: book.fact(Literal(Atom("lit", (obj,)))).text for obj in ("big_lamp", "desk1")}
    assert said == {
        "big_lamp": "Is it so that the Big Lamp glows, one Big Lamp?",
        "desk1": "Is it so that the lamp beams, a lamp?",
    }
    where = book.fact(Literal(Atom("in", ("desk1", "hall")))).text
    assert where == "Is the lamp in a entrance hall?"  # as the file asks for


def test_letter_case_and_the_truth_values_of_yaml_do_not_matter(task: Task, tmp_path: Path) -> None:
    book = book_of(task, tmp_path, "predicates:\n  LIT: 'Is the {L} on?'\nobjects: {Hall: Hall}")
    assert book.fact(Literal(Atom("lit", ("desk1",)))).text == "Is the desk 1 on?"
    assert book.name("hall") == "Hall"


def test_the_ways_of_asking_about_an_action_can_be_reworded(task: Task, tmp_path: Path) -> None:
    book = book_of(
        task,
        tmp_path,
        """
        ways: {did: "Has the robot managed to {action}?"}
        actions: {switch: {say: "switch on the {l} in the {r}"}}
        """,
    )
    switch = task.action("switch", ["desk1", "hall"])
    assert book.did(switch).text == "Has the robot managed to switch on the desk 1 in the hall?"
    assert book.done(switch) == "switched on the desk 1 in the hall"
    assert any("switch" in notice and "done" in notice for notice in book.notices)


def test_every_fallback_is_reported_once(task: Task, tmp_path: Path) -> None:
    bare = QuestionBook.load(None, task)
    constant = set(task.predicates) - task.fluents - task.derived  # nobody asks about them
    assert constant == {"power", "connected"}
    mentioned = [*set(task.predicates) - constant, "switch", "carry", "startle", "regrip"]
    for name in mentioned:
        assert sum(f" {name} " in notice or f" {name};" in notice for notice in bare.notices) == 1
    assert len(bare.notices) == len(mentioned)
    partly = book_of(
        task,
        tmp_path,
        """
        predicates: {lit: "Is the {l} on?"}
        never_asked: [{fact: (power), because: nobody sees a current}]
        """,
    )
    assert not any(" lit;" in notice or " power;" in notice for notice in partly.notices)


def test_never_asked_knows_types_constants_repeated_variables_and_actions(
    task: Task, tmp_path: Path
) -> None:
    book = book_of(
        task,
        tmp_path,
        """
        never_asked:
          - fact: (in ?l - desk_lamp ?r)
          - fact: (in ?lamp hall)
            in: [carry, switch]
          - fact: (held ?l ?side)
            in: carry
          - fact: (connected ?a ?a)
          - fact: (not (lit ?l))
        in_doubt:
          - (connected ?a ?b)
        """,
    )
    carry = task.action("carry", ["big_lamp", "hall", "kitchen_2"])

    def asked(text: str, action: Action | None = None) -> tuple[bool, bool]:
        literal = Literal(Atom.parse(text))
        return book.asked(literal, action), book.asked(literal.negate(), action)

    assert asked("(in desk1 kitchen_2)") == (False, False)
    assert asked("(in big_lamp hall)") == (True, True)
    assert asked("(in big_lamp hall)", carry) == (False, False)
    assert asked("(in big_lamp kitchen_2)", carry) == (True, True)
    assert asked("(held big_lamp hall)", carry) == (False, False)
    assert asked("(held desk1 hall)", carry) == (True, True)  # ?l is the lamp that is carried
    assert asked("(connected hall hall)") == (False, False)
    assert asked("(connected hall kitchen_2)") == (True, True)
    assert asked("(lit desk1)") == (True, False)


def test_an_object_that_this_problem_lacks_is_reported_not_refused(
    task: Task, tmp_path: Path
) -> None:
    book = book_of(task, tmp_path, "objects:\n  bigg_lamp: large lamp\n")
    notice = book.notices[0]
    assert "questions.yaml:2:" in notice
    assert "Did you mean 'big_lamp'" in notice


def test_an_empty_file_is_a_book_of_fallbacks(task: Task, tmp_path: Path) -> None:
    for text in ("", "# nothing yet\n", "---\n", "predicates:\nactions:\nnever_asked:\n"):
        assert book_of(task, tmp_path, text).notices == QuestionBook.load(None, task).notices
