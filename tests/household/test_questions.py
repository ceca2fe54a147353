"""What is asked about the household: the paper's questions, plan by plan."""

import pytest

from tpvqa.pddl import Action, Atom, Literal, State, Task, load_task
from tpvqa.questions import ActionQuestion, Question, QuestionBook, Way
from tpvqa.tasks import find_task

PLANS: dict[str, dict[str, tuple[list[str], list[str]]]] = {
    "clean_dishes": {
        "find plate tv": ([], ["Is there a plate in the image? yes"]),
        "pick_up plate table left": (
            ["Is there a plate in the image? yes", "Is the plate on the table? yes"],
            ["Is the plate in a robot's hand? yes", "Is the plate on the table? no"],
        ),
        "find sink plate": ([], ["Is there a sink in the image? yes"]),
        "wash plate sink left": (
            ["Is the plate in a robot's hand? yes", "Is there a sink in the image? yes"],
            ["Is the plate clean? yes"],
        ),
    },
    "serve_breakfast": {
        "find bread sink": ([], ["Is there a bread in the image? yes"]),
        "pick_up bread counter left": (
            ["Is there a bread in the image? yes", "Is the bread on the counter? yes"],
            ["Is the bread in a robot's hand? yes", "Is the bread on the counter? no"],
        ),
        "find plate bread": ([], ["Is there a plate in the image? yes"]),
        "place bread plate left": (
            ["Is the bread in a robot's hand? yes", "Is there a plate in the image? yes"],
            ["Is the bread on the plate? yes", "Is the bread in a robot's hand? no"],
        ),
        "find tv plate": ([], ["Is there a TV in the image? yes"]),
        "turn_on tv": (["Is there a TV in the image? yes"], ["Is the TV turned on? yes"]),
    },
    "eat_apple": {
        "find fridge tv": ([], ["Is there a fridge in the image? yes"]),
        "open fridge": (["Is there a fridge in the image? yes"], ["Is the fridge open? yes"]),
        "find apple fridge": (["Is the fridge open? yes"], ["Is there an apple in the image? yes"]),
        "pick_up apple fridge left": (
            ["Is there an apple in the image? yes", "Is the apple in the fridge? yes"],
            ["Is the apple in a robot's hand? yes", "Is the apple in the fridge? no"],
        ),
        "find knife apple": ([], ["Is there a knife in the image? yes"]),
        "pick_up knife counter right": (
            ["Is there a knife in the image? yes", "Is the knife on the counter? yes"],
            ["Is the knife in a robot's hand? yes", "Is the knife on the counter? no"],
        ),
        "cut_in_half apple knife left right": (
            ["Is the apple in a robot's hand? yes", "Is the knife in a robot's hand? yes"],
            ["Is the apple cut in half? yes"],
        ),
    },
}


def shown(questions: tuple[Question, ...]) -> list[str]:
    return [f"{each.text} {'yes' if each.expected else 'no'}" for each in questions]


def ready(name: str) -> tuple[Task, QuestionBook]:
    task = load_task(name)
    return task, QuestionBook.load(find_task(name).questions, task)


def act(task: Task, words: str) -> Action:
    name, *arguments = words.split()
    return task.action(name, arguments)


@pytest.mark.parametrize("name", PLANS)
def test_the_questions_of_the_plan(name: str) -> None:
    task, book = ready(name)
    state = task.init
    for words, (before, after) in PLANS[name].items():
        action = act(task, words)
        assert task.applicable(state, action), words
        assert shown(book.preconditions(action, state)) == before
        assert shown(book.effects(action, state)) == after
        state = task.apply(state, action)
    assert task.goal_holds(state)


@pytest.mark.parametrize("name", PLANS)
def test_nothing_of_the_household_falls_back(name: str) -> None:
    assert ready(name)[1].notices == []


def test_whole_actions_are_asked_about_in_the_papers_words() -> None:
    task, book = ready("serve_breakfast")
    action = act(task, "place bread plate left")
    assert book.say(action) == "place the bread on the plate"
    assert book.done(action) == "placed the bread on the plate"
    assert [question.text for question in (book.possible(action), book.successful(action),
                                           book.did(action))] == [
        "Is it possible to place the bread on the plate here?",
        "Was place the bread on the plate successful?",
        "Did the robot successfully place the bread on the plate?",
    ]  # fmt: skip
    assert book.did(action) == ActionQuestion(
        "Did the robot successfully place the bread on the plate?", Way.DID, action
    )


def test_the_papers_wording_has_no_articles() -> None:
    """Where it says <action>: \"Was wash plate successful?\" is the paper's own example."""
    task, book = ready("clean_dishes")
    paper, wash = book.worded("paper"), act(task, "wash plate sink left")
    assert [paper.possible(wash).text, paper.successful(wash).text, paper.did(wash).text] == [
        "Is it possible to wash plate here?",
        "Was wash plate successful?",
        "Did the robot successfully wash plate?",
    ]
    assert paper.say(wash) == book.say(wash) == "wash the plate"
    assert paper.effects(wash, task.init) == book.effects(wash, task.init)


@pytest.mark.parametrize(
    ("name", "words", "text"),
    [
        ("serve_breakfast", "place bread plate left", "Was place bread on plate successful?"),
        ("serve_breakfast", "turn_on tv", "Was turn on TV successful?"),
        ("eat_apple", "cut_in_half apple knife left right", "Was cut apple in half successful?"),
    ],
)
def test_nor_have_the_places_in_it(name: str, words: str, text: str) -> None:
    task, book = ready(name)
    assert book.worded("paper").successful(act(task, words)).text == text


def test_things_lie_in_some_places_and_on_others() -> None:
    task, book = ready("eat_apple")
    said = {
        where: book.fact(Literal(Atom("on", ("knife", where)))).text
        for where in ("sink", "fridge", "table", "floor", "plate")
    }
    assert said == {
        "sink": "Is the knife in the sink?",
        "fridge": "Is the knife in the fridge?",
        "table": "Is the knife on the table?",
        "floor": "Is the knife on the floor?",
        "plate": "Is the knife on the plate?",
    }
    assert book.say(act(task, "place knife sink left")) == "place the knife in the sink"


def test_an_open_fridge_is_not_asked_about_where_the_thing_is_not_believed_in_it() -> None:
    task, book = ready("eat_apple")
    state: State = task.init | {Atom("opened", ("fridge",))}
    knife, apple = act(task, "find knife tv"), act(task, "find apple tv")
    assert shown(book.preconditions(knife, state)) == []
    assert shown(book.preconditions(apple, state)) == ["Is the fridge open? yes"]


def test_where_no_part_of_a_disjunction_holds_what_can_be_seen_of_it_is_asked() -> None:
    task, book = ready("eat_apple")
    closed = act(task, "find apple tv")
    assert shown(book.preconditions(closed, task.init)) == ["Is the fridge open? yes"]


def test_what_no_camera_shows_is_not_asked_and_the_reason_is_kept() -> None:
    task, book = ready("eat_apple")
    find, pick_up = act(task, "find apple tv"), act(task, "pick_up apple fridge left")
    near = Literal(Atom("near", ("apple",)))
    free = Literal(Atom("free", ("left",)))
    inside = Literal(Atom("on", ("apple", "fridge")))
    assert book.asked(near)
    assert not book.asked(near.negate())
    assert not book.asked(free)
    assert not book.asked(free.negate())
    assert book.asked(inside, find)
    assert not book.asked(inside.negate(), find)
    assert book.asked(inside.negate(), pick_up)
    assert book.asked(inside.negate())
    assert not book.asked(Literal(Atom("near", ("tv",))), find)
    assert book.asked(near, find)
    assert "fridge too" in (book.why_not(near.negate()) or "")


def test_a_negative_literal_is_the_positive_question_with_no_expected() -> None:
    _, book = ready("eat_apple")
    literal = Literal(Atom("on", ("apple", "fridge")))
    yes, no = book.fact(literal), book.fact(literal.negate(), way=Way.ALTERNATIVE)
    assert (yes.text, yes.expected, yes.way) == (
        "Is the apple in the fridge?",
        True,
        Way.PRECONDITION,
    )
    assert (no.text, no.expected, no.way) == ("Is the apple in the fridge?", False, Way.ALTERNATIVE)
