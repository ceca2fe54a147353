"""Where a trial stands: the one place in which events become that."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, Literal, NamedTuple, Self

from tpvqa.events.decision import Decision
from tpvqa.events.events import (
    Acted,
    Acting,
    ActionRecord,
    Answered,
    AnswerRecord,
    Asked,
    Believed,
    Decided,
    Ended,
    EndedBecause,
    Event,
    Observed,
    PlanMade,
    QuestionRecord,
    Started,
    Waited,
)
from tpvqa.events.usage import UsageRecord
from tpvqa.pddl import Atom, State
from tpvqa.questions import Way
from tpvqa.vlm import Reply

_atom = lru_cache(maxsize=65536)(Atom.parse)
STUCK = 300
"""Changes of plan without an action, after which a trial ends that sets them no limit: where errors
last it would be denied the same for ever."""


class Exchange(NamedTuple):
    """A question with its answer.

    Attributes:
        question: What was asked.
        answer: What was answered.
        look: The look that it was asked about.
        person: Whether a person was asked.
    """

    question: QuestionRecord
    answer: AnswerRecord
    look: int
    person: bool

    @property
    def agrees(self) -> bool | None:
        """Whether the answer agrees with what is expected; None where nothing is, or there is no
        answer."""
        if self.answer.reply not in (Reply.YES, Reply.NO) or self.question.way is Way.ALTERNATIVE:
            return None
        return (self.answer.reply is Reply.YES) == self.question.expected


@dataclass(frozen=True)
class TrialState:
    """Where a trial stands after some of its events.

    Attributes:
        started: The first event.
        plan: The plan that is followed; None before the first.
        first_plan: Actions of the first plan.
        index: The step of the plan that comes now, from 0.
        attempt: How often this step's action has been repeated.
        when: Which check of the step it is, before or after the action.
        believed: The facts believed to hold.
        belief: Probabilities of facts by their PDDL, as of the latest decision that told any.
        observed: The latest look.
        asked: The latest questions.
        exchanges: Questions and answers of this check.
        answered: How many of them the latest answers are.
        decided: The latest decision.
        acting: The action that is being executed.
        acted: What the latest action's skill reported.
        actions: Actions executed so far, repeats included.
        questions: Questions asked so far.
        looks: Looks taken so far.
        repeats: Repeats so far.
        replans: Replans so far.
        over: The limit that was reached; None while there is none.
        time: Seconds since the trial began.
        clock: What the world's clock showed last, where actions last; None before.
        began: What it showed when the plan began that is followed.
        ended: The last event.
        usage: What asking a server took so far; None where nothing was told of it.
    """

    started: Started | None = None
    plan: PlanMade | None = None
    first_plan: int | None = None
    index: int = 0
    attempt: int = 0
    when: Literal["before", "after"] = "before"
    believed: State = frozenset()
    belief: Mapping[str, float] = field(default_factory=dict)
    observed: Observed | None = None
    asked: Asked | None = None
    exchanges: tuple[Exchange, ...] = ()
    answered: int = 0
    decided: Decided | None = None
    acting: Acting | None = None
    acted: Acted | None = None
    actions: int = 0
    questions: int = 0
    looks: int = 0
    repeats: int = 0
    replans: int = 0
    over: EndedBecause | None = None
    time: float = 0.0
    clock: float | None = None
    began: float | None = None
    ended: Ended | None = None
    usage: UsageRecord | None = None
    _checked: bool = False
    _idle: int = 0  # changes of plan since the last action
    _deadline: float | None = None

    @property
    def action(self) -> ActionRecord | None:
        """The action of the step that comes now; None without a plan, and at its end."""
        if self.plan is None or self.index >= len(self.plan.plan):
            return None
        return self.plan.plan[self.index]

    @property
    def latest(self) -> tuple[Exchange, ...]:
        """The questions and answers of the latest `answered`."""
        return self.exchanges[len(self.exchanges) - self.answered :]

    @property
    def actions_left(self) -> int | None:
        """Actions that the limit still allows; None before there is a plan."""
        if self.started is None or self.first_plan is None:
            return None
        return self.started.limits.actions_of(self.first_plan) - self.actions

    @property
    def replans_left(self) -> int | None:
        """Replans that the limit still allows; None for any number."""
        limits = None if self.started is None else self.started.limits
        most = None if limits is None else limits.replans_of(self.first_plan or 0)
        return None if most is None else most - self.replans

    @property
    def repeats_left(self) -> int | None:
        """Repeats of this step's action that the limit still allows; None for any number."""
        most = None if self.started is None else self.started.limits.repeats
        return None if most is None else most - self.attempt

    @property
    def seconds_left(self) -> float | None:
        """Seconds that the limit of time still allows; None for any number."""
        return None if self._deadline is None else max(self._deadline - self.time, 0.0)

    def after(self, event: Event) -> Self:
        """Where the trial stands after one more event."""
        match event:
            case Asked():
                change = {**self._asking(), "asked": event, "_checked": False}
                change["questions"] = self.questions + len(event.questions)
            case Answered():
                change = self._answers(event)
            case Observed(during=True):
                change = {"observed": event, "looks": self.looks + 1}
            case Observed():
                change = {**self._asking(), "observed": event, "_checked": False}
                change["looks"] = self.looks + 1
            case Decided():
                change = self._decision(event)
            case Believed():
                gone, new = frozenset(map(_atom, event.removed)), frozenset(map(_atom, event.added))
                change = {"believed": (self.believed - gone) | new}
            case Acting():
                change = {"acting": event, "actions": self.actions + 1, "attempt": event.attempt}
                change["index"] = event.step
            case Acted():
                change = {"acting": None, "acted": event, "when": "after", "_idle": 0}
            case PlanMade(considered=False, result="plan"):
                first = len(event.plan) if self.first_plan is None else self.first_plan
                change = {"plan": event, "first_plan": first, "index": 0, "attempt": 0}
                change |= {"when": "before", "began": None}
            case Waited():
                change = {"clock": event.clock}
                change["began"] = event.clock if self.began is None else self.began
            case Started():
                change = {"started": event, "believed": frozenset(map(_atom, event.initial))}
                change["_deadline"] = event.limits.seconds
            case Ended():
                change = {"ended": event}
            case _:
                change = {}
        return self._but(change, event.time)

    def _asking(self) -> dict[str, Any]:
        """A new check begins with its first look or question."""
        return {"exchanges": (), "answered": 0} if self._checked else {}

    def _answers(self, event: Answered) -> dict[str, Any]:
        change: dict[str, Any]
        asked = self.asked
        if asked is None:
            return {}
        new = tuple(
            Exchange(question, answer, asked.look, asked.person)
            for question, answer in zip(asked.questions, event.answers, strict=True)
        )
        change = {"exchanges": self.exchanges + new, "answered": len(new)}
        if event.usage is not None:
            change["usage"] = event.usage.plus(self.usage)
        return change

    def _decision(self, event: Decided) -> dict[str, Any]:
        change: dict[str, Any] = {"decided": event, "index": event.step, "_checked": True}
        change |= self._asking()  # nothing was asked since the decision before
        if event.belief:
            change["belief"] = event.belief
        if event.acts:
            if self.actions_left is not None and self.actions_left <= 0:
                change["over"] = "limit of actions"
            return change
        change["when"] = "before"
        match event.decision:
            case Decision.GO_ON:
                change |= {"index": event.onward, "attempt": 0}
            case Decision.REPEAT if self.repeats_left is not None and self.repeats_left <= 0:
                change["over"] = "limit of repeats"
            case Decision.REPEAT:
                change |= {"attempt": self.attempt + 1, "repeats": self.repeats + 1}
            case Decision.REPLAN if self.replans_left is not None and self.replans_left <= 0:
                change["over"] = "limit of replans"
            case Decision.REPLAN if self.replans_left is None and self._idle >= STUCK:
                change["over"] = "limit of replans"
            case Decision.REPLAN:
                change |= {"replans": self.replans + 1, "_idle": self._idle + 1}
        return change

    def _but(self, change: dict[str, Any], time: float) -> Self:
        if self._deadline is not None and time >= self._deadline and self.over is None:
            change.setdefault("over", "limit of time")
        if time:
            change["time"] = time
        new = object.__new__(type(self))  # as `replace` does, in a fifth of the time
        object.__setattr__(new, "__dict__", self.__dict__ | change)
        return new
