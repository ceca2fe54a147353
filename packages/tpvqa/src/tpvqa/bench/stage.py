"""What the episodes of a cell share, and running one of them."""

import json
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from functools import lru_cache
from threading import get_ident
from typing import Any

from tpvqa.assembly import Trial
from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.belief.calibrating.risk import RiskBound
from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.belief.learning.experience import Experience
from tpvqa.bench.cell import Cell
from tpvqa.bench.judge import Judge
from tpvqa.bench.own_task import OwnTask
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.written_actions import WrittenActions
from tpvqa.config import TrialConfig
from tpvqa.drivers import run
from tpvqa.episodes import MemoryWriter
from tpvqa.errors import BenchError, TpvqaError
from tpvqa.events import Ended, Event
from tpvqa.events.events import ListenerDropped
from tpvqa.monitors.capabilities import goal_probability_of
from tpvqa.pddl import Task, load_task
from tpvqa.planning import Planner
from tpvqa.planning.making import make_planner
from tpvqa.planning.remembering import remembering
from tpvqa.plugins import Kind, load_spec, takes
from tpvqa.questions import QuestionBook
from tpvqa.tasks import TaskFiles, find_task
from tpvqa.vlm import VLM
from tpvqa.vlm.capabilities import is_noise_model
from tpvqa.vlm.making import make_vlm
from tpvqa.worlds.capabilities import simulation_of
from tpvqa.worlds.simulation import Simulation
from tpvqa.worlds.world_file import WorldRules, load_world_file

PICTURES = 512
"""Encoded pictures that are kept: all of the shipped set."""
ANSWERS = ("cache", "record", "replay")
"""Settings of a VLM that name a file of recorded answers."""
MOST_FACTS = 300_000
"""In the joint states of a shared action model, at about 1 KB each on the shipped tasks."""
OF_A_TRIAL = frozenset(
    {"*", "task", "book", "rules", "planner", "views", "limits", "seed", "episode"}
)
"""What a VLM may ask for that is of one task or one trial, so that trials cannot share it."""


class Stage:
    """Runs episodes of one task. What does not change between them is read and made once.

    Args:
        task: A shipped task, or the name of one of the user's own.
        own: The task, where it is the user's own.
    """

    def __init__(self, task: str, own: OwnTask | None = None):
        self._named: dict[str, Any] = {"name": task}
        if own is not None:
            self._named = {
                "name": None,
                "domain": str(own.origin.domain),
                "problem": str(own.origin.problem),
            }
        with _files(task, own) as files:
            self.task: Task = load_task(files.domain, files.problem)
            self.book = QuestionBook.load(files.questions, self.task)
            self.rules: WorldRules = load_world_file(files.world, self.task)
        self.actions = WrittenActions(self.task)
        self._model: FaultModel | None = None

    @property
    def model(self) -> FaultModel:
        """The action model, shared by trials one after the other.

        One that has grown large is not handed out again, so that a process that runs trials
        without end does not grow without end.
        """
        if self._model is None or self._model.facts > MOST_FACTS:
            self._model = FaultModel(self.task, self.rules)
        return self._model

    def run(self, cell: Cell, common: TrialConfig, episode: int) -> EpisodeRow:
        """Run one episode. Whatever goes wrong in it is in its row, and the rest go on."""
        return self.run_learning(cell, common, episode)[0]

    def run_learning(
        self,
        cell: Cell,
        common: TrialConfig,
        episode: int,
        *,
        calibration: Calibration | None = None,
        experience: Experience | None = None,
        risk: RiskBound | None = None,
    ) -> tuple[EpisodeRow, Experience | None]:
        """The same with what the monitor is told, and what it has learned.

        Args:
            cell: Which.
            common: What all cells share.
            episode: Its number.
            calibration: What the monitor is told of the VLM's answers.
            experience: What it has learned before.
            risk: Where it may report "done", if it states a risk.

        Returns:
            The row, and what the monitor has learned, where it learns.
        """
        began = time.perf_counter()
        row: dict[str, Any] = {
            **asdict(cell),
            "seed": common.seed,
            "episode": episode,
        }
        try:
            config = cell.config(common, episode)
            figures, learned = self._figures(config, calibration, experience, risk)
            ended = EpisodeRow(**row, **figures)
        except TpvqaError as error:
            ended, learned = EpisodeRow(**row, error=str(error)), experience
        except Exception:  # noqa: BLE001 — one broken plug-in must not end a bench of thousands
            ended, learned = EpisodeRow(**row, error=traceback.format_exc(limit=-3)), experience
        seconds = round(time.perf_counter() - began, 4)
        return ended.model_copy(update={"seconds": seconds}), learned

    def trial(
        self,
        config: TrialConfig,
        *,
        calibration: Calibration | None = None,
        experience: Experience | None = None,
        risk: RiskBound | None = None,
    ) -> Trial:
        """A trial of the task, ready to run; made of what all its trials share."""
        spec = config.vlm.spec
        assert spec is not None
        if config.vlm.answers is not None and is_noise_model(load_spec(Kind.VLM, spec)):
            config = config.but(vlm=dict.fromkeys(ANSWERS))  # there is nothing to record of it
        options = json.dumps(config.plugin_options(), sort_keys=True, default=str)
        return Trial(
            config.but(task=self._named),
            task=self.task,
            planner=shared_planner(config.planner.spec),
            vlm=None if config.vlm.replay is not None else _shared_vlm(spec, options),
            book=self.book,
            rules=self.rules,
            model=self.model,
            calibration=calibration,
            experience=experience,
            risk=risk,
            every_option=False,
        )

    def play(self, trial: Trial, listener: Callable[[Event], None]) -> Ended:
        """Run a trial that is kept nowhere; only a listener is told of it.

        Raises:
            KeyboardInterrupt: Ctrl-C ends the bench, and this episode is none of it.
            BenchError: The listener broke, so that what it counted is not to be used.
        """
        dropped: list[str] = []

        def watch(event: Event) -> None:
            if isinstance(event, ListenerDropped):
                dropped.append(f"{event.listener}: {event.error}")

        writer = MemoryWriter(resumable=False, keep=False)
        steps = trial.stepping(writer, listeners=[listener, watch])
        if isinstance(listener, Judge):
            listener.watch(steps)
        ended = run(steps, trial.performer(writer))
        if dropped:
            raise BenchError(f"what was to be counted was not: {dropped[0]}")
        return ended

    def _figures(
        self,
        config: TrialConfig,
        calibration: Calibration | None,
        experience: Experience | None,
        risk: RiskBound | None,
    ) -> tuple[dict[str, Any], Experience | None]:
        with self.trial(config, calibration=calibration, experience=experience, risk=risk) as trial:
            judge = Judge(true_simulation(trial), self.actions)
            ended = self.play(trial, judge)
            learned = trial.experience
            trust = None if learned is None else learned.trusting()
            goal = goal_probability_of(trial.monitor)
        figures = {
            "completed": bool(ended.completed),
            "because": ended.because,
            "believed_goal": ended.believed_goal,
            "reached": bool(ended.goal_holds),
            "actions": ended.actions,
            "questions": ended.questions,
            "looks": ended.looks,
            "repeats": ended.repeats,
            "replans": ended.replans,
            **({} if ended.usage is None else ended.usage.model_dump(exclude={"untold"})),
            "longest_repeat": judge.longest_repeat,
            "failures": judge.failures,
            "wasted": judge.wasted,
            "dead": judge.dead,
            "named": judge.named,
            "misnamed": len(judge.misnamed),
            "first_plan": judge.first_plan,
            "answers": dict(judge.answers),
            "decisions": dict(judge.decisions),
            "trust": None if trust is None else round(trust.mean, 4),
            "goal": goal,
        }
        return figures, learned


def true_simulation(trial: Trial) -> Simulation:
    """Where the true state of a trial lies."""
    return simulation_of(trial.world)


def stage(task: str, own: OwnTask | None = None) -> Stage:
    """The stage of a task, one in every thread of every process."""
    return _stage(task, own, get_ident())


@lru_cache
def _stage(task: str, own: OwnTask | None, thread: int) -> Stage:
    return Stage(task, own)


@contextmanager
def _files(task: str, own: OwnTask | None) -> Iterator[TaskFiles]:
    if own is None:
        yield find_task(task)
        return
    with own.files() as files:
        yield files


@lru_cache
def shared_planner(spec: str) -> Planner:
    """The planner of a specification that all episodes of a process share."""
    return remembering(make_planner(spec))


@lru_cache
def _shared_vlm(spec: str, options: str) -> VLM | None:
    """A VLM that all episodes share; None for one that belongs to one world or trial."""
    target = load_spec(Kind.VLM, spec)
    if is_noise_model(target) or takes(target) & OF_A_TRIAL:
        return None
    return make_vlm(spec, {"remember": PICTURES, **json.loads(options)})[0]


def run_each(
    cell: Cell,
    common: TrialConfig,
    episodes: tuple[int, ...],
    calibration: Calibration | None = None,
    own: OwnTask | None = None,
    risk: RiskBound | None = None,
) -> Iterator[EpisodeRow]:
    """Run some episodes of a cell, one after the other."""
    here, carried = stage(cell.task, own), cell.carried
    learned: Experience | None = None
    for episode in episodes:
        known = learned if carried and episode % carried else None
        row, learned = here.run_learning(
            cell, common, episode, calibration=calibration, experience=known, risk=risk
        )
        yield row
