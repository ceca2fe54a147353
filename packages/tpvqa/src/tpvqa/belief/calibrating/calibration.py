"""How likely an answer is where yes is right and where it is wrong: what a VLM's word is worth."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, ValidationError, field_validator

from tpvqa.belief.answers.bounds import BOUND, EDGE, Counted
from tpvqa.belief.answers.kinds import FRESH, KINDS, UNKNOWN
from tpvqa.belief.calibrating.counted import CountedFaults, count_faults
from tpvqa.belief.calibrating.own_words import (
    OwnWords,
    SensorWorth,
    SkillWorth,
    fit_sensors,
    fit_skills,
)
from tpvqa.belief.calibrating.writing import read_json, write_json
from tpvqa.errors import CalibrationError, PlacedError
from tpvqa.questions.question import Question, Way
from tpvqa.told import ToldModel, first_fault
from tpvqa.vlm.answer import Answer, Reply

Probability = Annotated[float, Field(ge=0, le=1)]
Coefficient = Annotated[float, Field(ge=-1000, le=1000, allow_inf_nan=False)]


class Apart(StrEnum):
    """What lies between an answer and the last one to the same question about the same fact."""

    SAME_VIEW = "same view"  # a new picture of the same view
    OTHER_VIEW = "other view"


@dataclass(frozen=True, slots=True)
class AnswerRates:
    """How often each reply comes.

    Attributes:
        yes_if_true: P(yes | yes or no) where yes is right.
        yes_if_false: P(yes | yes or no) where no is right.
        abstain_if_true: P(unknown or cannot see) where yes is right.
        abstain_if_false: P(unknown or cannot see) where no is right.
    """

    yes_if_true: Probability
    yes_if_false: Probability
    abstain_if_true: Probability
    abstain_if_false: Probability


class _Model(ToldModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Curve(_Model):
    """From P(yes) to a log likelihood ratio (Platt 1999, less the log odds of the base rate).

    The ratio is `slope` · logit P(yes) + `intercept` ± `sign`, + where the reply is yes. A slope
    of 1 takes P(yes) at its word; a negative one says that it is higher where no is right.
    """

    slope: Coefficient
    intercept: Coefficient = 0.0
    sign: Coefficient = 0.0


class Group(_Model):
    """What was learnt of the answers to questions of one kind.

    Attributes:
        way: The way of asking; None for all.
        predicate: The predicate asked about, or the action where a whole action is; None for all.
        rows: Answers that it was learnt from, abstentions included.
        rates: How often each reply comes, shrunk towards those of the wider group.
        curve: What P(yes) is worth; None where the VLM gave none.
    """

    way: Way | None = None
    predicate: str | None = None
    rows: Counted = 0
    rates: AnswerRates
    curve: Curve | None = None

    def log_ratio(self, reply: Reply, p_yes: float | None) -> float:
        """What an answer of this kind is worth, see `Calibration.log_ratio`.

        Where nothing was learnt of a VLM whose P(yes) contradicts its word, the word counts, as if
        P(yes) lay as far on its side, but no more than a bare word.
        """
        if reply is Reply.YES:
            yes = True
        elif reply is Reply.NO:
            yes = False
        else:
            return 0.0
        curve, rates = self.curve, self.rates
        if curve is not None and p_yes is not None:
            if not self.rows and (p_yes < 0.5 if yes else p_yes > 0.5):
                told = self.log_ratio(reply, 1 - p_yes), self.log_ratio(reply, None)
                return min(told, key=abs)
            p = min(max(p_yes, EDGE), 1 - EDGE)
            sign = curve.sign if yes else -curve.sign
            ratio = curve.slope * math.log(p / (1 - p)) + curve.intercept + sign
        elif yes:
            ratio = _log_odds(rates.yes_if_true, rates.yes_if_false)
        else:
            ratio = _log_odds(1 - rates.yes_if_true, 1 - rates.yes_if_false)
        return min(max(ratio, -BOUND), BOUND)


NEAREST: Mapping[Way, tuple[Way, ...]] = {
    Way.PRECONDITION: (Way.PRECONDITION, Way.ALTERNATIVE, Way.EFFECT),
    Way.ALTERNATIVE: (Way.ALTERNATIVE, Way.PRECONDITION, Way.EFFECT),
    Way.EFFECT: (Way.EFFECT, Way.PRECONDITION, Way.ALTERNATIVE),
    Way.POSSIBLE: (Way.POSSIBLE,),
    Way.SUCCESSFUL: (Way.SUCCESSFUL, Way.DID),
    Way.DID: (Way.DID, Way.SUCCESSFUL),
}
"""Where to look for what is known of a way of asking: ways that use the same words stand in."""


class Calibration(_Model):
    """What the answers of one VLM are worth as evidence; kept as one JSON file.

    An answer's worth is its log likelihood ratio log P(answer | yes is right) - log P(answer | no
    is right), in nats: the base rate of the pictures that it was learnt from is not in it. What is
    known of questions of the same way and predicate counts first, then of the same way, then of
    all.

    A further answer is worth less than the first. With probability ρ (`repeat_same_view`,
    `repeat_other_view`) it only repeats the last one, else it is drawn afresh; on the same picture
    it is worth nothing.

    Attributes:
        version: Of the file.
        vlm: What it was learnt of.
        rows: Labelled answers that it was learnt from, each as often as it counts.
        by_hand: Labels that a person gave for them; one may hold for many answers.
        inferred: Answers that nobody has labelled, and of which later steps told what was probably
            right; they count for less (`labelling.inferring`).
        groups: By way and predicate.
        ways: By way.
        whole: Of all answers.
        repeat_same_view: ρ between two pictures of one view.
        repeat_other_view: ρ between pictures of two views.
        pairs_same_view: Pairs of answers that ρ was learnt from; of the same view.
        pairs_other_view: The same of two views.
        notices: What a user should know of it: P(yes) that points the wrong way.
        sensors: What the robot's own sensors are worth, by predicate.
        skills: What its skills' own reports are worth; of all and by action.
        faults: How often its actions failed and things came undone; None where nobody knew.
        lasting: How probable each of `lasting.KINDS` is, of how errors last.
    """

    version: Literal[1] = 1
    vlm: str
    rows: Counted = 0
    by_hand: Counted = 0
    inferred: Counted = 0
    groups: tuple[Group, ...] = ()
    ways: tuple[Group, ...] = ()
    whole: Group
    repeat_same_view: Probability
    repeat_other_view: Probability
    pairs_same_view: Counted = 0
    pairs_other_view: Counted = 0
    notices: tuple[str, ...] = ()
    sensors: tuple[SensorWorth, ...] = ()
    skills: tuple[SkillWorth, ...] = ()
    faults: CountedFaults | None = None
    lasting: Annotated[
        tuple[Probability, ...], Field(min_length=len(KINDS), max_length=len(KINDS))
    ] = FRESH

    @property
    def lasting_share(self) -> float:
        """The expected lasting share of the answers."""
        return sum(p * kind.share for p, kind in zip(self.lasting, KINDS, strict=True))

    @field_validator("lasting")
    @classmethod
    def _some(cls, weights: tuple[float, ...]) -> tuple[float, ...]:
        if sum(weights) <= 0:
            raise ValueError("the probabilities add up to nothing")
        return weights

    @cached_property
    def _nearest(self) -> dict[Way, dict[str, Group]]:
        """Way → predicate → group, "" for the way by itself. Answers come by the ten thousand."""
        by_way = {group.way: group for group in self.ways}
        found: dict[Way, dict[str, Group]] = {}
        for way, near in NEAREST.items():
            found[way] = {"": next((by_way[each] for each in near if each in by_way), self.whole)}
            for each in reversed(near):
                own = (group for group in self.groups if group.way is each)
                found[way].update({group.predicate: group for group in own if group.predicate})
        return found

    def model_copy(
        self, *, update: Mapping[str, Any] | None = None, deep: bool = False
    ) -> "Calibration":
        """A copy with some fields changed, which keeps nothing that was worked out from them."""
        copy = super().model_copy(update=update, deep=deep)
        copy.__dict__.pop("_nearest", None)
        return copy

    @property
    def fingerprint(self) -> str:
        """Tells it from other calibrations."""
        names = ("by_hand", "inferred", "sensors", "skills", "faults")
        unsaid = {name for name in names if not getattr(self, name)}
        if self.lasting == FRESH:
            unsaid.add("lasting")
        return sha256(self.model_dump_json(exclude=unsaid).encode()).hexdigest()[:12]

    @classmethod
    def default(cls, vlm: str = "") -> "Calibration":
        """What to assume of a VLM of which nothing is known.

        It is right in 0.85 of its answers, where it is one of those that know what they see; in
        the recordings of ViPlan (Merler et al. 2025) only half of them do, so `Trust.after` holds
        against it how the words of eight VLMs spread. Its P(yes) is trusted half (log odds
        halved), as VLMs are surer than they are right; a further look repeats the last answer with
        probability 0.5 from the same view and 0.25 from another. That errors last is
        learned, and hardly assumed.
        """
        return cls(
            vlm=vlm,
            whole=Group(rates=AnswerRates(0.85, 0.15, 0.05, 0.05), curve=Curve(slope=0.5)),
            repeat_same_view=0.5,
            repeat_other_view=0.25,
            lasting=UNKNOWN,
        )

    def hearing(self, own: OwnWords) -> "Calibration":
        """The same with what was learnt of the robot's own sensors and skills."""
        sensors, skills = fit_sensors(own.readings), fit_skills(own.reports)
        faults = count_faults(own.acts)
        return self.model_copy(update={"sensors": sensors, "skills": skills, "faults": faults})

    def group(self, question: Question) -> Group:
        """The narrowest group that tells something about a question."""
        return self.group_of(question.way, question.subject)

    def group_of(self, way: Way, subject: str) -> Group:
        """The same, by the way of asking and the predicate (or action) asked about."""
        known = self._nearest[way]
        return known.get(subject) or known[""]

    def log_ratio(self, answer: Answer) -> float:
        """What an answer is worth by itself: positive where it speaks for yes.

        Returns:
            log P(answer | yes is right) - log P(answer | no is right), within ±`BOUND`; 0 where
            the VLM abstains.
        """
        return self.group(answer.question).log_ratio(answer.reply, answer.p_yes)

    def repeat(self, apart: Apart) -> float:
        """ρ: the probability that a further answer only repeats the last one."""
        return self.repeat_same_view if apart is Apart.SAME_VIEW else self.repeat_other_view

    def pairs(self, apart: Apart) -> int:
        """How many pairs of answers ρ was learnt from."""
        return self.pairs_same_view if apart is Apart.SAME_VIEW else self.pairs_other_view

    @classmethod
    def load(cls, path: Path) -> "Calibration":
        """Read a file that `save` wrote.

        Raises:
            CalibrationError: It cannot be read, is of another version, or is broken.
        """
        try:
            text = read_json(path, what="calibration")
        except PlacedError as error:
            raise CalibrationError(
                f"{error}. Name the file that `tpvqa calibrate --out FILE` wrote"
            ) from error
        try:
            return cls.model_validate_json(text, strict=True)._forwards()
        except PlacedError as error:
            raise CalibrationError(f"{path}: {error}") from None
        except ValidationError as error:
            first = first_fault(error)
            place = ".".join(map(str, first["loc"]))
            if place == "version":
                message = "it is of another version; this tpvqa reads version 1"
            else:
                message = f"it is no calibration, or a damaged one ({place or 'file'}: "
                message += f"{first['msg']})"
            raise CalibrationError(
                f"{path}: {message}. Name what `tpvqa calibrate --out FILE` wrote, or make another"
            ) from error

    def _forwards(self) -> "Calibration":
        """Itself, where no answer counts the wrong way round."""
        for group in (self.whole, *self.ways, *self.groups):
            rates, curve = group.rates, group.curve
            turned = rates.yes_if_true < rates.yes_if_false - EDGE
            if turned or (curve is not None and curve.slope < -EDGE):
                asked = " of ".join(filter(None, (group.predicate, group.way)))
                raise PlacedError(
                    f"it takes a yes for a no ({asked or 'all answers'}: a yes is likelier where "
                    "no is right), as none that `tpvqa calibrate` makes does. Calibrate anew"
                )
        return self

    def save(self, path: Path) -> None:
        """Write it, all or nothing.

        Raises:
            WriteError: The file cannot be written.
        """
        write_json(path, self, remedy="Name another file with --out")


def _log_odds(if_true: float, if_false: float) -> float:
    return math.log(max(if_true, EDGE) / max(if_false, EDGE))
