"""What the reports of a robot's skills are worth where no calibration tells, learned as it acts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from tpvqa.belief.calibrating.own_words import FAILED, SkillWorth, of_action

NOTICES, FALSE_ALARMS = 0.5, 0.05
"""Shares of its failures and of its successes that a robot's skill reports as failures, once one of
them has reported any."""
ALIKE = 2.0
"""Cases that these count for in the other skills, and what is known of the others in one."""
OF_OTHERS = 0.5
"""What a case of another skill counts for."""
REPORTED = 0.5
"""So many tries have to have been reported as failures, of those that could have worked."""


@dataclass(slots=True)
class _Cases:
    """Expected numbers of failures and successes, and of those that were reported as failures."""

    failed: float = 0.0
    noticed: float = 0.0
    worked: float = 0.0
    alarmed: float = 0.0

    def add(self, failed: float, worked: float, *, reported: bool) -> None:
        self.failed += failed
        self.worked += worked
        if reported:
            self.noticed += failed
            self.alarmed += worked

    def count(self, cases: "_Cases", weight: float) -> None:
        """Take in those of another skill."""
        self.failed += weight * cases.failed
        self.noticed += weight * cases.noticed
        self.worked += weight * cases.worked
        self.alarmed += weight * cases.alarmed

    def rates(self, notices: float, false_alarms: float, cases: float) -> tuple[float, float]:
        """How often failures and successes are reported as failures, drawn towards wider rates."""
        return (
            (self.noticed + cases * notices) / (self.failed + cases),
            (self.alarmed + cases * false_alarms) / (self.worked + cases),
        )


@dataclass(slots=True)
class Reports:
    """Weighs what skills report.

    Where nothing was calibrated, a reported failure counts as `FAILED`. That a skill reports none
    says nothing, as many robots never report any; but of a robot that has reported one it says
    something, the more so the fewer of its failures went unreported.

    Attributes:
        known: What was calibrated, or said.
    """

    known: Sequence[SkillWorth] = ()
    _own: dict[str, _Cases] = field(default_factory=dict)
    _latest: tuple[str, bool] | None = None

    def take(self, action: str, *, failed: bool | None) -> tuple[float, float] | None:
        """How probable a report is where the action worked, and where it failed; None where it
        says nothing.

        Args:
            action: The action's name.
            failed: Whether the skill reports a failure; None where it reports nothing.
        """
        self._latest = None if failed is None else (action, failed)
        if failed is None:
            return None
        known = of_action(self.known, action)
        if known is not None:
            return known.likelihoods(failed=failed)
        if sum(each.noticed + each.alarmed for each in self._own.values()) <= REPORTED:
            return FAILED if failed else None
        others = _Cases()
        for name, cases in self._own.items():
            if name != action:
                others.count(cases, OF_OTHERS)
        wider = others.rates(NOTICES, FALSE_ALARMS, ALIKE)
        notices, alarms = self._own.get(action, _Cases()).rates(*wider, ALIKE)
        alarms = min(alarms, notices)  # a report never speaks for the opposite
        return (alarms, notices) if failed else (1 - alarms, 1 - notices)

    def learn(self, shares: Mapping[str, float]) -> None:
        """Learn from how the action that was reported came out, see `Belief.outcome_shares`."""
        if self._latest is None:
            return
        (action, reported), self._latest = self._latest, None
        failed, worked = shares.get("failure", 0.0), shares.get("success", 0.0)
        self._own.setdefault(action, _Cases()).add(failed, worked, reported=reported)
