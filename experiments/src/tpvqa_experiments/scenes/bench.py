"""Runs the bench of scenes: learns on one half of the problems, judges on the other, both ways."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from tpvqa.bench.ledger import REMEDY
from tpvqa.chance import chance_array
from tpvqa.errors import BenchError, TpvqaError, UnknownNameError, WriteError
from tpvqa_experiments.scenes.arrangements import arrangements
from tpvqa_experiments.scenes.judged import Judged, Reading
from tpvqa_experiments.scenes.likelihood import Encoder, evidence, learn
from tpvqa_experiments.scenes.naive import learn_rates, naive_log_belief
from tpvqa_experiments.scenes.recorded import Scene, read_scenes
from tpvqa_experiments.scenes.results import write_results
from tpvqa_experiments.scenes.weighing import Sample, Weighing, choose

FOLDS = 6
"""Parts of the learning half; the weighing is chosen on each by what the others teach."""
Progress = Callable[[int, int], None]
"""Told how many scenes of how many were weighed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenesBench:
    """What to judge.

    Attributes:
        data: The folder of recorded scenes.
        models: VLMs; empty for all.
        seed: Decides which problems are in which half.
    """

    data: Path
    models: Sequence[str] = ()
    seed: int = 0


@dataclass(frozen=True, slots=True)
class Half:
    """What was learned on one half, and how the other one was judged by it."""

    weighing: Weighing
    judged: Sequence[Judged]


def run_scenes_bench(bench: ScenesBench, out: Path, *, progress: Progress) -> list[Judged]:
    """Judge every scene once, and write tables and figures.

    Raises:
        BenchError: The data are missing or damaged, or too few problems are in them.
        UnknownNameError: There is no such VLM among them.
        WriteError: The folder cannot be written to.
    """
    scenes, new = _of_models(read_scenes(bench.data), bench.models), not out.exists()
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise WriteError.of(out, error, REMEDY) from error
    try:
        halves = judge(scenes, bench.seed, progress)
    except TpvqaError:
        if new:
            out.rmdir()
        raise
    judged = [each for half in halves for each in half.judged]
    write_results(out, judged, [half.weighing for half in halves], bench.seed)
    return judged


def _of_models(scenes: Sequence[Scene], models: Sequence[str]) -> list[Scene]:
    known = sorted({scene.model for scene in scenes})
    for model in models:
        if model not in known:
            raise UnknownNameError("VLM of the recorded scenes", model, known)
    return [scene for scene in scenes if not models or scene.model in models]


def judge(scenes: Sequence[Scene], seed: int, progress: Progress) -> list[Half]:
    """Learn on each half of the problems and judge the other.

    One scene of every VLM and picture is judged: the same pictures were asked about in several
    runs.

    Raises:
        BenchError: A half has too few problems to learn from.
    """
    half_of = _parts(scenes, 2, seed, "half")
    judged = first_looks(scenes)
    ticks = _ticks(2 * len(judged), progress)
    encoder = Encoder.of(scenes)
    found = []
    for half in range(2):
        learning = [scene for scene in scenes if half_of[scene.problem] != half]
        own = [scene for scene in judged if half_of[scene.problem] == half]
        weighing = weigh(learning, seed, encoder, ticks)
        weights, rates = learn(learning, encoder), learn_rates(learning)
        read = []
        for scene in own:
            log_prior = arrangements(scene.shape).log_prior()
            belief = weighing.log_belief(evidence(scene, encoder, weights), log_prior)
            read.append(
                Judged(
                    scene,
                    naive=Reading.of(naive_log_belief(scene, rates), scene.truth),
                    belief=Reading.of(belief, scene.truth),
                )
            )
            next(ticks)
        found.append(Half(weighing, read))
    return found


def weigh(
    learning: Sequence[Scene], seed: int, encoder: Encoder, ticks: Iterator[None]
) -> Weighing:
    """The weighing that is best on scenes of the learning half, by cross-validation in it."""
    fold_of = _parts(learning, FOLDS, seed, "fold")
    rng = chance_array(seed, 0, "states of scenes")
    samples = []
    for fold in range(FOLDS):
        weights = learn([s for s in learning if fold_of[s.problem] != fold], encoder)
        for scene in first_looks(learning):
            if fold_of[scene.problem] == fold:
                samples.append(
                    Sample.of(
                        evidence(scene, encoder, weights),
                        arrangements(scene.shape).log_prior(),
                        scene.truth,
                        rng,
                    )
                )
                next(ticks)
    return choose(samples)


def first_looks(scenes: Sequence[Scene]) -> list[Scene]:
    """One scene before the first action of every VLM and problem: the plain runs' first, where
    there is one."""
    found: dict[tuple[str, str], Scene] = {}
    ordered = sorted(scenes, key=lambda scene: scene.setting != "no_cot")
    for scene in ordered:
        if scene.look == 0:
            found.setdefault((scene.model, scene.problem), scene)
    return list(found.values())


def _parts(scenes: Sequence[Scene], parts: int, seed: int, purpose: str) -> Mapping[str, int]:
    """The part of every problem; each split is dealt out evenly."""
    dealt: dict[str, int] = {}
    by_split: dict[str, set[str]] = {}
    for scene in scenes:
        by_split.setdefault(scene.split, set()).add(scene.problem)
    for split, problems in sorted(by_split.items()):
        listed = sorted(problems)
        order = chance_array(seed, 0, purpose, split).permutation(len(listed))
        dealt |= {listed[place]: (len(dealt) + k) % parts for k, place in enumerate(order)}
    if len(dealt) < 2 * FOLDS and purpose == "half":
        raise BenchError(
            f"There are {len(dealt)} problems of blocksworld in the data, and at least "
            f"{2 * FOLDS} are needed to learn on a half of them: name the whole folder with --data"
        )
    return dealt


def _ticks(total: int, progress: Progress) -> Iterator[None]:
    """Tells the progress one more with every step, without an end."""
    done = 0
    while True:
        done += 1
        progress(done, total)
        yield
