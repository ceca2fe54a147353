"""What the reports of a robot's skills are worth where no calibration tells, learned as it acts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from tpvqa.belief.own_words import FAILED, REPORTS, SkillWorth, of_action

NOTICES, FALSE_ALARMS = 0.5, 0.05
"""Shares of its failures and of its successes that a robot's skill reports as failures, once one of
them has reported any."""
ALIKE = 2.0
"""Cases of either kind that these count for."""


@dataclass(slots=True)
class _Cases:
    """Expected numbers of failures and successes, and of those that were reported as failures."""

    failed: float = 0.0
    noticed: float = 0.0
    worked: float = 0.0
    alarmed: float = 0.0

    def add(self, failed: float, worked: float, *, reported: bool) -> None:
        self.failed, self.worked = self.failed + failed, self.worked + worked
        self.noticed, self.alarmed = (
            self.noticed + failed * reported,
            self.alarmed + worked * reported,
        )

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
    _all: _Cases = field(default_factory=_Cases)
    _own: dict[str, _Cases] = field(default_factory=dict)
    _latest: tuple[str, bool] | None = None
    _speaks: bool = False

    def take(self, action: str, *, failed: bool) -> tuple[float, float] | None:
        """How probable a report is where the action worked, and where it failed; None where it
        says nothing.

        Args:
            action: The action's name.
            failed: Whether the skill reports a failure.
        """
        self._latest = action, failed
        self._speaks |= failed
        known = of_action(self.known, action)
        if known is not None:
            return known.likelihoods(failed=failed)
        if failed:
            return FAILED
        if not self._speaks:
            return None
        whole = self._all.rates(NOTICES, FALSE_ALARMS, ALIKE)
        own = self._own.get(action, _Cases())
        notices, alarms = own.rates(*whole, REPORTS)
        return 1 - min(alarms, notices), 1 - notices

    def learn(self, shares: Mapping[str, float]) -> None:
        """Learn from how the action that was reported came out, see `Belief.outcome_shares`."""
        if self._latest is None:
            return
        (action, reported), self._latest = self._latest, None
        failed, worked = shares.get("failure", 0.0), shares.get("success", 0.0)
        for cases in (self._all, self._own.setdefault(action, _Cases())):
            cases.add(failed, worked, reported=reported)
