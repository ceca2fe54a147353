"""How often actions failed and things came undone, in trials of which that is known."""

from collections import Counter
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from enum import StrEnum

from pydantic import ConfigDict, Field

from tpvqa.belief.answers.bounds import Counted
from tpvqa.told import ToldModel


class Came(StrEnum):
    """What truly came of an action."""

    SUCCESS = "success"
    FAILURE = "failure"
    IMPOSSIBLE = "impossible"  # a precondition did not hold
    ACHIEVED = "achieved"  # it had nothing left to do


@dataclass(frozen=True, slots=True)
class LabelledAct:
    """An action of a trial, and what truly came of it.

    Attributes:
        trial: The trial's name among others.
        action: The action's name.
        came: What came of it.
        undone: Whether something came undone by it; None where nothing could, or people did it.
        objects: What it was done with.
    """

    trial: str
    action: str
    came: Came
    undone: bool | None
    objects: tuple[str, ...] = ()


class _Told(ToldModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class SkillCount(_Told):
    """How often a skill failed where it could have worked.

    Attributes:
        failed: How often.
        worked: How often it did not.
        together: In how many trials so many tries with the same objects failed, and so many
            worked: (failed, worked, trials). Nothing in older files.
    """

    failed: Counted = 0
    worked: Counted = 0
    together: tuple[tuple[Counted, Counted, Counted], ...] = ()

    @property
    def tries(self) -> int:
        """How often it was tried."""
        return self.failed + self.worked

    def at_most(self, cases: float) -> tuple[float, float]:
        """How often it failed, and worked, in so many tries, if it had no more."""
        fewer = min(cases / max(self.tries, 1), 1.0)
        return fewer * self.failed, fewer * self.worked


Cases = tuple[Counted, Counted]
"""For and against."""


class CountedFaults(_Told):
    """What was counted of faults.

    Attributes:
        skills: By the action's name; none of those that could never have worked.
        disturbance: Failures that have undone something, and that have not.
        spontaneous: Successes, likewise.
        redone: Actions that had nothing left to do, likewise.
    """

    skills: dict[str, SkillCount] = Field(default_factory=dict)
    disturbance: Cases = (0, 0)
    spontaneous: Cases = (0, 0)
    redone: Cases = (0, 0)

    def besides(self, stated: Collection[str]) -> "CountedFaults":
        """The same without the rates that somebody states: `failure`, `disturbance`, and so on."""
        nothing: dict[str, dict[str, object]] = {"failure": {"skills": {}}}
        left_out: dict[str, object] = {}
        for rate in stated:
            left_out |= nothing.get(rate, {rate: (0, 0)})
        return self.model_copy(update=left_out)


def count_faults(acts: Iterable[LabelledAct]) -> CountedFaults | None:
    """Count what came of actions; None where there were none."""
    told = list(acts)
    came = Counter((act.action, act.came) for act in told)
    undone = Counter((act.came, act.undone) for act in told)
    tried = {name for name, how in came if how in (Came.FAILURE, Came.SUCCESS)}

    def cases(*kinds: Came) -> Cases:
        yes, no = (sum(undone[kind, lost] for kind in kinds) for lost in (True, False))
        return yes, no

    found = CountedFaults(
        skills={
            name: SkillCount(
                failed=came[name, Came.FAILURE],
                worked=came[name, Came.SUCCESS],
                together=_together(act for act in told if act.action == name),
            )
            for name in sorted(tried)
        },
        disturbance=cases(Came.FAILURE, Came.IMPOSSIBLE),
        spontaneous=cases(Came.SUCCESS),
        redone=cases(Came.ACHIEVED),
    )
    return None if found == CountedFaults() else found


def _together(acts: Iterable[LabelledAct]) -> tuple[tuple[int, int, int], ...]:
    """In how many trials so many tries with the same objects failed, and so many worked."""
    came = Counter((act.trial, act.objects, act.came) for act in acts)
    tried = {each[:2] for each in came if each[2] in (Came.FAILURE, Came.SUCCESS)}
    trials = Counter((came[*each, Came.FAILURE], came[*each, Came.SUCCESS]) for each in tried)
    return tuple((*tries, often) for tries, often in sorted(trials.items()))
