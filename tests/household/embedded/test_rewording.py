"""What the embedded network understands besides the words it was taught."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa_household.embedded.lexicon import Unknown, words
from tpvqa_household.embedded.weights import SHIPPED, Weights
from tpvqa_household.training.asking import Asking
from tpvqa_household.training.wordings import wordings

ASKING = Asking.about("serve_breakfast")
LEXICON = Weights.read(SHIPPED).lexicon

SAME = {
    "Is there an apple in the image?": (
        "Are there apples?",
        "Are there any apples in the picture?",
        "Is there an apple here?",
        "Is there some apple in this photo?",
        "Is an apple there?",
        "Is an apple visible in the picture?",
        "Are any apples visible?",
        "Can you see any apples?",
        "Can you spot an apple?",
        "Do you see an apple?",
        "Does this picture show an apple?",
        "Does the photo contain an apple?",
        "Is an apple in the image?",
        "Is an apple present?",
        "Is the apple in view?",
        "Please tell me whether there is an apple.",
    ),
    "Is there a fridge in the image?": ("Is there a refrigerator?", "Can you see the icebox?"),
    "Is there a TV in the image?": ("Can you see a TV?", "Is a television set visible?"),
    "Is there a counter in the image?": ("Is there a countertop?", "Do you see the worktop?"),
    "Is there a knife in the image?": ("Are there knives in the scene?",),
    "Is the fridge open?": (
        "Is the fridge door open?",
        "Is the refrigerator open?",
        "Is the fridge's door open?",
        "Is the door of the refrigerator opened?",
        "Is the fridge wide open?",
        "Is the fridge standing open?",
        "Is the fridge currently open?",
        "Is the fridge open right now?",
        "Is the fridge open in this picture?",
        "Can you tell me if the fridge is open?",
        "Do you think the fridge is open?",
    ),
    "Is the fridge closed?": ("Is the fridge door shut?",),
    "Is the apple in a robot's hand?": (
        "Is the robot's hand holding the apple?",
        "Is the gripper holding the apple?",
        "Does the robot hold the apple?",
        "Is the robot gripping the apple?",
        "Is the robot carrying the apple?",
        "Is the apple held by the gripper?",
        "Is the apple in the robot gripper?",
        "Is the apple in its hand?",
        "Is the apple in the hand of the robot?",
        "Has the robot got the apple in its hand?",
        "Is the robot holding the apple in its gripper?",
    ),
    "Is the apple on the table?": (
        "Is the apple on top of the table?",
        "Is the apple sitting on the table?",
        "Are there apples on the table?",
        "Is there an apple lying on the kitchen table?",
        "Does the apple rest on the table?",
    ),
    "Is the plate in the sink?": (
        "Is the plate inside the sink?",
        "Is the plate lying in the washbasin?",
        "Are there any plates in the sink?",
    ),
    "Is the apple in the fridge?": ("Is the apple inside of the refrigerator?",),
    "Is the bread on the plate?": ("Is the loaf of bread on the plate?",),
    "Is the TV turned on?": (
        "Is the telly on?",
        "Is the TV powered on?",
        "Is the TV's screen lit?",
    ),
    "Is the TV turned off?": ("Is the TV switched off?", "Is the TV screen off?"),
    "Is the plate clean?": ("Does the plate look clean?",),
    "Is the plate dirty?": ("Is the plate unwashed?", "Does the plate look dirty?"),
    "Is the apple cut in half?": (
        "Is the apple sliced in half?",
        "Has the apple been cut into two halves?",
        "Is the apple divided into two pieces?",
    ),
    "Is the apple whole?": ("Is the apple intact?", "Is the apple still whole?"),
}
UNKNOWN = (
    "Is the fridge not open?",
    "Isn't the fridge open?",
    "Is there no apple?",
    "Is no apple visible?",
    "Are there no apples on the table?",
    "Is the apple not in the robot's hand?",
    "Is nothing on the plate?",
    "Is the fridge open or closed?",
    "Is the fridge closed and the TV on?",
    "Are there apples and plates?",
    "Is there an apple or a plate?",
    "Are there two apples?",
    "How many apples are there?",
    "Is there more than one apple?",
    "Is there only one apple?",
    "Is the fridge almost open?",
    "Is the fridge half open?",
    "Was the fridge open?",
    "Will the fridge be open?",
    "Should the fridge be open?",
    "Is the fridge full?",
    "Is the fridge clean?",
    "Is the fridge running?",
    "Is the apple open?",
    "Is the plate turned on?",
    "Is the TV cut in half?",
    "Is there a green apple?",
    "Is the apple red?",
    "Is the apple bigger than the plate?",
    "Is the apple under the table?",
    "Is the apple next to the plate?",
    "Is the apple behind the fridge?",
    "Is the apple off the table?",
    "Is the table on the apple?",
    "Is the apple on the robot?",
    "Is the plate on the counter clean?",
    "Is the apple on the plate on the table?",
    "Is the robot holding something?",
    "Is the robot holding nothing?",
    "Is the robot holding the apple and the knife?",
    "Is a person holding the apple?",
    "Is the hand empty?",
    "Is there an apple outside the image?",
    "Is there a milk carton?",
    "Is the window open?",
    "What is on the table?",
    "Where is the apple?",
    "Is the fridge?",
    "Is there?",
    "Is there a?",
    "",
    "Does the picture show that the fridge is not open?",
    "Tell me whether the fridge is not open.",
    "Do you think the apple is there or on the table?",
    "Is the door open?",
    "Is it open?",
    "Is the apple almost in the sink?",
    "Is the TV on and the fridge open?",
    "Is everything on the table?",
    "Are all plates clean?",
    "Are the plates clean?",
    "Are the apples on the table?",
    "Is the fridge не open?",
    "Is the fridge ≠ open?",
    "Is the fridge !open?",
    "Has the fridge been opened?",
    "Is the apple in the hand?",
)


@pytest.mark.parametrize(
    ("taught", "said"), [(taught, said) for taught, every in SAME.items() for said in every]
)
def test_a_rewording_is_understood(taught: str, said: str) -> None:
    assert meant(said) in same_sense(taught)


@pytest.mark.parametrize("said", UNKNOWN)
def test_whatever_may_mean_something_else_is_unknown(said: str) -> None:
    assert isinstance(LEXICON.tokens(said), Unknown)


@given(st.sampled_from(LEXICON.questions))
def test_a_taught_question_is_itself(question: str) -> None:
    assert meant(question) == question


@given(
    st.sampled_from([said for every in SAME.values() for said in every] + list(SAME)),
    st.sampled_from(("not", "never", "no", "almost", "or", "both", "three", "un", "other")),
    st.integers(0, 12),
)
def test_a_word_more_that_turns_the_meaning_is_never_passed_over(
    said: str, word: str, place: int
) -> None:
    spoken = said.split()
    spoken.insert(min(place, len(spoken)), word)
    assert isinstance(LEXICON.tokens(" ".join(spoken)), Unknown)


def meant(said: str) -> str:
    """The taught question that a question amounts to, in words."""
    found = LEXICON.tokens(said)
    assert not isinstance(found, Unknown), found.reason
    return " ".join(LEXICON.vocabulary[token - 1] for token in found)


def same_sense(taught: str) -> set[str]:
    """The taught questions about the same, asked the same way round."""
    spoken = " ".join(words(taught))
    for subject in ASKING.subjects:
        every = [(" ".join(words(each.text)), each.inverted) for each in wordings(subject)]
        turned = dict(every).get(spoken)
        if turned is not None:
            return {text for text, inverted in every if inverted is turned}
    raise AssertionError(f"{taught} was not taught")
