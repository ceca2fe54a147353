"""How often actions failed and things came undone, in trials of which that is known."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from enum import StrEnum

from pydantic import ConfigDict, Field

from tpvqa.belief.bounds import Counted
from tpvqa.told import ToldModel


class Came(StrEnum):
    """What truly came of an action; the names are those of `Belief.outcome_shares`."""

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
    """

    trial: str
    action: str
    came: Came
    undone: bool | None


class _Told(ToldModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class SkillCount(_Told):
    """How often a skill failed where it could have worked.

    Attributes:
        failed: How often.
        worked: How often it did not.
    """

    failed: Counted = 0
    worked: Counted = 0

    @property
    def tries(self) -> int:
        """How often it was tried."""
        return self.failed + self.worked


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
    failed: dict[str, int] = {}
    worked: dict[str, int] = {}
    undone: dict[Came, list[bool]] = {came: [] for came in Came}
    for act in acts:
        if act.came is Came.FAILURE:
            failed[act.action] = failed.get(act.action, 0) + 1
        elif act.came is Came.SUCCESS:
            worked[act.action] = worked.get(act.action, 0) + 1
        if act.undone is not None:
            undone[act.came].append(act.undone)
    disturbed = _cases(undone[Came.FAILURE] + undone[Came.IMPOSSIBLE])
    loose, again = _cases(undone[Came.SUCCESS]), _cases(undone[Came.ACHIEVED])
    skills = {
        name: SkillCount(failed=failed.get(name, 0), worked=worked.get(name, 0))
        for name in sorted({*failed, *worked})
    }
    if not (skills or sum(disturbed + loose + again)):
        return None
    return CountedFaults(skills=skills, disturbance=disturbed, spontaneous=loose, redone=again)


def _cases(seen: list[bool]) -> Cases:
    return sum(seen), len(seen) - sum(seen)
