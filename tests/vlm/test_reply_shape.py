"""What counts as yes or no, on a thousand replies and on whatever hypothesis makes of them.

`replies.jsonl`, a line each: the shape, what it counts as, what was asked, and the reply's text.
"""

import json
import re
import time
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.vlm import Reply
from tpvqa.vlm.reply_shape import read_words

REPLIES = [
    json.loads(line)
    for line in (Path(__file__).parent / "replies.jsonl").read_text(encoding="utf-8").splitlines()
]
SHAPES = sorted({reply["shape"] for reply in REPLIES})
CLEAR = [reply for reply in REPLIES if reply["reply"] != "unknown"]
SIMPLE = [reply for reply in CLEAR if reply["shape"] != "after reasoning"]


@pytest.mark.parametrize("shape", SHAPES)
def test_a_thousand_replies_count_as_what_they_are(shape: str) -> None:
    wrong = {
        reply["text"]: found.value
        for reply in REPLIES
        if reply["shape"] == shape
        and (found := read_words(reply["text"], reply["question"])) != reply["reply"]
    }
    assert not wrong


def test_there_are_many_of_them() -> None:
    assert len(REPLIES) > 1000
    assert sum(reply["reply"] == "unknown" for reply in REPLIES) > 800


def test_without_the_question_nothing_is_taken_for_the_opposite() -> None:
    for reply in REPLIES:
        found = read_words(reply["text"])
        if reply["shape"] not in ("says the opposite", "says something else"):
            assert found in (reply["reply"], "unknown"), reply["text"]
    assert read_words("No, the fridge is closed.") is Reply.NO
    assert read_words("No, there is no plate.") is Reply.NO
    assert read_words("Yes. The plate is in the gripper.") is Reply.YES
    assert read_words("No, the image is empty.") is Reply.UNKNOWN


@pytest.mark.parametrize(
    ("question", "text"),
    [
        ("Is there a plate in the image?", "No, there is no image."),
        ("Is there a plate in the image?", "No, it is not an image."),
        ("Is there a plate in the image?", "Yes, there is an image."),
        ("Is the fridge open?", "No, there is no fridge."),
        ("Is the fridge open?", "Yes, there is a fridge."),
        ("Is the plate clean?", "No, there is no plate."),
        ("Is the apple in a robot's hand?", "No, there is no robot."),
    ],
)
def test_that_something_is_there_answers_no_other_question(question: str, text: str) -> None:
    assert read_words(text, question) is Reply.UNKNOWN


@pytest.mark.parametrize(
    ("question", "text"),
    [
        ("Is there a plate in the image?", "No, there is no plate."),
        ("Is there a plate in the image?", "No, there is no plate in the image."),
        ("Is there a plate in the image?", "No, it is not in the image."),
        ("Is the plate in the sink?", "No, there is no plate in the sink."),
        ("Does the table have a plate?", "No, it does not have a plate."),
    ],
)
def test_that_what_is_asked_is_not_there_is_no(question: str, text: str) -> None:
    assert read_words(text, question) is Reply.NO


@pytest.mark.parametrize(
    ("question", "text"),
    [
        ("Is the fridge open?", "No, the closed fridge is open"),
        ("Is the fridge open?", "No, the fridge is shut open."),
        ("Is the fridge open?", "No, the closed fridge is opened."),
        ("Is the plate clean?", "No, the dirty plate is clean."),
        ("Is the gripper holding the plate?", "No, the empty gripper is holding the plate."),
    ],
)
def test_a_word_beside_what_it_excludes_says_nothing(question: str, text: str) -> None:
    assert read_words(text, question) is Reply.UNKNOWN


@pytest.mark.parametrize(
    ("question", "text"),
    [
        ("Is the fridge open?", "No, the fridge is closed."),
        ("Is the fridge open?", "No, it is shut. It is closed."),
        ("Is the lamp on the table on?", "No, the lamp on the table is off."),
        ("Is the plate in the gripper?", "No, the gripper is empty."),
        ("Is the gripper holding the plate?", "No, the gripper is empty."),
        ("Is the open bottle full?", "No, the open bottle is empty."),
        ("Is the cup held by the robot full?", "No, the cup held by the robot is empty."),
        ("Is the fridge near the closed window shut?",
         "No, the fridge near the closed window is open."),
        ("Is the washed plate clean?", "No, the washed plate is dirty."),
        ("Is the cut apple halved?", "No, the cut apple is whole."),
    ],
)  # fmt: skip
def test_a_word_in_place_of_what_it_excludes_is_no(question: str, text: str) -> None:
    assert read_words(text, question) is Reply.NO


@pytest.mark.parametrize("question", ["", "?", "Ist die Tür auf?", "a" * 10_000, "Is\n\0it?", "1"])
def test_whatever_is_asked_the_word_alone_counts(question: str) -> None:
    assert read_words("Yes", question) is Reply.YES
    assert read_words("No.", question) is Reply.NO
    assert read_words("No, the fridge is closed.", question) is Reply.UNKNOWN


@given(st.sampled_from(CLEAR), st.text(" \n\t\r", max_size=5))
def test_white_space_around_it_changes_nothing(reply: dict[str, str], space: str) -> None:
    assert read_words(space + reply["text"] + space, reply["question"]) == reply["reply"]


@pytest.mark.parametrize(
    "way", ['"{}"', "“{}”", "«{}»", ' "{}"\n', "```\n{}\n```", "<answer>{}</answer>"]
)
def test_quotes_around_it_change_nothing(way: str) -> None:
    for reply in SIMPLE:
        if not re.search('["“”«`<]', reply["text"]):
            text = way.replace("{}", reply["text"])
            assert read_words(text, reply["question"]) == reply["reply"], text


@given(st.sampled_from(SIMPLE), st.sampled_from([str.upper, str.lower, str.title, str.swapcase]))
def test_case_changes_nothing(reply: dict[str, str], case: object) -> None:
    assert callable(case)
    text = case(reply["text"])
    if "’T" not in text and "'T" not in text and "’S" not in text:  # what `title` makes of "isn't"
        assert read_words(text, reply["question"]) == reply["reply"]


HEDGES = [
    "maybe", ", maybe", " (10% sure)", ", I think", "?", " but I am not sure", ", or not", " / ",
    ". Actually not.", " not", "...", " I cannot see it", ", probably", " 50%", "😀", ", no",
    ", yes",
    "\n\nNote: the picture is dark.", " However, it may be closed.", "\nyes\nno", "\x00", "\u200b",
]  # fmt: skip


@given(st.sampled_from(CLEAR), st.sampled_from(HEDGES) | st.text(max_size=30))
def test_what_is_added_never_makes_the_opposite_of_it(reply: dict[str, str], more: str) -> None:
    opposite = "no" if reply["reply"] == "yes" else "yes"
    if not re.search(r"</|answer", more, re.IGNORECASE):
        assert read_words(reply["text"] + more, reply["question"]) != opposite
        assert read_words(more + reply["text"], reply["question"]) != opposite


@given(st.sampled_from(SIMPLE), st.sampled_from(HEDGES))
def test_a_hedge_makes_it_unknown(reply: dict[str, str], hedge: str) -> None:
    bare = reply["text"].strip()
    if bare[-1] not in "\"'`”’*_}>»" + "." or len(hedge) > 3:
        assert read_words(bare + hedge, reply["question"]) is Reply.UNKNOWN


WORDS = st.sampled_from(
    [
        "yes",
        "no",
        "Yes",
        "No",
        "not",
        "the",
        "fridge",
        "is",
        "open",
        "closed",
        "maybe",
        "I",
        "it",
        "answer",
        ":",
        ",",
        ".",
        "!",
        "?",
        "\n",
        '"',
        "'",
        "*",
        "**",
        "`",
        "{",
        "}",
        "<think>",
        "</think>",
        "<answer>",
        "</answer>",
        "Answer:",
        "the",
        "answer",
        "is",
        "cannot",
        "image",
    ]
)


@given(st.lists(WORDS, max_size=12).map(" ".join) | st.text())
def test_who_does_not_say_the_word_does_not_mean_it(text: str) -> None:
    reply = read_words(text, "Is the fridge open?")
    assert reply in (Reply.YES, Reply.NO, Reply.UNKNOWN)
    if reply is not Reply.UNKNOWN:
        assert re.search(rf"\b{reply.value}\b", text, re.IGNORECASE | re.ASCII)
    spoken = re.sub(r".*</(?:think|thinking|reasoning)>", "", text, flags=re.DOTALL)
    if {"yes", "no"} <= set(re.findall(r"\w+", spoken.lower())) and reply is Reply.YES:
        raise AssertionError(f"{text!r} says both")


@given(st.text(), st.text())
def test_any_text_to_any_question_is_read(text: str, question: str) -> None:
    read_words(text, question)
    read_words(text, question, cut=True)


@pytest.mark.parametrize(
    "text", ["(" * 50_000, '"' * 50_000, "*" * 50_000, "<think>" * 9_000, "_a" * 20_000,
             "Yes, " + "a " * 30_000, "No. " * 20_000, "`" * 50_000, "no" * 30_000,
             "Yes, it's" + "'s" * 20_000, "</think>" * 9_000, "** a" * 9_000,
             "yes, x" + " " * 99_000 + "y", "```" + " " * 99_000 + "x",
             "*(__(" * 10_000 + "x" + ")__)*" * 10_000, '"*(' * 16_000 + "x" + ')*"' * 16_000,
             '*"' * 25_000 + "yes" + '"*' * 25_000],
    ids=lambda text: text[:9].strip(),
)  # fmt: skip
def test_long_replies_are_read_quickly(text: str) -> None:
    began = time.monotonic()
    assert read_words(text, "Is the fridge open?") is Reply.UNKNOWN
    assert time.monotonic() - began < 5


@pytest.mark.parametrize("word", ["yes", "no"])
def test_wrappings_of_every_kind_come_off_together(word: str) -> None:
    inside = f"'*_{word}_*'"
    assert read_words(f'"<answer>`{inside}`</answer>"').value == word
    assert read_words(f'```json\n{{"answer": "{inside}"}}\n```').value == word


@pytest.mark.parametrize("space", [" ", "\n", " \n"])
def test_a_long_answer_is_none_however_much_of_it_is_space(space: str) -> None:
    said = "Yes, the fridge is open."
    assert read_words(f"<think>{'Hm. ' * 9_000}</think>{said}", "Is the fridge open?") is Reply.YES
    between = said.replace(" the", space * 500 + "the")
    assert read_words(between, "Is the fridge open?") is Reply.YES
    beyond = said.replace(" the", space * 3_000 + "the")
    assert read_words(beyond, "Is the fridge open?") is Reply.UNKNOWN


@pytest.mark.parametrize(
    ("text", "reply"),
    [
        ("No", Reply.UNKNOWN),  # t sure
        ("Yes", Reply.UNKNOWN),  # terday
        ("No.", Reply.NO),
        ("No, the fridge is closed", Reply.UNKNOWN),
        ("No, the fridge is closed.", Reply.NO),
        ("Yes, the fridge is open", Reply.UNKNOWN),
        ("**Yes.**", Reply.YES),
    ],
)
def test_what_was_cut_has_to_be_whole(text: str, reply: Reply) -> None:
    assert read_words(text, "Is the fridge open?", cut=True) is reply
