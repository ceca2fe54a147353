"""paper-table and recorded models: they err as often, and as surely, as was measured."""

from collections import Counter
from dataclasses import replace

import pytest

from tests.doubles import made
from tpvqa.errors import PluginError, UnknownNameError
from tpvqa.observation import Observation
from tpvqa.pddl import Action, Atom, Literal, Task, load_task
from tpvqa.questions import Question, QuestionBook, Way
from tpvqa.tasks import find_task
from tpvqa.vlm import VLM, Reply
from tpvqa.vlm.recorded.answers import models, recordings
from tpvqa_experiments.paper_table import PAPER_TABLE

LOOKS = 3000


class Truth:
    """Every fact is as told, every action is possible and was successful as told."""

    def __init__(self, *, yes: bool):
        self.yes = yes

    def holds(self, atom: Atom) -> bool:
        return self.yes

    def visible(self, atom: Atom) -> bool:
        return True

    def scene(self) -> str:
        return "the only one"

    def possible(self, action: Action) -> bool:
        return self.yes

    def successful(self, action: Action) -> bool:
        return self.yes


@pytest.fixture(scope="module")
def task() -> Task:
    return load_task("serve_breakfast")


@pytest.fixture(scope="module")
def book(task: Task) -> QuestionBook:
    return QuestionBook.load(find_task("serve_breakfast").questions, task)


def asked(vlm: VLM, question: Question, looks: int = LOOKS) -> list[tuple[Reply, float | None]]:
    answers = [vlm.ask(Observation(look, 0.0), [question])[0] for look in range(looks)]
    return [(answer.reply, answer.p_yes) for answer in answers]


@pytest.mark.parametrize("yes", [True, False])
def test_the_papers_table_is_met_in_every_way_of_asking(
    yes: bool, task: Task, book: QuestionBook
) -> None:
    vlm = made("paper-table", truth=Truth(yes=yes), task=task)
    on = Literal(Atom("on", ("bread", "plate")))
    place = task.action("place", ("bread", "plate", "left"))
    for question, row in (
        (book.fact(on, way=Way.PRECONDITION), Way.PRECONDITION),
        (book.fact(on, way=Way.ALTERNATIVE), Way.PRECONDITION),
        (book.fact(on, way=Way.EFFECT), Way.EFFECT),
        (book.possible(place), Way.POSSIBLE),
        (book.successful(place), Way.SUCCESSFUL),
        (book.did(place), Way.SUCCESSFUL),
    ):
        right = Reply.YES if yes else Reply.NO
        share = sum(reply is right for reply, _ in asked(vlm, question)) / LOOKS
        assert share == pytest.approx(PAPER_TABLE[row]["serve_breakfast"], abs=0.035)


def test_the_table_has_no_column_for_other_tasks(task: Task) -> None:
    other = made("paper-table", truth=Truth(yes=True), task=task)
    assert other.name == "paper-table"
    with pytest.raises(PluginError, match="no column"):
        made("paper-table", truth=Truth(yes=True), task=replace(task, name="mow"))


@pytest.mark.parametrize("model", ["qwen2.5-vl-72b", "internvl3-8b", "gemma-3-12b"])
@pytest.mark.parametrize("yes", [True, False])
def test_a_recorded_model_errs_as_often_as_it_did(
    model: str, yes: bool, task: Task, book: QuestionBook
) -> None:
    vlm = made(f"recorded:{model}:fresh", truth=Truth(yes=yes), task=task)
    question = book.fact(Literal(Atom("in_hand", ("bread", "left"))), way=Way.PRECONDITION)
    told = recordings(model, "igibson").of("precondition", "holding", truth=yes)
    expected = sum(r.count for r in told if r.yes) / sum(r.count for r in told)
    found = asked(vlm, question)
    assert sum(reply is Reply.YES for reply, _ in found) / LOOKS == pytest.approx(
        expected, abs=0.035
    )
    assert {p for _, p in found} <= {r.p_yes for r in told}


def test_the_same_question_about_the_same_look_gets_the_same_answer(
    task: Task, book: QuestionBook
) -> None:
    vlm = made("recorded:internvl3-8b", truth=Truth(yes=True), task=task)
    question = book.fact(Literal(Atom("near", ("bread",))), way=Way.EFFECT)
    for look in range(20):
        answers = vlm.ask(Observation(look, 0.0), [question, question])
        assert answers[0] == answers[1] == vlm.ask(Observation(look, 0.0), [question])[0]


def test_about_whole_actions_nothing_was_recorded(task: Task, book: QuestionBook) -> None:
    vlm = made("recorded:internvl3-8b", truth=Truth(yes=True), task=task)
    action = task.action("turn_on", ("tv",))
    questions = [book.possible(action), book.successful(action), book.did(action)]
    answers = vlm.ask(Observation(0, 0.0), questions)
    assert [answer.reply for answer in answers] == [Reply.UNKNOWN] * 3


@pytest.mark.parametrize(
    "spec",
    ["recorded", "recorded:internvl3-8b:2", "recorded:internvl3-8b:fresh:0", "paper-table:x"],
)
def test_arguments_that_mean_nothing(spec: str, task: Task) -> None:
    with pytest.raises(PluginError):
        made(spec, truth=Truth(yes=True), task=task)


def test_an_unknown_model_is_named_with_the_nearest(task: Task) -> None:
    with pytest.raises(UnknownNameError, match="Did you mean 'internvl3-8b'"):
        made("recorded:internvl3", truth=Truth(yes=True), task=task)


def test_blocksworld_and_igibson_are_never_pooled() -> None:
    for model, environments in models().items():
        for environment in environments:
            own = recordings(model, environment)
            halves = [recordings(model, environment, half) for half in (0, 1)]
            assert halves[0].by_kind.keys() == halves[1].by_kind.keys() <= own.by_kind.keys()
            for key in halves[0].by_kind:
                told = own.by_kind[key]
                both = Counter[tuple[bool, float | None]]()
                for half in halves:
                    for r in half.by_kind.get(key, ()):
                        both[r.yes, r.p_yes] += r.count
                assert both == {(r.yes, r.p_yes): r.count for r in told}
    assert models()["qwen2.5-vl-72b"] == ("blocksworld", "igibson")


def accuracy(model: str, environment: str) -> float:
    rows = [
        (recording, truth)
        for (_, predicate, truth), told in recordings(model, environment).by_kind.items()
        if not predicate
        for recording in told
    ]
    right = sum(r.count for r, truth in rows if r.yes == truth)
    return right / sum(r.count for r, _ in rows)


@pytest.mark.parametrize(
    ("model", "blocksworld", "igibson"),
    [
        ("qwen2.5-vl-72b", 0.965, 0.362),
        ("qwen2.5-vl-7b", 0.962, 0.363),
        ("gemma-3-12b", 0.834, 0.639),
        ("internvl3-8b", 0.825, 0.654),
        ("aya-vision-8b", 0.793, 0.601),
        ("gpt-4.1-nano", 0.779, 0.620),
        ("phi-4-multimodal", 0.751, 0.571),
        ("llava-onevision-7b", 0.720, 0.561),
    ],
)
def test_the_compact_form_has_the_accuracies_of_the_recording(
    model: str, blocksworld: float, igibson: float
) -> None:
    """Figures of the recording's own description."""
    assert accuracy(model, "blocksworld") == pytest.approx(blocksworld, abs=0.0006)
    assert accuracy(model, "igibson") == pytest.approx(igibson, abs=0.0006)
