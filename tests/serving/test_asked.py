"""The question in a prompt."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.observation import Frame
from tpvqa.pddl import Action, Task, load_task
from tpvqa.planning import Plan
from tpvqa.planning.making import make_planner
from tpvqa.questions import Question, QuestionBook
from tpvqa.serving.asked import LONGEST, question_in
from tpvqa.serving.refusal import Refusal
from tpvqa.tasks import find_task
from tpvqa.vlm.chat_completions import Inquiry, messages
from tpvqa.vlm.prompt import shipped_prompt

TASKS = ("build_tower", "clean_dishes", "serve_breakfast", "eat_apple")


def planned(task: Task) -> tuple[Action, ...]:
    planner = make_planner("fast-downward")
    found = planner.plan(task)
    planner.close()
    assert isinstance(found, Plan)
    return found.actions


def prompt(question: str, views: int = 1) -> str:
    """What tpvqa's own client says."""
    frames = [Frame(str(n), str(n), b"") for n in range(views)]
    (message,) = messages(Inquiry((question,), tuple(frames)), shipped_prompt())
    return str(message["content"][-1]["text"])


@pytest.mark.parametrize("name", TASKS)
@pytest.mark.parametrize("views", [1, 3])
def test_every_question_of_the_shipped_tasks_comes_through(name: str, views: int) -> None:
    task = load_task(name)
    book = QuestionBook.load(find_task(name).questions, task)
    plan = planned(task)
    asked: list[str] = []
    for action in plan:
        found: list[Question] = [*book.preconditions(action, task.init), book.possible(action)]
        found += [*book.effects(action, task.init), book.successful(action), book.did(action)]
        asked += [question.text for question in found]
    assert len(set(asked)) > 8
    assert [question_in(prompt(text, views)) for text in asked] == asked


@pytest.mark.parametrize(
    "text",
    [
        "Is the fridge open?",
        "Is the fridge open? Answer yes or no.",
        "Is the fridge open? Please answer with 'yes' or 'no' only.",
        "Is the fridge open?\nReply with one word: yes or no",
        "Answer only yes or no. Is the fridge open?",
        "Is the fridge open? Yes or no?",
        "Question: Is the fridge open? Answer:",
        "Question: Is the fridge open?\nShort answer:",
        "  Is the fridge open?  \n\nAnswer yes, no or unknown.\n",
    ],
)
def test_what_only_says_how_to_answer_is_taken_off(text: str) -> None:
    assert question_in(text) == "Is the fridge open?"


@pytest.mark.parametrize(
    "text",
    [
        "Is the fridge open? Answer yes if it is closed, no if it is open.",
        "Is the fridge open? Answer no, not yes.",
        "The first picture is from before. Is the fridge open?",
        "Is the fridge open? Is the TV turned on?",
        "Ignore the fridge on the left. Is the fridge open?",
        "Is it 3.5 m away?",
        "Say whether the fridge is open",
    ],
)
def test_what_else_is_said_stays_in_the_question(text: str) -> None:
    assert question_in(text) == text


@pytest.mark.parametrize("text", ["", " \n ", "Answer yes or no.", "?" * (LONGEST + 1)])
def test_a_prompt_without_a_question_or_without_an_end_is_refused(text: str) -> None:
    with pytest.raises(Refusal) as refused:
        question_in(text)
    assert (refused.value.status, refused.value.param) == (400, "messages")


@given(st.text(st.sampled_from("abc ?.,!'yesno"), min_size=1, max_size=60))
def test_no_word_is_added_or_moved(text: str) -> None:
    try:
        found = question_in(text)
    except Refusal:
        return
    left = iter(text.split())
    assert all(word in left for word in found.split())
