"""What a monitor is told of the answers on ViPlan's problems: learnt from other problems."""

from collections.abc import Iterator, Mapping
from functools import cache
from math import ceil

from tpvqa.belief import LabelledAnswer
from tpvqa.belief.answers.kinds import FRESH, KINDS, Kind
from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.belief.calibrating.counted import CountedFaults, count_faults
from tpvqa.belief.calibrating.fitting import fit
from tpvqa.belief.calibrating.own_words import OwnWords
from tpvqa.bench.cell import Cell
from tpvqa.bench.labelled import gather
from tpvqa.bench.labelled_recordings import label_recordings
from tpvqa.bench.own_task import OwnTask
from tpvqa.config import TrialConfig
from tpvqa.errors import BenchError
from tpvqa.pddl import Task
from tpvqa.questions.question import Way
from tpvqa.vlm.answer import Reply
from tpvqa.vlm.recorded.lasting import Lasting
from tpvqa.vlm.recorded.spec import RecordedSpec
from tpvqa.vlm.recorded.vlm import told_by
from tpvqa_experiments.belief.calibrations import OTHER_SEEDS
from tpvqa_experiments.viplan.noise import PREDICATES
from tpvqa_experiments.viplan.scenes import Scene, scenes, true_facts

SCENES, RECORDED = "recorded-scenes", "recorded"
TWICE, TRIALS = "blind:2", 120
"""Who does the trials that faults are counted in, and how many there are at least."""
WAYS = (Way.PRECONDITION, Way.EFFECT)


def calibration(vlm: str, task: Task) -> Calibration | None:
    """What a monitor is told of a VLM's answers in a task; None where nothing was recorded of it.

    Of `recorded-scenes:MODEL` it is learnt from the initial scenes of every other problem, those
    with even numbers for odd ones and the other way round; of `recorded:MODEL` from the recorded
    answers.
    """
    name, _, arguments = vlm.partition(":")
    if name == SCENES:
        blocks = len(task.objects_by_type.get("block", ()))
        return _of_scenes(arguments, blocks, 1 - _number(task.name) % 2)
    if name == RECORDED:
        return _of_answers(vlm, task)
    return None


def counted(
    setting: str, common: TrialConfig, problems: Mapping[str, OwnTask]
) -> CountedFaults | None:
    """What a monitor is told of faults: counted in trials of other seeds, whose initial state is
    known and that do every step of a plan twice.

    Args:
        setting: How often actions fail, as a condition.
        common: Seed of the bench.
        problems: Those of a split, by name; each is run as often.

    Raises:
        TpvqaError: A trial cannot be run.
    """
    heard, seed = OwnWords(), common.seed + OTHER_SEEDS
    for name, own in problems.items():
        cell = Cell(name, TWICE, "oracle", "symbolic", setting)
        times = range(ceil(TRIALS / len(problems)))
        gather(cell, common.but(seed=seed), times, own=own, heard=heard)
    return count_faults(heard.acts)


def exact(vlm: str, task: Task) -> Calibration:
    """How the answers of a recorded VLM are drawn: its rates, and how its errors last, of the kinds
    that a belief tells apart the nearest.

    Raises:
        BenchError: Its answers are drawn in whole scenes, so that no rates say how.
    """
    name, _, arguments = vlm.partition(":")
    if name != RECORDED:
        raise BenchError(
            f"Nothing says exactly how {vlm} errs, as knowing has to be told. Say --noise recorded"
        )
    rates = _of_answers(vlm, task)
    spec = RecordedSpec.parse(arguments)
    lasts = spec.lasts(spec.told(task))
    if lasts is None:
        return rates.model_copy(update={"lasting": FRESH})
    near = min(KINDS, key=lambda kind: (kind.coin, *_apart(kind, lasts)))
    return rates.model_copy(update={"lasting": tuple(float(kind == near) for kind in KINDS)})


def _apart(kind: Kind, lasts: Lasting) -> tuple[float, float]:
    return abs(kind.share - lasts.scene), abs(kind.stays - lasts.trial)


@cache
def _of_scenes(model: str, blocks: int, parity: int) -> Calibration:
    told = [
        scene
        for scene in scenes(model)
        if scene.initial and sum(scene.heights) == blocks and _number(scene.problem) % 2 == parity
    ]
    rows = [row for scene in told for row in _labelled(scene)]
    return fit(rows, f"{SCENES}:{model}", chosen_looks=False)


def _labelled(scene: Scene) -> Iterator[LabelledAnswer]:
    """Every answer of a scene, at two looks, as it is the same at every look."""
    true = true_facts(scene.columns)
    for way in WAYS:
        for look in range(2):
            for fact, yes in scene.answers.items():
                yield LabelledAnswer(
                    way=way,
                    predicate=fact[0],
                    text=" ".join(fact),
                    truth=fact in true,
                    reply=Reply.YES if yes else Reply.NO,
                    p_yes=None,
                    trial=f"{scene.problem} {way}",
                    look=look,
                    weight=0.5,
                )


def _of_answers(vlm: str, task: Task) -> Calibration:
    told = told_by(vlm.removeprefix(f"{RECORDED}:"), task)
    predicates = PREDICATES if "block" in task.objects_by_type else task.fluents
    groups = {(way, predicate) for way in WAYS for predicate in predicates}
    return fit(label_recordings(told, groups), vlm, chosen_looks=False)


def _number(problem: str) -> int:
    digits = problem.rpartition("_")[2]
    return int(digits) if digits.isdecimal() else 0
