"""Sentences with placeholders, articles, and readable words for bare names."""

import doctest
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.questions import fallback
from tpvqa.questions.template import Placeholder, Template, indefinite_article

NAMES = st.from_regex(r"[a-z][a-z0-9]{0,7}([_-][a-z0-9]{1,7}){0,3}", fullmatch=True)
PARAMETERS = st.lists(st.sampled_from(["x", "y", "where", "h", "z2"]), unique=True, max_size=4)


def fill(template: Template, **names: str) -> str:
    return template.render(
        lambda place: "" if place.attribute == "article" else names[place.parameter]
    )


@pytest.mark.parametrize(
    ("name", "article"),
    [
        ("apple", "an"), ("plate", "a"), ("egg", "an"), ("unicorn", "a"), ("utensil", "a"),
        ("umbrella", "an"), ("hour glass", "an"), ("TV", "a"), ("LED lamp", "an"),
        ("USB stick", "a"), ("MP3 player", "an"), ("one-way sign", "a"), ("onion", "an"),
        ("european plug", "a"), ("8 plates", "a"), ("", "a"), ("Apple", "an"),
    ],
)  # fmt: skip
def test_the_article_follows_the_sound(name: str, article: str) -> None:
    assert indefinite_article(name) == article


def test_an_article_before_a_placeholder_agrees_whatever_was_written() -> None:
    for text in ("Is there a {x} here?", "Is there an {x} here?"):
        template = Template.parse(text)
        assert fill(template, x="apple") == "Is there an apple here?"
        assert fill(template, x="plate") == "Is there a plate here?"
    assert fill(Template.parse("A {x} or aa {x}, {x}?"), x="egg") == "An egg or aa egg, egg?"


def test_a_name_that_ends_in_a_is_no_article() -> None:
    assert fill(Template.parse("Is {x} {y}?"), x="bag A", y="under it") == "Is bag A under it?"
    assert fill(Template.parse("{x} a {y}, {x}a {y}"), x="bag A", y="egg") == (
        "bag A an egg, bag Aa egg"
    )


def test_braces_can_be_written_and_white_space_is_evened_out() -> None:
    template = Template.parse("  Is {{it}}\n  {?X.Place}? ")
    assert template.render(str) == "Is {it} {x.place}?"
    assert Template.parse(str(template)) == template


@given(st.lists(st.text("ab {}.é?", min_size=1) | st.builds(Placeholder, NAMES, NAMES), max_size=5))
def test_a_template_is_read_back_as_it_is_written(parts: list[str | Placeholder]) -> None:
    template = Template.parse(str(Template(tuple(parts))))
    assert Template.parse(str(template)) == template


def test_the_examples_in_the_documentation() -> None:
    assert doctest.testmod(fallback).failed == 0


@pytest.mark.parametrize(
    ("predicate", "parameters", "question"),
    [
        ("handempty", [], "Is it true: hand empty?"),
        ("clean", ["x"], "Is the {x} clean?"),
        ("is_open", ["x"], "Is the {x} open?"),
        ("can_fly", ["x"], "Can the {x} fly?"),
        ("has_lid", ["x"], "Does the {x} have a lid?"),
        ("has", ["x", "y"], "Does the {x} have the {y}?"),
        ("contains", ["x", "y"], "Does the {x} contain the {y}?"),
        ("on", ["x", "y"], "Is the {x} on the {y}?"),
        ("next-to", ["x", "y"], "Is the {x} next to the {y}?"),
        ("in_hand", ["x", "h"], "Is the {x} in hand ({h})?"),
        ("holding", ["x", "y"], "Is the {x} holding the {y}?"),
        ("connected", ["x", "y"], "Is the {x} connected to the {y}?"),
        ("heavier", ["x", "y"], "Is the {x} heavier than the {y}?"),
        ("stacked_on", ["x", "y", "h"], "Is the {x} stacked on the {y} ({h})?"),
    ],
)
def test_bare_predicates_are_readable(predicate: str, parameters: list[str], question: str) -> None:
    assert fallback.question_about(predicate, parameters) == question


@pytest.mark.parametrize(
    ("action", "parameters", "said", "done"),
    [
        ("pick_up", ["x"], "pick up the {x}", "picked up the {x}"),
        ("pickup", ["x"], "pick up the {x}", "picked up the {x}"),
        ("place_on", ["x", "y"], "place the {x} on the {y}", "placed the {x} on the {y}"),
        ("cut", ["x"], "cut the {x}", "cut the {x}"),
        ("stop", [], "stop", "stopped"),
        ("open", ["x"], "open the {x}", "opened the {x}"),
        ("carry", ["x", "y"], "carry the {x} ({y})", "carried the {x} ({y})"),
        ("go-to", ["x"], "go to the {x}", "went to the {x}"),
        ("play", ["x"], "play the {x}", "played the {x}"),
        ("fix", ["x"], "fix the {x}", "fixed the {x}"),
    ],
)
def test_bare_actions_are_readable(
    action: str, parameters: list[str], said: str, done: str
) -> None:
    assert fallback.say(action, parameters) == said
    assert fallback.past(said) == done


@given(NAMES, PARAMETERS)
def test_a_fallback_names_every_argument_once(name: str, parameters: list[str]) -> None:
    for text in (
        fallback.question_about(name, parameters),
        fallback.say(name, parameters),
        fallback.past(fallback.say(name, parameters)),
    ):
        found = [place.parameter for place in Template.parse(text).placeholders()]
        assert sorted(found) == sorted(parameters)
    question = fallback.question_about(name, parameters)
    assert question.endswith("?")
    assert "_" not in question
    assert re.match(r"(Is|Does|Can) ", question)


@given(NAMES)
def test_words_keep_every_letter_of_a_name(name: str) -> None:
    words = fallback.words_of(name)
    assert words.replace(" ", "") == re.sub(r"[_-]", "", name)
