"""Trials in a world that cannot be put back: a robot that is killed and started again."""

from pathlib import Path

import pytest

from tpvqa.assembly import Trial
from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.config import TrialConfig
from tpvqa.drivers import Parts
from tpvqa.episodes import EpisodeWriter, read_episode
from tpvqa.events import Ended, Event, Resumed
from tpvqa.events.events import Acting
from tpvqa.monitors import Monitor
from tpvqa.monitors.belief import BeliefMonitor
from tpvqa.monitors.none import NoMonitor
from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.tpvqa import TPVQA
from tpvqa.observation import Frame, Observation, SensedFact
from tpvqa.pddl import Action, Task, load_task
from tpvqa.planning import Planner
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.remembering import Remembering
from tpvqa.vlm.oracle import Oracle
from tpvqa.worlds import Execution, Report
from tpvqa.worlds.simulation import SimulatedTruth, Simulation


class Killed(BaseException):
    """What a kill looks like from within."""


class Robot:
    """A robot in a room that stays as it is while the program is dead. Counts its own looks."""

    def __init__(self, room: Simulation, name: str):
        self.room, self.name, self.looks = room, name, 0
        self.truth = SimulatedTruth(room)

    def views(self) -> tuple[str, ...]:
        return ("front",)

    def observe(self, view: str | None = None) -> Observation:
        data = f"{self.name}, look {self.looks}".encode()
        frame = Frame("camera", "front", data)
        self.looks += 1
        held = [atom for atom in self.room.state if atom.predicate == "in_hand"]
        return Observation(frames={"front": frame}, facts=[SensedFact(a, 0.9) for a in held])

    def execute(self, action: Action, **_: object) -> Execution:
        self.room.execute(action)
        return Execution(Report.DONE, 0.0)

    def close(self) -> None: ...


@pytest.fixture(scope="module")
def planner() -> Planner:
    return Remembering(FastDownward())


@pytest.fixture(scope="module")
def task() -> Task:
    return load_task("clean_dishes")


def go_on(
    folder: Path, room: Simulation, planner: Planner, monitor: Monitor, *, kill_at: int | None
) -> list[Event]:
    """Begin an episode or go on with it, until it ends or is killed after so many events."""
    recorded = read_episode(folder) if (folder / "episode.jsonl").exists() else []
    config = TrialConfig(task="clean_dishes", world="symbolic", vlm="oracle")
    trial = Trial(config, task=room.task, planner=planner)
    robot = Robot(room, f"run from event {len(recorded)}")
    trial.parts = Parts(room.task, trial.book, planner, robot, Oracle(robot.truth))
    trial.monitor = monitor
    writer = EpisodeWriter(folder, resume=len(recorded), durable=False)

    def watch(event: Event) -> None:
        if event.number == kill_at:
            raise Killed

    try:
        trial.run(writer, recorded=recorded, folder=folder, listeners=[watch])
    except Killed:
        pass
    finally:
        writer.close()
    return read_episode(folder)


@pytest.mark.parametrize("kind", [TPVQA, NoMonitor, BeliefMonitor])
def test_killed_anywhere_it_goes_on_with_a_new_look_to_the_goal(
    kind: type[Monitor], task: Task, planner: Planner, tmp_path: Path
) -> None:
    model = FaultModel(task)

    def monitor() -> Monitor:
        return BeliefMonitor(task, model=model) if kind is BeliefMonitor else kind()

    whole = go_on(tmp_path / "whole", Simulation(task, failure=0), planner, monitor(), kill_at=None)
    for cut in range(len(whole) - 1):
        room, folder = Simulation(task, failure=0), tmp_path / f"cut{cut}"
        before = go_on(folder, room, planner, monitor(), kill_at=cut)
        assert len(before) == cut + 1
        kept = {path: path.read_bytes() for path in (folder / "frames").iterdir()}
        events = go_on(folder, room, planner, monitor(), kill_at=None)
        ended = events[-1]
        assert isinstance(ended, Ended)
        assert (ended.because, ended.completed) == ("goal", True), cut
        assert all(path.read_bytes() == data for path, data in kept.items())
        looks = [event.look for event in events if event.kind == "observed"]
        assert looks == list(range(len(looks)))
        added = events[cut + 1 :]
        if any(event.kind == "acting" for event in added):
            kinds = [event.kind for event in added]
            assert "observed" in kinds[: kinds.index("acting")], (cut, kinds)


def test_killed_twice_it_still_goes_on(task: Task, planner: Planner, tmp_path: Path) -> None:
    whole = go_on(tmp_path / "whole", Simulation(task, failure=0), planner, TPVQA(), kill_at=None)
    for cut in range(1, len(whole) - 1, 2):
        for later in (1, 2, 3):
            room, folder = Simulation(task, failure=0), tmp_path / f"cut{cut}-{later}"
            go_on(folder, room, planner, TPVQA(), kill_at=cut)
            events = go_on(folder, room, planner, TPVQA(), kill_at=cut + later)
            if not isinstance(events[-1], Ended):
                events = go_on(folder, room, planner, TPVQA(), kill_at=None)
            ended = events[-1]
            assert isinstance(ended, Ended)
            assert ended.completed, (cut, later)
            assert sum(isinstance(event, Resumed) for event in events) <= 2


class Hearing(NoMonitor):
    """Notes what it is told of every action."""

    def __init__(self) -> None:
        super().__init__()
        self.heard: list[tuple[str, bool | None, tuple[SensedFact, ...]]] = []

    def after(self, step: Step) -> Check:
        self.heard.append((step.action.name, step.reported, step.sensed))
        return super().after(step)


def test_killed_in_the_middle_of_a_skill_nothing_is_reported_and_the_new_look_senses(
    task: Task, planner: Planner, tmp_path: Path
) -> None:
    monitor = Hearing()
    whole = go_on(tmp_path / "whole", Simulation(task, failure=0), planner, monitor, kill_at=None)
    assert {reported for _, reported, _ in monitor.heard} == {False}
    pick = next(k for k, e in enumerate(whole) if isinstance(e, Acting) and "pick" in e.action.name)
    room, folder = Simulation(task, failure=0), tmp_path / "e"
    go_on(folder, room, planner, Hearing(), kill_at=pick)
    (before,) = [e for e in read_episode(folder)[-1:] if isinstance(e, Acting)]
    room.execute(task.action(before.action.name, before.action.arguments))  # it went on alone
    monitor = Hearing()
    go_on(folder, room, planner, monitor, kill_at=None)
    (_, reported, sensed), *_ = [each for each in monitor.heard if each[0] == before.action.name]
    assert reported is None
    assert [(fact.atom.predicate, fact.probability) for fact in sensed] == [("in_hand", 0.9)]


def test_an_action_that_never_began_is_not_taken_for_a_failed_one(
    task: Task, planner: Planner, tmp_path: Path
) -> None:
    room, folder = Simulation(task, failure=0), tmp_path / "e"
    whole = go_on(tmp_path / "whole", Simulation(task, failure=0), planner, TPVQA(), kill_at=None)
    first = next(k for k, event in enumerate(whole) if event.kind == "acting")
    go_on(folder, room, planner, TPVQA(), kill_at=first - 1)
    events = go_on(folder, room, planner, TPVQA(), kill_at=None)
    acted = [event for event in events if event.kind == "acted"]
    assert all(event.report is Report.DONE for event in acted)
    assert len(acted) == 4
