"""Places that a predicate names: said with what is there, or marked, never as a part of it."""

import re
from itertools import product

import pytest

from tests.drafting.test_what_names_ask import drafted
from tpvqa.drafting import LOOK

ASKED = {
    "(pot-in-lift ?p - pot)": "Is the {p} in the lift?",
    "(pot-on-left ?p - pot)": "Is the {p} on the left?",
    "(pot-on-fire ?p - pot)": "Is the {p} on fire?",
    "(pot-in-hand ?p - pot)": "Is the {p} in the robot's hand?",
    "(in-lift ?v - visitor)": "Is {v.the} in the lift?",
    "(bot-inside-lift)": "Is the bot inside the lift?",
    "(lid-on-hook)": "Is the lid on the hook?",
    "(bot-near-shelf-b)": "Is the bot near shelf b?",
    "(bot-on-duty)": "Is the bot on duty?",
    "(bot-in-water)": "Is the bot in water?",
}
PLACED = ("in", "on", "out of", "next to", "inside")


def asked_of(predicates: list[str]) -> tuple[dict[str, list[str]], str]:
    """The questions about predicates that actions bring about, and all of the draft."""
    actions = []
    for number, each in enumerate(predicates):
        name, *rest = each.strip("()").split()
        heads = " ".join(word for word in rest if word.startswith("?"))
        actions.append(f"do{number}|{' '.join(rest)}|({name} {heads})")
    asked, _, text = drafted(" ".join(predicates), *actions)
    return asked, text


@pytest.mark.parametrize("predicate", ASKED)
def test_who_is_there_is_said_first_and_the_place_with_an_article(predicate: str) -> None:
    asked, text = asked_of([predicate])
    (wordings,) = asked.values()
    assert wordings[0] == ASKED[predicate]
    assert LOOK not in text.partition("predicates:")[2].partition("actions:")[0]


def test_what_is_no_thing_is_never_said_to_be_of_one() -> None:
    names = [
        f"{who}-{where.replace(' ', '-')}-{what}"
        for who, where, what in product(("pot", "key", "pot-lid"), PLACED, ("lift", "door-locked"))
    ]
    asked, text = asked_of([f"({name} ?p - pot)" for name in names])
    for wordings in asked.values():
        for each in wordings:
            assert not re.search(r"\b(?:in|on|out|of|next|to|inside) of (?:the )?{", each), each
    assert f'key-in-door-locked: "Is the {{p}} key in door locked?"   # {LOOK}' in text
