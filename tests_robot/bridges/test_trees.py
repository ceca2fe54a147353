"""Behaviour trees of the real py_trees, on worlds without physics."""

import re
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from pathlib import Path
from threading import Event

import pytest
from py_trees.behaviour import Behaviour
from py_trees.behaviours import CheckBlackboardVariableValue
from py_trees.blackboard import Blackboard
from py_trees.common import ComparisonExpression, Status
from py_trees.composites import Selector
from py_trees.composites import Sequence as InOrder
from py_trees.trees import BehaviourTree

from tpvqa import (
    Action,
    Answer,
    Atom,
    Literal,
    Observation,
    Question,
    Reply,
    Task,
    TpvqaError,
    Trial,
    TrialConfig,
    load_task,
)
from tpvqa.episodes import EpisodeWriter, MemoryWriter, read_episode
from tpvqa.events import Resumed
from tpvqa.events.events import Acted, Answered
from tpvqa.resuming import resume
from tpvqa.tasks import find_task
from tpvqa.worlds import Execution, Report, World
from tpvqa.worlds.symbolic import SymbolicWorld
from tpvqa_robots.bridges.steps import PausableTrial
from tpvqa_robots.bridges.trees import Act, Check, Ground

ROOT = Path(__file__).parents[2]
UNKNOWN, BROKEN, HUNG, NO = "unknown", "broken", "hung", "no"


class Skills:
    """A world whose skills take time and stop when they are told to; some do not."""

    def __init__(self, world: World, *, seconds: float = 60.0, deaf: Event | None = None):
        self._world, self._seconds, self._deaf = world, seconds, deaf
        self.done: list[tuple[str, Report]] = []
        self.running = 0

    def views(self) -> Sequence[str]:
        return self._world.views()

    def observe(self, view: str | None = None) -> Observation:
        return self._world.observe(view)

    def execute(
        self, action: Action, *, deadline: float | None = None, cancel: Event | None = None
    ) -> Execution:
        assert cancel is not None
        assert not self.running, "a robot does one thing at a time"
        self.running += 1
        if self._deaf is not None:
            self._deaf.wait(10)
        stopped = cancel.wait(min(self._seconds, deadline or self._seconds))
        late = deadline is not None and deadline < self._seconds
        report = Report.CANCELLED if stopped else Report.LATE if late else Report.DONE
        self.running -= 1
        self.done.append((action.name, report))
        return Execution(report, 0.0)

    def close(self) -> None:
        pass


class Unsure:
    """A VLM that says what it is made to say, one word a look; in the end the last for ever."""

    name = "unsure"

    def __init__(self, *words: str):
        self.words, self.asked = list(words), 0
        self.hang = Event()

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        self.asked += 1
        word = self.words.pop(0) if len(self.words) > 1 else self.words[0]
        if word == BROKEN:
            raise RuntimeError("no connection")
        if word == HUNG:
            self.hang.wait(10)
        reply = {"yes": Reply.YES, NO: Reply.NO}.get(word, Reply.UNKNOWN)
        return [Answer(each, reply) for each in questions]


CONFIG = TrialConfig(task="build_tower", world="symbolic", vlm="oracle", monitor="tpvqa")


@pytest.fixture(scope="module")
def task() -> Task:
    files = find_task("build_tower")
    return load_task(files.domain, files.problem)


@pytest.fixture
def trial(task: Task) -> Iterator[Trial]:
    """A trial in which every action works."""
    with Trial(CONFIG.but(simulation={"failure": 0}), task=task) as made:
        yield made


def ticked(behaviour: Behaviour, until: Callable[[], bool] = lambda: False) -> Status:
    """Tick as a robot's program does, and see that no tick waits for anything."""
    for _ in range(1000):
        began = time.monotonic()
        behaviour.tick_once()
        assert time.monotonic() - began < 0.5
        if behaviour.status is not Status.RUNNING or until():
            return behaviour.status
        time.sleep(0.005)
    raise AssertionError("it runs for ever")


def move(trial: Trial, block: str, under: str, onto: str, columns: str) -> Action:
    return trial.task.action("moveblock", [block, under, onto, *columns.split()])


# Check


@pytest.mark.parametrize(
    ("words", "status", "asked", "said"),
    [
        (["yes"], Status.SUCCESS, 1, "affirmed: "),
        ([NO], Status.FAILURE, 1, "denied: "),
        ([UNKNOWN], Status.FAILURE, 3, "unknown after 3 looks: "),
        ([UNKNOWN, UNKNOWN, "yes"], Status.SUCCESS, 3, "affirmed: "),
        ([UNKNOWN, NO], Status.FAILURE, 2, "denied: "),
        ([BROKEN], Status.FAILURE, 3, "RuntimeError: no connection"),
        ([BROKEN, "yes"], Status.SUCCESS, 2, "affirmed: "),
    ],
)
def test_what_a_check_makes_of_answers(
    trial: Trial, words: list[str], status: Status, asked: int, said: str
) -> None:
    vlm = Unsure(*words)
    on = Literal(Atom.parse("(on red green)"))
    check = Check("?", trial.world, vlm, trial.parts.book, literals=[on])
    assert ticked(check) is status
    assert vlm.asked == asked
    assert said in check.feedback_message
    assert "on" in check.feedback_message


def test_facts_that_are_never_affirmed_in_one_look_are_unknown(trial: Trial) -> None:
    class OneALook(Unsure):
        def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
            self.asked += 1
            told = self.asked % len(questions)
            replies = (Reply.YES if n == told else Reply.CANNOT_SEE for n in range(len(questions)))
            return [Answer(each, reply) for each, reply in zip(questions, replies, strict=True)]

    facts = [Literal(Atom.parse("(on red green)")), Literal(Atom.parse("(clear red)"))]
    vlm = OneALook()
    check = Check("?", trial.world, vlm, trial.parts.book, literals=facts, looks=5)
    assert ticked(check) is Status.FAILURE
    assert vlm.asked == 5


def test_late_answers_and_dropped_looks_count_for_nothing(trial: Trial) -> None:
    """The VLM hangs; later it says yes to what nobody wants to know any more."""
    vlm = Unsure(HUNG, "yes")
    on = Literal(Atom.parse("(on red green)"))
    book = trial.parts.book
    check = Check("?", trial.world, vlm, book, literals=[on], looks=2, patience=0.05)
    assert ticked(check) is Status.FAILURE
    assert "unknown after 2 looks: " in check.feedback_message
    assert vlm.asked == 1, "a VLM is asked by one thread at a time"
    other = Check("!", trial.world, vlm, book, literals=[on])
    other.tick_once()
    other.stop(Status.INVALID)
    vlm.hang.set()
    assert ticked(check) is Status.SUCCESS
    assert vlm.asked == 2, "what was dropped is not asked"


def test_a_check_asks_about_an_action_before_and_after_it(trial: Trial) -> None:
    action = move(trial, "red", "green", "blue", "c1 c2")
    parts = (trial.world, trial.vlm, trial.parts.book)
    before = Check("before", *parts, action=action)
    after = Check("after", *parts, action=action, when="after")
    assert (ticked(before), ticked(after)) == (Status.SUCCESS, Status.FAILURE)
    assert "on" in after.feedback_message
    assert ticked(Act("do", trial.world, action)) is Status.SUCCESS
    assert (ticked(before), ticked(after)) == (Status.FAILURE, Status.SUCCESS)


def test_what_cannot_be_asked_is_said_at_once(trial: Trial) -> None:
    parts = (trial.world, trial.vlm, trial.parts.book)
    with pytest.raises(TpvqaError, match="no predicate 'own'"):
        Check("?", *parts, literals=[Literal(Atom.parse("(own red green)"))])
    with pytest.raises(TpvqaError, match="never asked about: no action changes it"):
        Check("?", *parts, literals=[Literal(Atom.parse("(incolumn c1 c1)"))])
    with pytest.raises(TpvqaError, match="either literals or an action"):
        Check("?", *parts)


# Act


def test_a_branch_of_higher_priority_stops_the_skill_and_has_the_robot(trial: Trial) -> None:
    """py_trees begins the one before it ends the other."""
    world = Skills(trial.world)
    low = Act("stack", world, move(trial, "red", "green", "blue", "c1 c2"))
    high = Act("clear up", world, move(trial, "red", "green", "yellow", "c1 c3"))
    wanted = CheckBlackboardVariableValue(
        "wanted?", ComparisonExpression("wanted", True, lambda value, there: value == there)
    )
    Blackboard.set("wanted", False)
    first = InOrder("first", memory=False, children=[wanted, high])
    root = Selector("robot", memory=False, children=[first, low])
    assert ticked(root, lambda: world.running == 1) is Status.RUNNING
    Blackboard.set("wanted", True)
    began = time.monotonic()
    root.tick_once()
    assert time.monotonic() - began < 0.2
    assert world.done == [("moveblock", Report.CANCELLED)]
    assert (low.status, high.status) == (Status.INVALID, Status.RUNNING)
    assert low.feedback_message.endswith("stopped")
    world._seconds = 0.05
    assert ticked(root) is Status.SUCCESS
    assert world.done[1:] == [("moveblock", Report.DONE)]


def test_a_skill_that_does_not_stop_keeps_the_robot(trial: Trial) -> None:
    deaf = Event()
    world = Skills(trial.world, deaf=deaf)
    action = move(trial, "red", "green", "blue", "c1 c2")
    act = Act("stack", world, action, grace=0.1)
    ticked(act, lambda: world.running == 1)
    began = time.monotonic()
    act.stop(Status.INVALID)
    assert 0.1 <= time.monotonic() - began < 0.3
    assert "still runs after 0.1 s" in act.feedback_message
    other = Act("other", world, action, grace=0.1)
    assert ticked(other) is Status.FAILURE
    assert other.feedback_message == "another skill still runs"
    deaf.set()
    world._seconds = 0.01
    assert ticked(other) is Status.SUCCESS


def test_a_skill_that_is_late_or_never_comes_back_fails(trial: Trial) -> None:
    action = move(trial, "red", "green", "blue", "c1 c2")
    late = Act("late", Skills(trial.world), action, deadline=0.05)
    assert ticked(late) is Status.FAILURE
    assert late.execution is not None
    assert late.execution.report is Report.LATE
    deaf = Event()
    never = Act("never", Skills(trial.world, deaf=deaf), action, deadline=0.05, grace=0.05)
    assert ticked(never) is Status.FAILURE
    assert "does not end" in never.feedback_message
    deaf.set()


def test_a_robot_stands_still_when_the_program_ends() -> None:
    """Also where nobody shuts the tree down."""
    program = """
import time
from tpvqa.pddl import Action
from tpvqa.events import Resumed
from tpvqa.events.events import Acted, Answered
from tpvqa.resuming import resume
from tpvqa.tasks import find_task
from tpvqa.worlds import Execution, Report
from tpvqa_robots.bridges.jobs import Job
def skill(cancel):
    cancel.wait(30)
    print("stands still", flush=True)
Job(skill, "skill")
time.sleep(0.05)
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=9
    )
    assert (done.stdout, done.stderr) == ("stands still\n", "")


# Ground


def test_the_tree_of_the_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What moves a block before the trial is found out by it; its log is an episode."""
    page = (ROOT / "docs" / "robots.md").read_text()
    code = re.search(r"## In a behaviour tree\n.*?```python\n(.*?)```", page, re.DOTALL)
    assert code is not None
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(code[1], names)
    tower = names["tower"]
    assert isinstance(tower, Ground)
    assert tower.status is Status.SUCCESS
    assert tower.feedback_message == "goal"
    ended = read_episode(tmp_path / "tower")[-1]
    assert ended.kind == "ended"
    assert ended.completed


class Slow(SymbolicWorld):
    """A simulated world whose skills take time before they change anything."""

    seconds = 0.02
    moving = False

    def execute(
        self, action: Action, *, deadline: float | None = None, cancel: Event | None = None
    ) -> Execution:
        self.moving = True
        stopped = cancel is not None and cancel.wait(self.seconds)
        self.moving = False
        if stopped:
            return Execution(Report.CANCELLED, self.seconds)
        return super().execute(action, deadline=deadline, cancel=cancel)


def test_a_paused_trial_looks_before_it_goes_on(task: Task, tmp_path: Path) -> None:
    """Meanwhile another branch has put a block elsewhere."""
    writer = EpisodeWriter(tmp_path)
    with Trial(CONFIG.but(simulation={"failure": 0}), task=task) as trial:
        world = trial.parts.world = Slow(trial.simulation)
        tower = Ground("tower", trial, writer)
        world.seconds = 30.0
        ticked(tower, lambda: world.moving)
        began = time.monotonic()
        tower.stop(Status.INVALID)
        assert time.monotonic() - began < 0.2
        assert not world.moving
        assert tower.feedback_message == "paused"
        world.seconds = 0.0
        aside = Act("aside", world, move(trial, "red", "green", "blue", "c1 c2"))
        assert ticked(aside) is Status.SUCCESS
        paused = len(read_episode(tmp_path))
        assert ticked(tower) is Status.SUCCESS, tower.feedback_message
    writer.close()
    events = read_episode(tmp_path)
    assert events[-1].kind == "ended"
    assert events[-1].completed
    kinds = [event.kind for event in events[paused:]]
    assert "observed" in kinds[: kinds.index("acting")]
    reports = [event.report for event in events if event.kind == "acted"]
    assert reports.count(Report.CANCELLED) == 1


def test_nothing_is_done_about_what_was_seen_before_a_pause(trial: Trial) -> None:
    """It is paused between any two requests, again and again."""
    writer = MemoryWriter()
    running = PausableTrial(trial, writer, patience=1)
    running.begin()
    paused = 0
    while running.ended is None:
        if len(writer.events) % 3 == 0 and paused < 12:
            running.pause.set()
            running.step()
            running.resume()
            paused += 1
            writer.events.append(Resumed())
        running.step()
    assert paused > 5
    assert running.ended.completed
    seen = True
    for event in writer.events:
        seen = event.kind == "observed" or (seen and event.kind != "resumed")
        if isinstance(event, Acted) and event.report is Report.DONE:
            assert seen
        elif isinstance(event, Answered) and not seen:
            assert {each.reply for each in event.answers} == {Reply.UNKNOWN}


def test_a_trial_that_ended_is_not_taken_for_another_one(trial: Trial) -> None:
    tower = Ground("tower", trial, MemoryWriter())
    assert ticked(tower) is Status.SUCCESS
    assert ticked(tower) is Status.FAILURE
    assert tower.feedback_message == (
        "the trial has ended (goal); make another Ground to run it again"
    )
    again = Ground("again", trial, MemoryWriter())
    assert ticked(again) is Status.FAILURE
    assert "has run already" in again.feedback_message


def test_a_goal_that_is_out_of_reach_and_a_vlm_that_breaks_are_failures(task: Task) -> None:
    config = CONFIG.but(limits={"actions": 1})
    with Trial(config, task=task) as trial:
        tower = Ground("tower", trial, MemoryWriter())
        assert ticked(tower) is Status.FAILURE
        assert tower.feedback_message == "limit of actions"
    with Trial(CONFIG, task=task, vlm=Unsure(BROKEN)) as trial:
        tower = Ground("tower", trial, MemoryWriter())
        assert ticked(tower) is Status.FAILURE
        assert "Unsure.ask broke: RuntimeError: no connection" in tower.feedback_message
        assert ticked(tower) is Status.FAILURE


def test_a_tree_that_is_shut_down_leaves_a_trial_to_be_gone_on_with(
    trial: Trial, tmp_path: Path
) -> None:
    world = trial.parts.world = Slow(trial.simulation)
    world.seconds = 30.0
    writer = EpisodeWriter(tmp_path / "tower")
    tree = BehaviourTree(Ground("tower", trial, writer))
    ticked(tree.root, lambda: world.moving)
    tree.shutdown()
    writer.close()
    assert not world.moving
    last = read_episode(tmp_path / "tower")[-1]
    assert last.kind == "ended"
    assert last.because == "cancelled"
    assert resume(tmp_path / "tower").completed


def test_what_is_to_be_installed_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.startswith("tpvqa_robots.bridges.trees")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "py_trees.behaviour", None)
    with pytest.raises(TpvqaError, match=r"'py_trees'.*tpvqa-robots\[trees\]"):
        import_module("tpvqa_robots.bridges.trees")
