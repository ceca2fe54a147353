"""Which questions the embedded network has words for."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa_household.embedded.lexicon import Lexicon, Unknown, words

LEXICON = Lexicon.of(
    [
        "Is the plate clean?",
        "Is there a plate in the image?",
        "Is the apple on the plate?",
        "Is the apple in the fridge?",
        "Is the plate in a robot's hand?",
        "Is it possible to open the fridge here?",
    ]
)


@pytest.mark.parametrize(
    "question",
    [
        "is THE plate clean",
        "Is a plate clean ?",
        "Is the plate clean now, please?",
        "plate clean?",
    ],
)
def test_case_punctuation_articles_and_fillers_do_not_matter(question: str) -> None:
    assert LEXICON.tokens(question) == LEXICON.tokens("Is the plate clean?")


@pytest.mark.parametrize(
    ("question", "why"),
    [
        ("Is there a milk carton in the image?", "no word for milk, carton"),
        ("Is the apple on the fridge?", "no such question"),
        ("Is the plate on the apple?", "no such question"),
        ("Is the fridge clean?", "no such question"),
        ("", "no such question"),
        ("¿?", "no such question"),
    ],
)
def test_what_training_did_not_ask_is_unknown(question: str, why: str) -> None:
    found = LEXICON.tokens(question)
    assert isinstance(found, Unknown)
    assert why in found.reason


def test_in_and_on_are_told_apart() -> None:
    lexicon = Lexicon.of(["Is the apple on the plate?", "Is the apple in the plate?"])
    assert lexicon.tokens("apple on plate") != lexicon.tokens("apple in plate")


def test_a_lexicon_survives_json() -> None:
    again = Lexicon.from_json(LEXICON.to_json())
    assert again == LEXICON
    assert again.tokens("Is the plate clean?") == LEXICON.tokens("Is the plate clean?")


@given(st.text())
def test_any_text_is_known_or_unknown_and_never_an_error(text: str) -> None:
    found = LEXICON.tokens(text)
    assert isinstance(found, Unknown) or all(found)


@given(st.lists(st.sampled_from(LEXICON.vocabulary), max_size=8))
def test_known_words_in_another_order_are_not_guessed(spoken: list[str]) -> None:
    found = LEXICON.tokens(" ".join(spoken))
    content = {w for w in spoken if w not in ("is", "there", "it", "to", "here", "of")}
    if not isinstance(found, Unknown):
        known = {tuple(words(q)) for q in LEXICON.questions}
        assert any(content <= set(question) for question in known)
