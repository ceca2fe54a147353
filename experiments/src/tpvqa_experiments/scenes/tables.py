"""The tables of the bench of scenes."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from statistics import fmean, median
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tpvqa.chance import chance_array
from tpvqa.vlm.metrics import calibration_error
from tpvqa_experiments.belief.check import Check
from tpvqa_experiments.belief.markdown import rate, table, targets_markdown
from tpvqa_experiments.belief.resampling import Estimate
from tpvqa_experiments.scenes.judged import HELD, Judged, reliability
from tpvqa_experiments.scenes.recorded import ENVIRONMENT
from tpvqa_experiments.scenes.ridge import Array
from tpvqa_experiments.scenes.weighing import Weighing

ALL = "all"
RIGHT, CALIBRATION, WITHIN = 0.51, 0.05, 0.93
RESAMPLES = 1000


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """The scenes of one VLM and split; `all` for every one.

    Attributes:
        as_answered: Share of scenes in which every answer was right.
        naive: Share in which the state that the naive rival puts first is the true one.
        belief: The same of the belief.
        calibration_error: Expected calibration error of the probability of the belief's first.
        naive_calibration_error: The same of the naive rival's.
        states: How many states hold .95 of the belief, in the median scene.
        most_states: The same in the mean.
        within: Share of scenes whose true state is among them.
    """

    environment: str
    split: str
    model: str
    scenes: int
    as_answered: float
    naive: float
    belief: float
    calibration_error: float
    naive_calibration_error: float
    states: float
    most_states: float
    within: float

    def flat(self) -> dict[str, Any]:
        """As one row of plain values."""
        return asdict(self)


def lines(judged: Sequence[Judged]) -> list[Line]:
    """A line for every VLM and split, each VLM, each split, and all."""
    models = [*sorted({each.scene.model for each in judged}), ALL]
    splits = [*dict.fromkeys(each.scene.split for each in by_size(judged)), ALL]
    found = []
    for model in models:
        for split in splits:
            own = of(judged, model, split)
            if own:
                found.append(_line(own, model, split))
    return found


def of(judged: Sequence[Judged], model: str, split: str = ALL) -> list[Judged]:
    """The scenes of one VLM and split; `all` for every one."""
    return [
        each
        for each in judged
        if model in (ALL, each.scene.model) and split in (ALL, each.scene.split)
    ]


def by_size(judged: Sequence[Judged]) -> list[Judged]:
    """The scenes with the fewest arrangements first."""
    return sorted(judged, key=lambda each: each.scene.shape.arrangements)


def _line(own: Sequence[Judged], model: str, split: str) -> Line:
    columns = _Columns.of(own)
    return Line(
        environment=ENVIRONMENT,
        split=split,
        model=model,
        scenes=len(own),
        as_answered=_answered(columns),
        naive=_naive(columns),
        belief=_belief(columns),
        calibration_error=_calibration(columns),
        naive_calibration_error=reliability([each.naive for each in own]),
        states=median(each.belief.states for each in own),
        most_states=fmean(each.belief.states for each in own),
        within=_within(columns),
    )


@dataclass(frozen=True, slots=True)
class _Columns:
    """What came of many scenes, a place each."""

    answered: NDArray[np.bool_]
    naive: NDArray[np.bool_]
    right: NDArray[np.bool_]
    sure: Array
    within: NDArray[np.bool_]

    @classmethod
    def of(cls, judged: Sequence[Judged]) -> "_Columns":
        return cls(
            np.array([each.scene.as_answered for each in judged]),
            np.array([each.naive.right for each in judged]),
            np.array([each.belief.right for each in judged]),
            np.array([each.belief.sure for each in judged]),
            np.array([each.belief.within for each in judged]),
        )

    def at(self, places: NDArray[np.int64]) -> "_Columns":
        return _Columns(*(getattr(self, name)[places] for name in self.__slots__))


Figure = Callable[[_Columns], float]


def _answered(own: _Columns) -> float:
    return float(own.answered.mean())


def _naive(own: _Columns) -> float:
    return float(own.naive.mean())


def _belief(own: _Columns) -> float:
    return float(own.right.mean())


def _gain(own: _Columns) -> float:
    return _belief(own) - _naive(own)


def _calibration(own: _Columns) -> float:
    return calibration_error(own.sure, own.right) or 0.0


def _within(own: _Columns) -> float:
    return float(own.within.mean())


def targets(judged: Sequence[Judged], seed: int) -> list[Check]:
    """Every figure beside what it must be.

    A target from below is reached when the upper end of the 95% interval reaches it, one from
    above when the lower end does. Problems are resampled, as all VLMs saw the same pictures.
    """

    def estimate(figure: Figure) -> Estimate:
        return _estimate(figure, judged, seed)

    right, error, within = (estimate(figure) for figure in (_belief, _calibration, _within))
    floor = perfect_error(judged, seed)
    found = [
        _least("all", "whole state right", right, RIGHT),
        Check("all", "whole state right, naive", "–", estimate(_naive), None),
        Check("all", "whole state right, as answered", "–", estimate(_answered), None),
        Check(
            "all",
            "calibration error",
            f"≤ {rate(CALIBRATION)}",
            error,
            error.low <= CALIBRATION,
            f"a perfect one would show {rate(floor)} on so many scenes",
        ),
        _least("all", f"truth in the {rate(HELD)} set", within, WITHIN),
    ]
    for line in lines(judged):
        if line.model != ALL:
            own = of(judged, line.model, line.split)
            name = line.model if line.split == ALL else f"{line.model}, {line.split}"
            gain = _estimate(_gain, own, seed)
            note = "" if gain.value >= -1e-9 or gain.high < 0 else "below, within the interval"
            found.append(_least(name, "above naive", gain, 0.0, note))
    return found


def _least(condition: str, what: str, found: Estimate, target: float, note: str = "") -> Check:
    return Check(condition, what, f"≥ {rate(target)}", found, found.high >= target, note)


def _estimate(figure: Figure, own: Sequence[Judged], seed: int) -> Estimate:
    columns = _Columns.of(own)
    _, group = np.unique([each.scene.problem for each in own], return_inverse=True)
    members = [np.flatnonzero(group == k) for k in range(group.max() + 1)]
    rng = chance_array(seed, 0, "resampled problems")
    drawn = [
        figure(columns.at(np.concatenate([members[k] for k in chosen])))
        for chosen in rng.integers(len(members), size=(RESAMPLES, len(members)))
    ]
    low, high = np.quantile(drawn, [0.025, 0.975])
    return Estimate(figure(columns), float(low), float(high))


def perfect_error(judged: Sequence[Judged], seed: int) -> float:
    """The calibration error that would be measured if every probability were true.

    It is not 0: a few scenes in a bin are not right as often as they should be.
    """
    rng = chance_array(seed, 0, "perfectly calibrated")
    sure = np.array([each.belief.sure for each in judged])
    return fmean(
        calibration_error(sure, rng.random(len(sure)) < sure) or 0.0 for _ in range(RESAMPLES)
    )


def markdown(
    judged: Sequence[Judged], weighings: Sequence[Weighing], checks: Sequence[Check]
) -> str:
    """All tables as a page."""
    return "".join(_page(judged, weighings, checks))


def _page(
    judged: Sequence[Judged], weighings: Sequence[Weighing], checks: Sequence[Check]
) -> Iterator[str]:
    yield "# Scenes: the whole state from one look\n\n"
    yield (
        f"{len(judged)} scenes of {ENVIRONMENT} before the first action, one of every VLM and "
        "picture; learned on one half of the problems, judged on the other, both ways.\n\n"
    )
    yield table(
        (
            *("VLM", "split", "scenes", "as answered", "naive", "belief"),
            *("calibration error", f"states of the {rate(HELD)} set", "truth in it"),
        ),
        [
            (
                *(line.model, line.split, str(line.scenes)),
                *(rate(line.as_answered), rate(line.naive), rate(line.belief)),
                rate(line.calibration_error),
                f"{line.states:g} (mean {line.most_states:.0f})",
                rate(line.within),
            )
            for line in lines(judged)
        ],
    )
    yield "\nWhat on, incolumn and clear are raised to; pictures whose answers are worth less:\n\n"
    yield table(
        ("half", "exponents", "share", "of that"),
        [
            (
                str(number),
                ", ".join(f"{each:g}" for each in own.exponents),
                f"{own.share:g}",
                f"{own.dulled:g}",
            )
            for number, own in enumerate(weighings, start=1)
        ],
    )
    yield "\n## Targets\n\n"
    yield targets_markdown(checks)
