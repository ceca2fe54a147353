"""What the right answer is, in the sense of the words."""

import itertools

import numpy as np
import pytest

from tests.household.training.household import facts, shows
from tpvqa.pddl import Atom
from tpvqa_household.kitchen.household import Household
from tpvqa_household.training.asking import Asking
from tpvqa_household.training.facts import FactTable
from tpvqa_household.training.labels import Label, Labels
from tpvqa_household.training.subjects import Subject

AT_HOME = {"plate": "table", "bread": "counter", "apple": "fridge", "knife": "counter"}
ASKING = Asking.about("clean_dishes")


def label(household: Household, things: tuple[str, ...], subject: Subject, *hidden: str) -> Label:
    shown = {**facts(household, hidden=hidden), **shows(*things)}
    return Label(int(Labels(FactTable.of([shown]), ASKING.actions).label(subject)[0]))


def at(near: str, *, without: tuple[str, ...] = (), **more: object) -> Household:
    where = {item: place for item, place in AT_HOME.items() if item not in without}
    return Household(near=near, where=where, **more)  # type: ignore[arg-type]


HELD = at("sink", without=("plate",), held={"left": "plate"})
FACT = "fact"


@pytest.mark.parametrize(
    ("household", "things", "subject", "expected"),
    [
        (HELD, ("sink", "plate"), Subject(FACT, "near", ("plate",)), Label.YES),
        (HELD, ("sink", "plate"), Subject(FACT, "near", ("table",)), Label.NO),
        (HELD, ("sink", "plate"), Subject(FACT, "in_hand", ("plate",)), Label.YES),
        (HELD, ("sink", "plate"), Subject(FACT, "in_hand", ("bread",)), Label.NO),
        (at("table"), ("table", "plate"), Subject(FACT, "in_hand", ("plate",)), Label.HARD_NO),
        (at("table"), ("table", "plate"), Subject(FACT, "on", ("plate", "sink")), Label.HARD_NO),
        (HELD, ("sink", "plate"), Subject("possible", "wash", ("plate",)), Label.YES),
        (HELD, ("plate",), Subject("possible", "wash", ("plate",)), Label.HARD_NO),
        (HELD, ("sink", "plate"), Subject("successful", "wash", ("plate",)), Label.HARD_NO),
        (HELD, ("sink", "plate"), Subject("did", "pick_up", ("plate",)), Label.YES),
        (HELD, ("sink", "plate"), Subject("did", "find", ("sink",)), Label.YES),
        (at("table"), ("table", "plate"), Subject("possible", "pick_up", ("plate",)), Label.YES),
        (at("fridge"), ("fridge",), Subject("possible", "find", ("apple",)), Label.NO),
        (at("fridge"), ("fridge",), Subject("possible", "find", ("plate",)), Label.YES),
        (at("fridge"), ("fridge",), Subject("possible", "open", ("fridge",)), Label.YES),
        (at("fridge"), ("fridge",), Subject("successful", "open", ("fridge",)), Label.NO),
    ],
    ids=str,
)
def test_a_subject_has_the_answer_that_its_words_have(
    household: Household, things: tuple[str, ...], subject: Subject, expected: Label
) -> None:
    assert label(household, things, subject) is expected


def test_one_visible_failure_is_no_and_one_hidden_part_is_cannot_see() -> None:
    both = at("table", without=("apple", "knife"), held={"left": "apple", "right": "knife"})
    cut = Subject("possible", "cut_in_half", ("apple",))
    hidden_knife = ("(in_hand knife left)", "(in_hand knife right)")
    assert label(both, ("apple", "knife"), cut) is Label.YES
    assert label(both, ("apple", "knife"), cut, *hidden_knife) is Label.CANNOT_SEE
    without_apple = at("table", without=("knife",), held={"right": "knife"})
    assert label(without_apple, ("knife",), cut, *hidden_knife) is Label.NO


def test_with_both_hands_full_nothing_can_be_picked_up() -> None:
    full = at("table", without=("apple", "knife"), held={"left": "apple", "right": "knife"})
    one = at("table", without=("apple",), held={"left": "apple"})
    pick = Subject("possible", "pick_up", ("plate",))
    things = ("table", "plate", "apple", "knife")
    assert label(full, things, pick) is Label.HARD_NO
    assert label(one, things, pick) is Label.YES


def test_a_thing_hardly_in_view_is_not_asked_about() -> None:
    shown = {**facts(at("table")), Atom("near", ("plate",)): (True, False)}
    labels = Labels(FactTable.of([shown]), ASKING.actions)
    assert labels.label(Subject(FACT, "near", ("plate",)))[0] == Label.UNCLEAR
    assert labels.label(Subject("did", "find", ("plate",)))[0] == Label.UNCLEAR


def test_asking_what_did_and_what_was_successful_has_one_answer() -> None:
    pictures = []
    for near, opened, clean in itertools.product(("table", "fridge"), (False, True), (False, True)):
        household = at(near, opened=opened, clean=clean)
        pictures.append({**facts(household), **shows(near)})
    labels = Labels(FactTable.of(pictures), ASKING.actions)
    for subject in ASKING.subjects:
        if subject.form == "did":
            other = Subject("successful", subject.name, subject.arguments)
            np.testing.assert_array_equal(labels.label(subject), labels.label(other))
