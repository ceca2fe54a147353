"""English verbs: forms that a reader would miss if they were wrong, and laws between them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.drafting.forms import NOUNS, Form, ing, is_verb, participle, past, third, verb_form
from tpvqa.drafting.lexicon import IRREGULAR, REGULAR
from tpvqa.drafting.names import spelled, words_of


@pytest.mark.parametrize(
    ("base", "forms"),
    [
        ("carry", "carries carrying carried carried"),
        ("put", "puts putting put put"),
        ("lie", "lies lying lay lain"),
        ("take", "takes taking took taken"),
        ("stack", "stacks stacking stacked stacked"),
        ("wash", "washes washing washed washed"),
        ("unplug", "unplugs unplugging unplugged unplugged"),
        ("drop", "drops dropping dropped dropped"),
        ("open", "opens opening opened opened"),
        ("fix", "fixes fixing fixed fixed"),
        ("tie", "ties tying tied tied"),
        ("drive", "drives driving drove driven"),
        ("ring", "rings ringing rang rung"),
        ("transfer", "transfers transferring transferred transferred"),
        ("equip", "equips equipping equipped equipped"),
        ("override", "overrides overriding overrode overridden"),
    ],
)
def test_verbs_go_as_in_a_grammar(base: str, forms: str) -> None:
    assert [third(base), ing(base), past(base), participle(base)] == forms.split()


@given(st.sampled_from(sorted(REGULAR | set(IRREGULAR))))
def test_every_form_leads_back_to_its_verb(base: str) -> None:
    for form in (base, third(base), ing(base), participle(base)):
        if form in NOUNS:
            continue
        found = verb_form(form)
        assert found is not None
        assert found[0] == base or is_verb(form) or form in (participle(found[0]), past(found[0]))


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("switchedOn", "switched on"),
        ("handempty", "hand empty"),
        ("handsFree", "hands free"),
        ("ontable", "on table"),
        ("isOpen", "is open"),
        ("toggled-on", "toggled on"),
        ("plate2", "plate 2"),
        ("pickup-person", "pick up person"),
        ("island", "island"),
        ("cabinet", "cabinet"),
        ("contaminated", "contaminated"),
        ("unloading", "unloading"),
    ],
)
def test_names_are_taken_apart_as_they_are_read(name: str, words: str) -> None:
    assert " ".join(words_of(name)) == words


def test_a_name_keeps_the_capitals_that_its_author_gave_it() -> None:
    text = "(:predicates (inHandOf ?x) (isOpen ?x) (inHand ?x))"
    assert spelled("inhand", text) == "inHand"
    assert spelled("elsewhere", text) == "elsewhere"


def test_forms_are_told() -> None:
    assert verb_form("carries") == ("carry", Form.THIRD)
    assert verb_form("lit") == ("light", Form.PARTICIPLE)
    assert verb_form("table") is None
