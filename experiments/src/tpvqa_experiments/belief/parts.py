"""The cells of every part of the belief bench."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum

from tpvqa.belief.filtering.ablations import PARTS
from tpvqa.bench.cell import Cell
from tpvqa_experiments.paper import TASKS

BELIEF = "belief"
VOTES = ("tpvqa", "tpvqa:3", "tpvqa:5", "tpvqa:strict", "tpvqa:3:strict", "tpvqa:5:strict")
BASELINES = ("effectvqa", "palmevqa", "successvqa", "tp")
RIVALS = (*VOTES, *BASELINES)
RECORDED_RIVALS = ("tpvqa", "tpvqa:3", "tpvqa:5", "tp")
BLIND = ("blind:1", "blind:2", "blind:3", "blind:5", "blind:8")
FIELD = (
    *("tpvqa", "tpvqa:strict", "tpvqa:5", "vote:5", "lead:2", "lead:3", "lead:4", "lead:6"),
    *("effectvqa", "effectvqa:strict"),
)
"""Rivals that look, in their best readings; with `BLIND` those of the part `rivals`."""
RECORDED_FIELD = ("tpvqa", "vote:5", "lead:2", "lead:4", "effectvqa")
FIELD_VLMS = ("oracle:0.8", "oracle:0.95", "embedded")
UNBOUND = ("limits=none", "limits=none,redo=risky")
"""Limits that do not bind, where redoing what is done is free, and where it is risky."""
ACCURACIES = (0.6, 0.7, 0.8, 0.9, 0.95)
RHOS = (0.0, 0.5)
PRICES = (10.0, 3.0, 2.0, 1.0, 0.3, 0.1, 0.03, 0.003)
"""Costs of a question along the curve; that of `belief` itself lies between."""
ABLATED = ((0.6, 0.0), (0.8, 0.0), (0.95, 0.0), (0.8, 0.5))
"""Accuracies, each with the chance that a further look repeats the last answer, at which parts are
left out: those for which the target table names a completion rate."""
TRUE_RATES = ("failure=0.1", "failure=0.4", "disturbance=0.5", "spontaneous=0.05")
"""What holds in truth where the action model is wrong; each is believed to be its default."""
WRONG_MODEL_VLM = "oracle:0.8"
WRONG_VLM = "oracle:0.7"
BELIEVED = "oracle:0.9"
"""What `WRONG_VLM` is taken for at first."""
CHAIN = 30
"""Episodes through which what was learned is passed on."""
LEARNING, KNOWING = f"believed={BELIEVED},carried={CHAIN}", f"carried={CHAIN}"
"""Robots that have to learn that, and robots that were told."""
SYMBOLIC = "symbolic"
DOMAIN_TASKS = {
    "blocksworld": ("build_tower",),
    "igibson": ("clean_dishes", "serve_breakfast", "eat_apple"),
}
"""The tasks of each environment of the recorded VLMs."""


class Part(StrEnum):
    """A part of the bench; each can be run by itself."""

    GRID = "grid"
    RIVALS = "rivals"
    PAPER = "paper"
    EMBEDDED = "embedded"
    RECORDED = "recorded"
    WRONG_MODEL = "wrong-model"
    WRONG_VLM = "wrong-vlm"
    ABLATIONS = "ablations"
    LASTING = "lasting"


@dataclass(frozen=True, slots=True, kw_only=True)
class Extent:
    """How much of each part is run.

    Attributes:
        tasks: Shipped tasks; of the recorded VLMs those that belong to their environments.
        accuracies: Of the grid's noise models.
        rhos: Chances that a further look repeats the last answer.
        prices: Costs of a question along the curve.
        models: Recorded VLMs.
        episodes: Of every cell of the belief monitor.
        rivals: Of every cell of another monitor; half of it where recorded VLMs answer in the
            part of that name.
        curve: Episodes of every further point of the curve.
        chains: Robots that learn how good their VLM is, for `CHAIN` episodes each.
        lasting: Episodes of every cell under errors that last, ours or a rival's.
    """

    tasks: Sequence[str] = (*TASKS, "build_tower")
    accuracies: Sequence[float] = ACCURACIES
    rhos: Sequence[float] = RHOS
    prices: Sequence[float] = PRICES
    models: Sequence[str] = ()
    episodes: int = 1000
    rivals: int = 200
    curve: int = 100
    chains: int = 30
    lasting: int = 300

    def cells(self, part: Part) -> Iterator[tuple[Cell, int]]:
        """The cells of a part, each with its number of episodes."""
        from tpvqa_experiments.belief.lasting import lasting_cells

        match part:
            case Part.GRID:
                for vlm in self.vlms(self.accuracies):
                    yield from self._against(vlm, SYMBOLIC)
                    for price in self.prices:
                        for task in self.household:
                            yield Cell(task, priced(price), vlm, SYMBOLIC), self.curve
            case Part.RIVALS:
                yield from self._field()
            case Part.PAPER:
                yield from self._against("paper-table", SYMBOLIC)
            case Part.EMBEDDED:
                yield from self._against("embedded", "images")
            case Part.RECORDED:
                for model, environment in self._recorded():
                    for task in DOMAIN_TASKS[environment]:
                        if task in self.tasks:
                            for monitor in (BELIEF, *RECORDED_RIVALS):
                                cell = Cell(task, monitor, recorded(model), SYMBOLIC)
                                yield cell, self._count(monitor)
            case Part.WRONG_MODEL:
                for rate in TRUE_RATES:
                    for monitor in (BELIEF, knowing(rate)):
                        for task in self.household:
                            cell = Cell(task, monitor, WRONG_MODEL_VLM, SYMBOLIC, rate)
                            yield cell, self.episodes
            case Part.WRONG_VLM:
                for condition in (LEARNING, KNOWING):
                    for task in self.household:
                        cell = Cell(task, BELIEF, WRONG_VLM, SYMBOLIC, condition)
                        yield cell, CHAIN * self.chains
            case Part.ABLATIONS:
                for vlm in (noise(*each) for each in self.ablated):
                    for monitor in (BELIEF, *map(without, PARTS)):
                        for task in self.household:
                            yield Cell(task, monitor, vlm, SYMBOLIC), self.episodes
            case Part.LASTING:
                yield from lasting_cells(self.models, self.tasks, self.lasting)

    @property
    def household(self) -> list[str]:
        """The tasks of the paper among those that are run."""
        return [task for task in self.tasks if task in TASKS]

    def vlms(self, accuracies: Sequence[float]) -> list[str]:
        """The grid's noise models of some accuracies."""
        return [noise(accuracy, rho) for rho in self.rhos for accuracy in accuracies]

    @property
    def ablated(self) -> list[tuple[float, float]]:
        """Accuracies and chances to repeat themselves under which parts are left out."""
        return [(p, rho) for p, rho in ABLATED if p in self.accuracies and rho in self.rhos]

    def _against(self, vlm: str, world: str) -> Iterator[tuple[Cell, int]]:
        for monitor in (BELIEF, *RIVALS):
            for task in self.household:
                yield Cell(task, monitor, vlm, world), self._count(monitor)

    def _count(self, monitor: str) -> int:
        return self.episodes if monitor == BELIEF else self.rivals

    def _field(self) -> Iterator[tuple[Cell, int]]:
        """All rivals under limits that do not bind; as many episodes of ours as of theirs."""
        for condition in UNBOUND:
            for task in self.tasks:
                for monitor in BLIND:
                    cell = Cell(task, monitor, FIELD_VLMS[0], SYMBOLIC, condition)
                    yield cell, self.rivals
                for vlm in FIELD_VLMS:
                    if vlm == "embedded" and task not in self.household:
                        continue
                    world = "images" if vlm == "embedded" else SYMBOLIC
                    for monitor in (BELIEF, *FIELD):
                        yield Cell(task, monitor, vlm, world, condition), self.rivals
            for model, environment in self._recorded():
                for task in DOMAIN_TASKS[environment]:
                    if task in self.tasks:
                        for monitor in (BELIEF, *RECORDED_FIELD):
                            yield (
                                Cell(task, monitor, recorded(model), SYMBOLIC, condition),
                                self.rivals // 2,
                            )

    def _recorded(self) -> Iterator[tuple[str, str]]:
        from tpvqa.vlm.recorded.answers import models

        for model, environments in models().items():
            if not self.models or model in self.models:
                for environment in environments:
                    yield model, environment


def noise(accuracy: float, rho: float) -> str:
    """The noise model of an accuracy and a chance to repeat itself."""
    return f"oracle:{accuracy:g}:{rho:g}" if rho else f"oracle:{accuracy:g}"


def priced(price: float) -> str:
    """The belief monitor with another cost of a question."""
    return f"{BELIEF}:question={price:g}"


def without(name: str) -> str:
    """The belief monitor without one of its parts."""
    return f"{BELIEF}:without={name}"


def knowing(rate: str) -> str:
    """The belief monitor that believes a rate of faults as it truly is."""
    name, _, value = rate.partition("=")
    return f"{BELIEF}:{name}_rate={value}"


def recorded(model: str) -> str:
    """A recorded model on one half of its problems, whose errors are drawn afresh at every look."""
    return f"recorded:{model}:1:fresh"


def believes(monitor: str) -> bool:
    """Whether a monitor is the belief monitor, in any form."""
    return monitor.partition(":")[0] == BELIEF
