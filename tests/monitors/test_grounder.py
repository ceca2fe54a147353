"""The rival that believes every answer: ViPlan's published procedure."""

from dataclasses import replace
from pathlib import Path

import pytest

from tests.doubles import perform
from tpvqa.assembly import Trial
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.errors import PluginError
from tpvqa.events import Ended
from tpvqa.events.decision import Decision
from tpvqa.events.events import Acting, Decided
from tpvqa.monitors import Step
from tpvqa.monitors.grounder import Grounder
from tpvqa.pddl import Atom, Task, load_task
from tpvqa.planning import Plan
from tpvqa.plugins import Kind, make
from tpvqa.questions import Question, QuestionBook
from tpvqa.tasks import find_task
from tpvqa.vlm import Reply

RED_ON_BLUE = "Is the red block directly on top of the blue block?"


@pytest.fixture(scope="module")
def task() -> Task:
    return load_task("build_tower")


@pytest.fixture(scope="module")
def book(task: Task) -> QuestionBook:
    return QuestionBook.load(find_task("build_tower").questions, task)


@pytest.fixture
def step(task: Task, book: QuestionBook) -> Step:
    action = task.action("moveblock", ("yellow", "c3", "blue", "c3", "c2"))
    return Step(task, book, Plan((action,), 1, "by hand", 0.0), 0, task.init, actions_left=3)


class Truth:
    """Answers as it is."""

    def __init__(self, held: frozenset[Atom]):
        self.held = held

    def __call__(self, question: Question) -> Reply:
        assert hasattr(question, "atoms")
        return Reply.YES if self.held & {*question.atoms} else Reply.NO


def test_what_is_answered_is_the_state(task: Task, book: QuestionBook) -> None:
    def told(question: Question) -> Reply:
        if question.text == "Is the red block in the third column?":
            return Reply.YES
        if question.text == "Is nothing on top of the red block?":
            return Reply.UNKNOWN
        return Truth(task.init)(question)

    verdict, looks, asked = perform(Grounder().first(book), told)
    assert looks == 1
    assert len(asked) == len(set(asked))
    changed = {Atom.parse("(incolumn red c3)"), Atom.parse("(clear red)")}
    assert verdict.state is not None
    assert verdict.state ^ task.init == changed


def test_as_long_as_all_is_as_expected_it_goes_on(step: Step) -> None:
    grounder = Grounder()
    assert perform(grounder.before(step), Truth(step.task.init))[0].decision is Decision.GO_ON
    after = step.task.apply(step.state, step.action)
    verdict, looks, _ = perform(grounder.after(step), Truth(after))
    assert (verdict.decision, verdict.state, looks) == (Decision.GO_ON, after, 1)


@pytest.mark.parametrize("when", ["before", "after"])
def test_one_answer_that_is_not_as_expected_has_everything_asked_anew(
    step: Step, when: str
) -> None:
    """Nothing happened, so of several effects all are denied; of the preconditions one is."""
    grounder = Grounder()
    held = step.task.init
    if when == "before":
        held -= {Atom.parse("(clear yellow)")}
    check = grounder.before(step) if when == "before" else grounder.after(step)
    verdict, looks, asked = perform(check, Truth(held))
    assert (verdict.decision, verdict.state, looks) == (Decision.REPLAN, held, 2)
    everything = perform(Grounder().first(step.book), Truth(held))[2]
    assert asked[-len(everything) :] == everything


def test_a_skill_that_fails_at_the_same_action_twice_ends_it(step: Step) -> None:
    failed = replace(step, reported=True)
    grounder = Grounder()
    assert perform(grounder.after(failed), Truth(step.task.init))[0].decision is Decision.REPLAN
    verdict, looks, _ = perform(grounder.after(failed), Truth(step.task.init))
    assert (verdict.decision, looks) == (Decision.GIVE_UP, 0)
    between = Grounder()
    perform(between.after(failed), Truth(step.task.init))
    other = step.task.action("moveblock", ("red", "green", "blue", "c1", "c2"))
    elsewhere = replace(failed, plan=Plan((other,), 1, "by hand", 0.0))
    perform(between.after(elsewhere), Truth(step.task.init))
    assert perform(between.after(failed), Truth(step.task.init))[0].decision is Decision.REPLAN


def test_actions_that_are_denied_count_against_the_limit(step: Step) -> None:
    grounder, denied = Grounder(), Truth(step.task.init - {Atom.parse("(clear yellow)")})
    decisions = [perform(grounder.before(step), denied)[0].decision for _ in range(3)]
    assert decisions == [Decision.REPLAN, Decision.REPLAN, Decision.GIVE_UP]


def test_it_takes_no_arguments() -> None:
    with pytest.raises(PluginError, match="Write grounder"):
        make(Kind.MONITOR, "grounder:3")


WORLD = "undo: []\nreports:\n  - refuses: 1\n"


def _ran(vlm: str, tmp_path: Path, episode: int = 0) -> tuple[Ended, MemoryWriter]:
    world_file = tmp_path / "world.yaml"
    world_file.write_text(WORLD)
    files = find_task("build_tower")
    config = TrialConfig.model_validate(
        {
            "task": {
                "domain": str(files.domain),
                "problem": str(files.problem),
                "questions": str(files.questions),
                "world_file": str(world_file),
            },
            "start": "unknown",
            "world": "symbolic",
            "vlm": vlm,
            "monitor": "grounder",
            "simulation": {"failure": 0, "disturbance": 0},
            "limits": {"repeats": None, "replans": None, "actions": 20},
            "episode": episode,
        }
    )
    writer = MemoryWriter()
    with Trial(config) as trial:
        return trial.run(writer), writer


def test_who_is_answered_right_reaches_the_goal_from_an_unknown_start(tmp_path: Path) -> None:
    ended, writer = _ran("oracle", tmp_path)
    assert ended.completed
    first = next(event for event in writer.events if isinstance(event, Decided))
    assert "asked about" in first.reason
    assert ended.replans == 0


def test_under_wrong_answers_every_trial_ends_as_it_may(tmp_path: Path) -> None:
    because = set()
    for episode in range(6):
        ended, writer = _ran("oracle:0.95:1", tmp_path, episode)
        because.add(ended.because)
        assert ended.actions <= 20
        assert sum(isinstance(event, Acting) for event in writer.events) == ended.actions
    assert because <= {"goal", "no plan", "gave up", "limit of actions"}
    assert because != {"goal"}
