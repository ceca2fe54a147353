"""What the episodes of a cell share, and running one of them."""

import time
import traceback
from collections.abc import Callable
from dataclasses import asdict, replace
from functools import lru_cache
from typing import Any

from tpvqa.belief.experience import Experience
from tpvqa.bench.cell import Cell
from tpvqa.bench.judge import Judge
from tpvqa.bench.row import EpisodeRow
from tpvqa.episodes import Ended, Event, MemoryWriter
from tpvqa.errors import TpvqaError
from tpvqa.pddl import Action, Task, load_task
from tpvqa.planning import Planner
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.remembering import Remembering
from tpvqa.plugins import Kind, load, make
from tpvqa.questions import QuestionBook
from tpvqa.tasks import find_task
from tpvqa.trial import Trial, TrialConfig
from tpvqa.vlm import VLM
from tpvqa.worlds.simulation import Simulation
from tpvqa.worlds.world_file import WorldRules, load_world_file

PICTURES = 512
"""Encoded pictures that are kept: all of the shipped set."""


class Stage:
    """Runs episodes of one task. What does not change between them is read and made once.

    Args:
        task: A shipped task.
    """

    def __init__(self, task: str):
        files = find_task(task)
        self.task: Task = load_task(task)
        self.book = QuestionBook.load(files.questions, self.task)
        self.rules: WorldRules = load_world_file(files.world, self.task)
        self.actions: dict[str, Action] = {
            action.pddl(): action for action in self.task.ground_actions()
        }

    def run(self, cell: Cell, common: TrialConfig, episode: int) -> EpisodeRow:
        """Run one episode. Whatever goes wrong in it is in its row, and the rest go on."""
        return self.run_learning(cell, common, episode)[0]

    def run_learning(
        self, cell: Cell, common: TrialConfig, episode: int
    ) -> tuple[EpisodeRow, Experience | None]:
        """The same, and what the monitor has learned, where it learns."""
        began = time.perf_counter()
        row: dict[str, Any] = {
            **asdict(cell),
            "seed": common.seed,
            "episode": episode,
        }
        try:
            figures, learned = self._figures(cell.config(common, episode))
        except TpvqaError as error:
            figures, learned = {"error": str(error)}, common.experience
        except Exception:  # noqa: BLE001 — one broken plug-in must not end a bench of thousands
            figures, learned = {"error": traceback.format_exc(limit=-3)}, common.experience
        seconds = round(time.perf_counter() - began, 4)
        return EpisodeRow(**row, **figures, seconds=seconds), learned

    def trial(self, config: TrialConfig) -> Trial:
        """A trial of the task, ready to run; made of what all its trials share."""
        assert config.vlm is not None
        return Trial(
            config,
            task=self.task,
            planner=_planner(),
            vlm=_shared_vlm(config.vlm),
            book=self.book,
            rules=self.rules,
        )

    def play(self, trial: Trial, listener: Callable[[Event], None]) -> Ended:
        """Run a trial that is kept nowhere; only a listener is told of it.

        Raises:
            KeyboardInterrupt: Ctrl-C ends the bench, and this episode is none of it.
        """
        return trial.run(MemoryWriter(resumable=False, keep=False), listeners=[listener])

    def _figures(self, config: TrialConfig) -> tuple[dict[str, Any], Experience | None]:
        with self.trial(config) as trial:
            judge = Judge(true_simulation(trial), self.actions)
            ended = self.play(trial, judge)
            learned = trial.experience
            trust = None if learned is None else learned.trusting()
        figures = {
            "completed": bool(ended.completed),
            "because": ended.because,
            "believed_goal": ended.believed_goal,
            "actions": ended.actions,
            "questions": ended.questions,
            "looks": ended.looks,
            "repeats": ended.repeats,
            "replans": ended.replans,
            "longest_repeat": judge.longest_repeat,
            "failures": judge.failures,
            "wasted": judge.wasted,
            "first_plan": judge.first_plan or 0,
            "answers": dict(judge.answers),
            "decisions": dict(judge.decisions),
            "trust": None if trust is None else round(trust.mean, 4),
        }
        return figures, learned


def true_simulation(trial: Trial) -> Simulation:
    """Where the true state of a trial lies."""
    found: Simulation = getattr(trial.world, "simulation", trial.simulation)
    return found


@lru_cache
def stage(task: str) -> Stage:
    """The stage of a task, one in every process."""
    return Stage(task)


@lru_cache
def _planner() -> Planner:
    return Remembering(FastDownward())


@lru_cache
def _shared_vlm(spec: str) -> VLM | None:
    """A VLM that all episodes share; None for noise models, which belong to one world."""
    target: Callable[..., object] = load(Kind.VLM, spec.partition(":")[0].strip())
    if getattr(target, "noise_model", False):
        return None
    vlm: VLM = make(Kind.VLM, spec, remember=PICTURES)
    return vlm


def run_batch(
    cell: Cell, common: TrialConfig, episodes: tuple[int, ...]
) -> list[dict[str, object]]:
    """Run some episodes of a cell: what a worker is sent. Their rows as plain values."""
    here = stage(cell.task)
    carried, rows = cell.carried, []
    for episode in episodes:
        if carried and episode % carried == 0:
            common = replace(common, experience=None)
        row, learned = here.run_learning(cell, common, episode)
        if carried:
            common = replace(common, experience=learned)
        rows.append(row.model_dump())
    return rows
