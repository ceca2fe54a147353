"""What a robot's own words are worth: the readings of its sensors, the reports of its skills."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated

from pydantic import ConfigDict, Field

from tpvqa.belief.answers.bounds import BOUND, EDGE, Counted
from tpvqa.belief.calibrating.counted import LabelledAct
from tpvqa.told import ToldModel

FAILED = (0.1, 0.9)
"""How probable it is that a skill reports a failure where it worked, and where it failed, as long
as nothing is known of it; that it reports none says nothing then, until one is reported
(`reports`)."""
READINGS = 15
"""Readings that a sensor's own word counts for, of what is true and of what is not."""
REPORTS = 4
"""Cases that what is known of all skills counts for in one, and the default in all."""
_NOTICES, _FALSE_ALARMS = 0.09, 0.01
"""The default as rates: a reported failure counts as above, and no report as next to nothing."""

Share = Annotated[float, Field(gt=0, lt=1)]
LEAST = 1e-6
"""No report or reading is rarer than this, and those of no sensor are less sure of themselves."""


class _Worth(ToldModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class SensorWorth(_Worth):
    """What readings of the facts of a predicate are worth.

    Attributes:
        predicate: The predicate.
        rows: Readings that it was learnt from.
        says_if_true: Share of readings that say that a fact holds, where it does.
        says_if_false: The same where it does not.
        surely: Mean size of the log odds that readings give themselves.
    """

    predicate: str
    rows: Counted
    says_if_true: Share
    says_if_false: Share
    surely: float = Field(ge=LEAST)

    def log_ratio(self, probability: float) -> float:
        """What a reading is worth: a surer one more, in proportion."""
        own = _log_odds(probability)
        if own > 0:
            learnt = math.log(self.says_if_true / self.says_if_false)
        else:
            learnt = math.log((1 - self.says_if_true) / (1 - self.says_if_false))
        return _bounded(abs(own) / self.surely * learnt)


def at_its_word(probability: float) -> float:
    """What a reading is worth of which nothing else is known, as a log likelihood ratio."""
    return _bounded(_log_odds(probability))


class SkillWorth(_Worth):
    """What the reports of a skill are worth.

    Attributes:
        action: The action's name; None for all.
        rows: Actions that it was learnt from.
        notices: Share of its failures that the skill reports.
        false_alarms: Share of its successes that it reports as failures.
    """

    action: str | None = None
    rows: Counted = 0
    notices: Share
    false_alarms: Share

    def likelihoods(self, *, failed: bool) -> tuple[float, float]:
        """How probable a report is where the action worked, and where it failed."""
        if failed:
            return self.false_alarms, self.notices
        return 1 - self.false_alarms, 1 - self.notices


@dataclass(frozen=True, slots=True)
class LabelledReading:
    """A reading beside the truth. Those of one fact between two actions are one."""

    predicate: str
    probability: float
    truth: bool


@dataclass(frozen=True, slots=True)
class LabelledReport:
    """A skill's report beside what came of the action."""

    action: str
    reported: bool
    failed: bool


@dataclass(frozen=True, slots=True)
class OwnWords:
    """What a robot said itself in some trials, beside the truth, and what came of what it did.

    Attributes:
        readings: Of its sensors.
        reports: Of its skills.
        acts: What came of its actions.
    """

    readings: list[LabelledReading] = field(default_factory=list)
    reports: list[LabelledReport] = field(default_factory=list)
    acts: list[LabelledAct] = field(default_factory=list)

    def add(self, more: "OwnWords") -> None:
        """Take in those of another trial."""
        self.readings.extend(more.readings)
        self.reports.extend(more.reports)
        self.acts.extend(more.acts)


def fit_sensors(readings: Iterable[LabelledReading]) -> tuple[SensorWorth, ...]:
    """Learn what readings are worth, by predicate.

    Sensors of different facts have nothing in common, so the rates of each are drawn towards what
    its own readings claim, by `READINGS` of them. A sensor never speaks for the opposite of what
    it says.
    """
    found: dict[str, list[LabelledReading]] = {}
    for row in readings:
        if row.probability != 0.5:
            found.setdefault(row.predicate, []).append(row)
    return tuple(_sensor(predicate, rows) for predicate, rows in sorted(found.items()))


def _sensor(predicate: str, rows: Sequence[LabelledReading]) -> SensorWorth:
    claims = 1 / (1 + math.exp(-sum(abs(at_its_word(r.probability)) for r in rows) / len(rows)))
    says = {True: claims * READINGS, False: (1 - claims) * READINGS}
    count = {True: float(READINGS), False: float(READINGS)}
    for row in rows:
        count[row.truth] += 1
        says[row.truth] += row.probability > 0.5
    if_true, if_false = (says[truth] / count[truth] for truth in (True, False))
    if if_true < if_false:
        if_true = if_false = (says[True] + says[False]) / (count[True] + count[False])
    return SensorWorth(
        predicate=predicate,
        rows=len(rows),
        says_if_true=_inside(if_true),
        says_if_false=_inside(if_false),
        surely=round(sum(abs(_log_odds(row.probability)) for row in rows) / len(rows), 6),
    )


def fit_skills(reports: Iterable[LabelledReport]) -> tuple[SkillWorth, ...]:
    """Learn what skills' reports are worth: of all first, then by action.

    Of skills that never report a failure nothing is learnt: that is what is taken of any skill of
    which nothing is known.
    """
    rows = list(reports)
    if not any(row.reported for row in rows):
        return ()
    whole = _skill(None, rows, _NOTICES, _FALSE_ALARMS)
    own = (
        _skill(name, [r for r in rows if r.action == name], whole.notices, whole.false_alarms)
        for name in sorted({row.action for row in rows})
    )
    return (whole, *own)


def _skill(
    action: str | None, rows: Sequence[LabelledReport], notices: float, false_alarms: float
) -> SkillWorth:
    def share(wider: float, *, failed: bool) -> float:
        reported = [row.reported for row in rows if row.failed == failed]
        return _inside((sum(reported) + REPORTS * wider) / (len(reported) + REPORTS))

    found = share(notices, failed=True), share(false_alarms, failed=False)
    alarms, noticed = min(found), max(found)  # a report never speaks for the opposite
    if found[0] < found[1]:
        alarms = noticed = sum(found) / 2
    return SkillWorth(action=action, rows=len(rows), notices=noticed, false_alarms=alarms)


def _inside(share: float) -> float:
    """A share in six digits; however many were counted, none is impossible."""
    return round(min(max(share, LEAST), 1 - LEAST), 6)


def of_action(skills: Sequence[SkillWorth], action: str) -> SkillWorth | None:
    """What is known of a skill, or else of all; None where nothing is."""
    known: Mapping[str | None, SkillWorth] = {each.action: each for each in skills}
    return known.get(action, known.get(None))


def _log_odds(probability: float) -> float:
    p = min(max(probability, EDGE), 1 - EDGE)
    return math.log(p / (1 - p))


def _bounded(ratio: float) -> float:
    return min(max(ratio, -BOUND), BOUND)
