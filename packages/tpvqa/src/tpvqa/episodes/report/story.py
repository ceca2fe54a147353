"""The events of an episode told as chapters: plans, and actions with their checks."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from tpvqa.episodes.agreement import Agreement
from tpvqa.episodes.notable_facts import FactNow, notable
from tpvqa.episodes.sensed_news import SensedNews
from tpvqa.errors import EpisodeError
from tpvqa.events import TrialState
from tpvqa.events.events import (
    Acted,
    Acting,
    ActionRecord,
    Answered,
    AnswerRecord,
    Believed,
    Decided,
    Ended,
    Event,
    FrameRecord,
    Observed,
    PlanMade,
    QuestionRecord,
    Started,
)
from tpvqa.questions import FactWords


class Told(NamedTuple):
    """A question, its answer, and whether that agrees with what is expected."""

    question: QuestionRecord
    answer: AnswerRecord
    agrees: bool | None


@dataclass
class Check:
    """One look, or none, with what was asked about it, and what the robot sensed itself."""

    look: int | None = None
    frames: tuple[FrameRecord, ...] = ()
    sensed: str = ""
    exchanges: list[Told] = field(default_factory=list)


@dataclass
class Phase:
    """The checks before or after an action, and what was decided.

    `facts` are those that matter most in a belief, where it is new; `considered` are plans that
    the monitor thought about and that are not followed.
    """

    checks: list[Check] = field(default_factory=list)
    decided: Decided | None = None
    believed: Believed | None = None
    facts: list[FactNow] = field(default_factory=list)
    considered: list[PlanMade] = field(default_factory=list)


@dataclass
class Chapter:
    """One action: its check before, what came of it, its check after. Or a plan.

    `sensed` is what the robot's own sensors told anew once it was over.
    """

    plan: PlanMade | None = None
    before: Phase = field(default_factory=Phase)
    acting: Acting | None = None
    acted: Acted | None = None
    sensed: str = ""
    after: Phase = field(default_factory=Phase)
    step: int | None = None
    action: ActionRecord | None = None

    @property
    def phases(self) -> list[tuple[str, Phase]]:
        """The phases that have something to tell, with their names."""
        named = [("before", self.before), ("after", self.after)]
        return [(name, phase) for name, phase in named if phase.checks or phase.decided]


@dataclass
class Story:
    """An episode as a reader wants it."""

    started: Started
    chapters: list[Chapter]
    ended: Ended | None

    @property
    def actions(self) -> list[Chapter]:
        """The chapters in which something was done or decided about an action."""
        return [chapter for chapter in self.chapters if chapter.plan is None]


def tell(events: Sequence[Event], words: FactWords | None = None) -> Story:
    """Put events in order of chapters; an unfinished episode is told as far as it goes.

    Args:
        events: Of an episode.
        words: Those of the trial, by which answers are compared with what is expected.

    Raises:
        EpisodeError: The events do not begin with the beginning.
    """
    if not events or not isinstance(events[0], Started):
        raise EpisodeError("the episode has no beginning")
    story = Story(events[0], [], None)
    words = words or FactWords()
    state, agreement, news = TrialState(), Agreement(words), SensedNews(words.say)
    current: Chapter | None = None
    phase = Phase()

    def chapter() -> Chapter:
        nonlocal current, phase
        if current is None:
            current = Chapter()
            phase = current.before
            story.chapters.append(current)
        return current

    for event in events:
        before, state = state, state.after(event)
        match event:
            case PlanMade() if event.considered:
                chapter()
                phase.considered.append(event)
            case PlanMade():
                story.chapters.append(Chapter(plan=event))
                current = None
            case Observed():
                chapter()
                phase.checks.append(Check(event.look, event.frames, news.of(event.facts)))
            case Answered():
                chapter()
                if not phase.checks:
                    phase.checks.append(Check())
                phase.checks[-1].exchanges += [
                    Told(each.question, each.answer, agreement.of(each, state))
                    for each in state.latest
                ]
            case Decided():
                # A monitor may go on at another step instead of acting: that step is told anew.
                if event.when == "before" and current is not None and current.step != event.step:
                    current = None if current.step is not None else current
                here = chapter()
                phase.decided = event
                if event.belief and event.belief != before.belief:
                    phase.facts = notable(event.belief, before.belief)
                here.step = event.step
                if before.plan is not None and event.step < len(before.plan.plan):
                    here.action = before.plan.plan[event.step]
                # A verdict that sends the trial elsewhere ends the chapter.
                if event.when == "after" or event.decision != "go on":
                    current = None
            case Believed():
                last = story.chapters[-1]
                (last.after if last.after.decided else last.before).believed = event
            case Acting():
                here = chapter()
                here.acting, here.action, here.step = event, event.action, event.step
                phase = here.after
            case Acted():
                here = chapter()
                here.acted, here.sensed = event, news.of(event.facts)
            case Ended():
                story.ended = event
    return story
