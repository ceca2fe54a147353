"""What `belief:KEY=VALUE:…` says: other costs, other beliefs about faults, a part to leave out."""

from dataclasses import dataclass, field
from typing import Self

from pydantic import ValidationError

from tpvqa.belief.answers.other_words import OtherWords
from tpvqa.belief.calibrating.counted import CountedFaults
from tpvqa.belief.calibrating.own_words import SkillWorth
from tpvqa.belief.costs import Costs
from tpvqa.belief.filtering.ablations import PARTS
from tpvqa.belief.filtering.faults import Rates
from tpvqa.belief.learning.chances import Chances
from tpvqa.belief.learning.experience import Experience
from tpvqa.errors import PluginError, suggestion
from tpvqa.monitors.stated_risk import risk_from
from tpvqa.told import first_fault

_RATES = ("failure_rate", "disturbance_rate", "spontaneous_rate", "redone_rate")
_REPORTS = ("notices", "false_alarms")
_RARELY = 0.01
"""Successes that a skill is taken to report as failures, where only `notices` is given."""


@dataclass(frozen=True, slots=True)
class BeliefSettings:
    """How a belief monitor weighs things.

    Attributes:
        costs: What things cost.
        rates: What is believed about faults beforehand.
        stated: Which of these rates somebody stated, by name: what is calibrated does not count.
        skill: What the report of any skill is worth; None for what is calibrated, or else learned.
        without: One of `belief.ablations.PARTS`, to be left out.
        risk: The share of all trials that may end in "done" with the goal false; None for any.
        words: How often what lasts of the answers is the same in other words; None to learn it.
    """

    costs: Costs = field(default_factory=Costs)
    rates: Rates = field(default_factory=Rates)
    skill: SkillWorth | None = None
    without: str | None = None
    risk: float | None = None
    words: float | None = None
    stated: frozenset[str] = frozenset()

    def chances(self, counted: CountedFaults | None, experience: Experience | None) -> Chances:
        """How often faults are expected.

        Args:
            counted: What was counted in other trials; what is stated goes before it.
            experience: What was learned in earlier trials; goes before both.
        """
        counted = None if counted is None else counted.besides(self.stated)
        if experience is None:
            return Chances(self.rates, counted=counted)
        return experience.chances(self.rates, counted)

    @property
    def other_words(self) -> OtherWords:
        """How far the wordings of a question err alike, before any answer."""
        return OtherWords(self.words)

    @classmethod
    def parse(cls, arguments: str) -> Self:
        """Read `question=0.05:failure=200`.

        Also understood: `failure_rate`, `disturbance_rate`, `spontaneous_rate` and `redone_rate`,
        believed beforehand; `notices` and `false_alarms`, the shares of its failures and of its
        successes that a skill reports as failures; `without=PART`; `risk=0.02`; `words=0.5`, how
        often what lasts of the answers is the same in another wording of a question.

        Raises:
            PluginError: Something is unknown, or no fitting number.
        """
        given: dict[str, str] = {}
        for part in arguments.split(":") if arguments else []:
            key, _, value = part.partition("=")
            if key.strip() in given:
                raise PluginError(f"'belief:{arguments}': {key.strip()} is given twice")
            given[key.strip()] = value.strip()
        without = given.pop("without", None)
        stated = given.pop("risk", None)
        risk = None if stated is None else risk_from(stated, f"belief:{arguments}")
        if without is not None and without not in PARTS:
            raise PluginError(
                f"'belief:{arguments}': what can be left out is {', '.join(PARTS)}, not {without!r}"
            )
        try:
            believed = {
                key.removesuffix("_rate"): float(given.pop(key)) for key in _RATES if key in given
            }
            if not all(0 <= rate <= 1 for rate in believed.values()):
                raise ValueError("a rate lies between 0 and 1")
            words = float(given.pop("words")) if "words" in given else None
            if words is not None and not 0 <= words <= 1:
                raise ValueError("words, a share, lies between 0 and 1")
            reports = {key: float(given.pop(key)) for key in _REPORTS if key in given}
            costs = Costs.model_validate(given)
        except ValidationError as error:
            first = first_fault(error)
            where = ".".join(map(str, first["loc"]))
            known = (*Costs.model_fields, *_RATES, *_REPORTS, "without", "risk", "words")
            what = (
                f"there is no cost {where!r}{suggestion(where, known).rstrip('.')}"
                if where not in Costs.model_fields
                else first["msg"]
            )
            raise PluginError(
                f"'belief:{arguments}' is not understood: {where}: {what.rstrip('?')}"
                f"{'?' if what.endswith('?') else '.'} Costs are "
                f"{', '.join(Costs.model_fields)}; write belief:question=0.05:look=0.01, say, "
                f"or {', '.join((*_RATES, *_REPORTS, 'risk', 'words'))}=SHARE, "
                f"or without={'|'.join(PARTS)}."
            ) from None
        except ValueError as error:
            raise PluginError(f"'belief:{arguments}' is not understood: {error}") from None
        told = Rates(**believed), _skill(reports, arguments), without, risk, words
        return cls(costs, *told, frozenset(believed))


def _skill(reports: dict[str, float], arguments: str) -> SkillWorth | None:
    """What the reports of skills are worth, where that is said."""
    if not reports:
        return None
    notices = reports.get("notices", 0.0)
    false_alarms = reports.get("false_alarms", min(_RARELY, notices))
    if not 0 < false_alarms <= notices < 1:
        raise PluginError(
            f"'belief:{arguments}' is not understood: a skill reports a share of its failures, "
            "and no larger one of its successes, both between 0 and 1; write "
            "belief:notices=0.95:false_alarms=0.01, say"
        )
    return SkillWorth(notices=notices, false_alarms=false_alarms)
