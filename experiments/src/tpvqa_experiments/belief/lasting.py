"""The noises whose errors last or mislead, what the monitor must reach under each, and the cells.

The ways that errors last are those of `docs/vlms.md`: a share of the answers that belongs to the
scene, questions that are always misread, answers of which the monitor is told something wrong.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import ceil

from tpvqa.bench.cell import Cell
from tpvqa_experiments.belief.parts import BELIEF, BLIND, DOMAIN_TASKS, FIELD, SYMBOLIC

LIMITS = "limits=none,replans=300"
"""Fifty times the plan's length for actions. Changes of plan have a limit, as a lead that misreads
a fact for ever plans anew for ever, without an action between."""
REDOING: Mapping[str, str] = {"free": LIMITS, "risky": f"{LIMITS},redo=risky"}
"""What comes of doing again what is done, and the condition that says so."""
KNOWS: Mapping[str, str] = {
    "free": f"{BELIEF}:spontaneous_rate=0:redone_rate=0",
    "risky": f"{BELIEF}:spontaneous_rate=0",
}
"""The limit beside the belief monitor: the same, calibrated on the very answers that it gets, and
told what no count of faults tells for sure: that nothing works loose of itself, and, where redoing
is free, that it undoes nothing."""
CALIBRATED = "oracle:0.8"
"""What monitors are told where they are told something wrong, and the fresh errors."""
RISKS = (0.02, 0.05)
"""Bounds on the share of trials that end in a wrong *done*."""
AFTER, JUDGED = 20, 5
"""Trials of experience, and those after them in which it must have helped."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Noise:
    """A kind of VLM, and what the belief monitor must reach under it.

    Attributes:
        name: In the words of the tables.
        vlm: Its specification.
        believed: The VLM that monitors take it for; empty where they are calibrated on its own.
        completion: Least completion rate in every task; None for none.
        questions: Most questions of a trial, in the mean; None for none.
        wrong: Most trials that end in *done* with the goal false; None for none.
        behind_blind: How far completion may be behind the best blind repetition; None where
            that is no measure.
        today: Whether to compare with what was reached under fresh errors before errors that last
            were known of.
        limit: Whether who knows how its answers err is run beside ours.
    """

    name: str
    vlm: str
    believed: str = ""
    completion: float | None = None
    questions: float | None = None
    wrong: float | None = None
    behind_blind: float | None = None
    today: bool = False
    limit: bool = False

    def cell(self, task: str, monitor: str, redo: str) -> Cell:
        """The cell of a task and monitor, where redoing is as said.

        Who never looks does the same whatever would answer, so it has one cell for all noises.

        Args:
            task: A shipped task.
            monitor: Its specification.
            redo: One of `REDOING`.
        """
        condition = REDOING[redo]
        if monitor in BLIND:
            return Cell(task, monitor, CALIBRATED, SYMBOLIC, condition)
        if self.believed and monitor != KNOWS[redo]:
            condition += f",believed={self.believed}"
        return Cell(task, monitor, self.vlm, SYMBOLIC, condition)


NOISES = (
    Noise(name="constant in a scene, .95", vlm="oracle:0.95:0:1", completion=0.97, questions=200),
    Noise(name="constant in a scene, .8", vlm="oracle:0.8:0:1", completion=0.85, questions=200),
    Noise(name="lasting share .74, .8", vlm="oracle:0.8:0:0.74"),
    Noise(name="10% always misread", vlm="flawed:misread:0.1:0.95", completion=0.90),
    Noise(
        name="useless, calibrated at .8",
        vlm="flawed:useless:0.8",
        believed=CALIBRATED,
        questions=50,
        behind_blind=0.02,
        limit=True,
    ),
    Noise(
        name="`on` biased, calibrated at .8",
        vlm="flawed:biased:on:0.9:0.5:0.8",
        believed=CALIBRATED,
        completion=0.95,
        wrong=0.03,
        limit=True,
    ),
    Noise(name="fresh, .8", vlm=CALIBRATED, today=True),
)
RECORDED_WRONG, RECORDED_QUESTIONS = 0.03, 300
"""Most under the recorded VLMs: wrong *done*, and questions of a trial."""
EXPERIENCED = 0.97
"""Completion to reach after `AFTER` trials in which the same questions were always misread."""


def recorded_noise(model: str) -> Noise:
    """A recorded model with errors that last as recorded, on one half of its problems."""
    return Noise(
        name=model,
        vlm=f"recorded:{model}:1:lasting",
        questions=RECORDED_QUESTIONS,
        wrong=RECORDED_WRONG,
        limit=True,
    )


def recorded_noises(models: Sequence[str], tasks: Sequence[str]) -> list[tuple[Noise, list[str]]]:
    """The recorded models, each with the tasks of its environments.

    Args:
        models: Which; all where none is named.
        tasks: Those that are run.
    """
    from tpvqa.vlm.recorded.answers import models as recorded_models

    return [
        (
            recorded_noise(model),
            [task for each in environments for task in DOMAIN_TASKS[each] if task in tasks],
        )
        for model, environments in recorded_models().items()
        if not models or model in models
    ]


def lasting_noises(models: Sequence[str], tasks: Sequence[str]) -> list[tuple[Noise, list[str]]]:
    """All noises with the tasks that are run under them; the recorded models last."""
    return [*((noise, list(tasks)) for noise in NOISES), *recorded_noises(models, tasks)]


def experienced(task: str, redo: str, draw: int) -> Cell:
    """A robot that keeps what it learned of a VLM that always misreads the same questions.

    Args:
        task: A shipped task.
        redo: One of `REDOING`.
        draw: Which questions these are.
    """
    condition = f"{REDOING[redo]},carried={AFTER + JUDGED}"
    return Cell(task, BELIEF, f"flawed:misread:0.1:0.95:same:{draw}", SYMBOLIC, condition)


def draws(episodes: int) -> range:
    """Which questions are always misread: a robot each, so many that they run as many trials."""
    return range(ceil(episodes / (AFTER + JUDGED)))


def lasting_cells(
    models: Sequence[str], tasks: Sequence[str], episodes: int
) -> Iterator[tuple[Cell, int]]:
    """The cells of ours and of all rivals under all noises, each with its number of episodes.

    Args:
        models: Recorded VLMs; all where none is named.
        tasks: Shipped tasks.
        episodes: Of every cell.
    """
    for redo in REDOING:
        for noise, own in lasting_noises(models, tasks):
            for task in own:
                limit = (KNOWS[redo],) if noise.limit else ()
                for monitor in (BELIEF, *limit, *BLIND, *FIELD):
                    yield noise.cell(task, monitor, redo), episodes
        for task in tasks:
            for draw in draws(episodes):
                yield experienced(task, redo, draw), AFTER + JUDGED
