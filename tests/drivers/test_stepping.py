"""A trial one request at a time; listeners; limits; plans that are not made twice."""

from collections.abc import Iterator
from pathlib import Path
from threading import Event as Flag
from typing import Any

import pytest

from tests.doubles import configured
from tests.resumed import story
from tpvqa.assembly import Trial
from tpvqa.drivers.performing import Performed
from tpvqa.episodes import EpisodeWriter, MemoryWriter, read_episode
from tpvqa.episodes.log import LOG
from tpvqa.errors import EpisodeError, PluginError, TpvqaError
from tpvqa.events import Decision, Ended, Event, Limits
from tpvqa.events.events import Answered, AnswerRecord, ListenerDropped, PlanMade
from tpvqa.monitors import Ask, Check, Look, PlanFrom, Step, Verdict
from tpvqa.monitors.none import NoMonitor
from tpvqa.pddl import State, Task
from tpvqa.planning import Planner, PlanningResult
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.remembering import Remembering
from tpvqa.resuming import resume
from tpvqa.trial import Act
from tpvqa.vlm import Answer, Reply


@pytest.fixture(scope="module")
def planner() -> Iterator[Planner]:
    planner = Remembering(FastDownward())
    yield planner
    planner.close()


CONFIG = configured(task="build_tower", world="symbolic", vlm="oracle", monitor="tpvqa")


def test_what_came_of_nothing_is_refused(planner: Planner) -> None:
    writer = MemoryWriter()
    rubbish: Any = "rubbish"
    with Trial(CONFIG, planner=planner) as trial:
        steps, performer = trial.stepping(writer), trial.performer(writer)
        steps.begin()
        with pytest.raises(TpvqaError, match=r"goes on with a Performed.*not str 'rubbish'"):
            steps.send(rubbish)
        assert steps.pending is not None
        performed = performer.perform(steps.pending)
        steps.send(performed)
        while steps.pending is not None:
            steps.send(performer.perform(steps.pending))
        with pytest.raises(TpvqaError, match="Nothing is pending"):
            steps.send(performed)
        assert steps.end().because == "goal"


def test_what_is_pending_is_there_to_be_seen_before_it_is_done(planner: Planner) -> None:
    writer = MemoryWriter()
    requests: list[str] = []
    with Trial(CONFIG, planner=planner) as trial:
        steps, performer = trial.stepping(writer), trial.performer(writer)
        steps.begin()
        while steps.pending is not None:
            requests.append(type(steps.pending.request).__name__)
            steps.begun()
            acting = sum(event.kind == "acting" for event in writer.events)
            done = sum(event.kind == "acted" for event in writer.events)
            assert acting - done == isinstance(steps.pending.request, Act)
            steps.send(performer.perform(steps.pending))
        assert steps.conclusion is not None
        assert steps.conclusion.because == "goal"
        assert steps.state.actions == requests.count("Act")
    assert requests[:3] == [kind.__name__ for kind in (PlanFrom, Look, Ask)]
    with Trial(CONFIG, planner=planner) as trial:
        trial.run(alone := MemoryWriter())
    assert story(writer.events) == story(alone.events)[:-1]  # nobody has ended it


def test_somebody_else_can_answer(planner: Planner) -> None:
    """No VLM at all: whoever steps through the trial says what is seen."""
    writer = MemoryWriter()
    with Trial(CONFIG.but(simulation={"failure": 0.0}), planner=planner) as trial:
        steps, performer = trial.stepping(writer), trial.performer(writer)
        steps.begin()
        while (pending := steps.pending) is not None:
            if not isinstance(pending.request, Ask):
                steps.send(performer.perform(pending))
                continue
            said = [Reply.YES if q.expected else Reply.NO for q in pending.request.questions]
            answers = [Answer(q, r) for q, r in zip(pending.request.questions, said, strict=True)]
            record = Answered(answers=tuple(AnswerRecord(reply=reply) for reply in said))
            steps.send(Performed(answers, record))
        assert steps.conclusion is not None
    assert (steps.conclusion.because, steps.state.repeats) == ("goal", 0)


def test_a_listener_that_breaks_is_named_and_the_trial_goes_on(planner: Planner) -> None:
    heard: list[Event] = []

    class Display:
        def __call__(self, event: Event) -> None:
            if event.kind == "observed":
                raise ZeroDivisionError("no screen")

    writer = MemoryWriter()
    with Trial(CONFIG, planner=planner) as trial:
        ended = trial.run(writer, listeners=[Display(), heard.append])
    assert ended.because == "goal"
    dropped = [event for event in writer.events if isinstance(event, ListenerDropped)]
    assert len(dropped) == 1
    assert "Display" in dropped[0].listener
    assert dropped[0].error == "ZeroDivisionError: no screen"
    assert {event.number for event in heard} == {event.number for event in writer.events}


@pytest.mark.parametrize("monitor", ["tpvqa", "belief", "tp"])
def test_a_limit_of_time_ends_a_trial(planner: Planner, monitor: str) -> None:
    config = CONFIG.but(
        monitor={"spec": monitor},
        limits=Limits(seconds=1e-6, repeats=10**6, actions=10**6).model_dump(),
        simulation={"failure": 1.0, "disturbance": 0.0},
    )
    with Trial(config, planner=planner) as trial:
        ended = trial.run(MemoryWriter())
    assert ended.because == "limit of time"


def test_the_limit_of_actions_grows_with_the_first_plan(planner: Planner) -> None:
    assert Limits().actions_of(3) == 60
    assert Limits().actions_of(20) == 120
    assert Limits(actions=7).actions_of(20) == 7


class Counting:
    """A planner that counts what it is asked for."""

    name = "counting"

    def __init__(self, planner: Planner):
        self._planner, self.asked = planner, list[State]()

    def plan(
        self, task: Task, state: State | None = None, *, timeout: float | None = None
    ) -> PlanningResult:
        self.asked.append(task.init if state is None else state)
        return self._planner.plan(task, state, timeout=timeout)

    def close(self) -> None: ...


def test_a_plan_that_a_verdict_rests_on_is_not_made_again(planner: Planner) -> None:
    carried = 0
    for episode in range(5):
        counting, writer = Counting(planner), MemoryWriter()
        config = configured(
            task="eat_apple",
            world="symbolic",
            vlm="oracle:0.9",
            monitor="belief",
            disturbance=0.6,
            episode=episode,
        )
        with Trial(config, planner=counting) as trial:
            ended = trial.run(writer)
        assert isinstance(ended, Ended)
        made = [event for event in writer.events if isinstance(event, PlanMade)]
        assert len(counting.asked) == len(set(counting.asked))  # never twice from one state
        carried += len(made) - len(counting.asked)
    assert carried > 0


def test_several_listeners_may_break_and_at_the_end_too(planner: Planner, tmp_path: Path) -> None:
    def at_once(event: Event) -> None:
        raise ValueError("one")

    def as_well(event: Event) -> None:
        raise SystemExit(1)  # as rich does where its pipe is broken

    def at_the_end(event: Event) -> None:
        if event.kind == "ended":
            raise ValueError("late")

    writer = EpisodeWriter(tmp_path)
    with Trial(CONFIG, planner=planner) as trial:
        ended = trial.run(writer, listeners=[at_once, as_well, at_the_end])
    writer.close()
    events = read_episode(tmp_path)
    assert ended.because == "goal"
    assert events[-1].kind == "ended"
    dropped = [event for event in events if isinstance(event, ListenerDropped)]
    assert [event.error for event in dropped] == ["ValueError: one", "SystemExit: 1"]
    with pytest.raises(EpisodeError, match="has ended"):
        resume(tmp_path)


def test_a_listener_that_breaks_on_resuming_is_named_where_the_log_goes_on(
    planner: Planner, tmp_path: Path
) -> None:
    writer = EpisodeWriter(tmp_path)
    with Trial(CONFIG, planner=planner) as trial:
        trial.run(writer)
    writer.close()
    log = tmp_path / LOG
    log.write_bytes(b"".join(log.read_bytes().splitlines(keepends=True)[:9]))

    def broken(event: Event) -> None:
        raise ValueError("no screen")

    assert resume(tmp_path, listeners=[broken]).because == "goal"
    events = read_episode(tmp_path)
    assert [event.number for event in events] == list(range(len(events)))
    assert events[9].kind == "listener dropped"


def test_what_is_cancelled_before_it_is_begun_is_not_in_the_log(planner: Planner) -> None:
    for kind in ("acted", "observed"):
        cancel, writer = Flag(), MemoryWriter()

        def stop(event: Event, kind: str = kind, cancel: Flag = cancel) -> None:
            if event.kind == kind:
                cancel.set()

        with Trial(CONFIG, planner=planner) as trial:
            ended = trial.run(writer, listeners=[stop], cancel=cancel)
        kinds = [event.kind for event in writer.events]
        assert ended.because == "cancelled"
        assert kinds.count("acting") == kinds.count("acted") == ended.actions
        assert kinds.count("asked") == kinds.count("answered")


def test_what_a_monitor_must_not_ask_for_and_a_planner_must_not_return_is_named(
    planner: Planner,
) -> None:
    class Odd(NoMonitor):
        def before(self, step: Step) -> Check:
            yield [1, 2, 3]  # type: ignore[misc]
            return Verdict(Decision.GO_ON, "")

    class Lost:
        name = "lost"

        def plan(self, *_: object, **__: object) -> None: ...

        def close(self) -> None: ...

    with Trial(CONFIG, planner=planner) as trial:
        trial.monitor = Odd()
        with pytest.raises(PluginError, match=r"asked for \[1, 2, 3\]"):
            trial.run(MemoryWriter())
    with (
        Trial(CONFIG, planner=Lost()) as trial,  # type: ignore[arg-type]
        pytest.raises(PluginError, match="lost has to return a Plan"),
    ):
        trial.run(MemoryWriter())


def test_a_log_that_goes_on_where_the_trial_ends_is_not_resumed(
    planner: Planner, tmp_path: Path
) -> None:
    writer = EpisodeWriter(tmp_path)
    with Trial(CONFIG, planner=planner) as trial:
        trial.run(writer)
    writer.close()
    events = read_episode(tmp_path)
    more = [*events[:-1], events[-2]]
    with (
        Trial(CONFIG, planner=planner) as trial,
        pytest.raises(EpisodeError, match="cannot be resumed"),
    ):
        trial.run(MemoryWriter(), recorded=more, folder=tmp_path)


def test_events_that_somebody_else_wrote_are_not_cut_off(tmp_path: Path, planner: Planner) -> None:
    writer = EpisodeWriter(tmp_path)
    with Trial(CONFIG, planner=planner) as trial:
        trial.run(writer)
    writer.close()
    before = (tmp_path / LOG).read_bytes()
    with pytest.raises(EpisodeError, match="written to by another process"):
        EpisodeWriter(tmp_path, resume=9)
    assert (tmp_path / LOG).read_bytes() == before
