"""What was asked in a recorded episode, put together by what one label answers."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import Literal

from tpvqa.episodes import read_episode
from tpvqa.episodes.log import LOG, episode_folder, whole_lines
from tpvqa.errors import CalibrationError
from tpvqa.events import Event, Exchange, Resumed, Started, TrialState
from tpvqa.events.events import Acted, Acting, Answered, Observed, QuestionRecord, Waited
from tpvqa.files import opened_plain
from tpvqa.questions import Way
from tpvqa.vlm import Reply

_ANSWERED = re.compile(rb'"kind": ?"answered"')
OF_FACTS = (Way.PRECONDITION, Way.EFFECT, Way.ALTERNATIVE)


@dataclass(frozen=True, slots=True)
class Given:
    """An answer as it was given.

    Attributes:
        way: The way of asking.
        reply: The answer.
        p_yes: P(yes | yes or no), where it came with one.
        look: The look it is about.
        view: The view of that look; None where there is no picture, or several.
        person: Whether a person gave it.
    """

    way: Way
    reply: Reply
    p_yes: float | None
    look: int
    view: str | None
    person: bool


@dataclass(frozen=True, slots=True)
class Asking:
    """All that was asked in the same words while nothing was done and no time passed: one truth, so
    one label does.

    Attributes:
        episode: The episode's folder.
        stretch: Actions that had begun by then (an interruption counts as one, and so does time
            that passed while actions lasted).
        text: The question.
        subject: The predicate asked about, or the action where a whole action is.
        atoms: The facts of which any one makes yes right; none where a whole action is asked about.
        done: The action before, in words; empty at the start.
        answers: The answers, in the order of asking.
        pictures: Files of the pictures that it was asked of, each once.
    """

    episode: Path
    stretch: int
    text: str
    subject: str
    atoms: tuple[str, ...]
    done: str
    answers: tuple[Given, ...]
    pictures: tuple[str, ...]

    @property
    def key(self) -> tuple[int, str]:
        """Tells it from the others of its episode."""
        return self.stretch, self.text

    @property
    def of_vlm(self) -> tuple[Given, ...]:
        """The VLM's answers."""
        return tuple(each for each in self.answers if not each.person)

    @property
    def group(self) -> tuple[Way, str]:
        """Way and subject of the first answer, which is what teaches rates."""
        return self.of_vlm[0].way, self.subject


@dataclass(frozen=True, slots=True)
class RecordedEpisode:
    """An episode as far as labels need it.

    Attributes:
        folder: Where it lies.
        started: Its first event.
        log: Tells its log from others.
        askings: What was asked, in the order of asking.
        actions: What was done, and what the skill reported (None where it did not come to that);
            None in the place of an interruption, and of time that passed. One lies between each
            stretch and the next.
        timed: Whether time passed while actions lasted.
    """

    folder: Path
    started: Started
    log: str
    askings: tuple[Asking, ...]
    actions: tuple[tuple[Acting, Acted | None] | None, ...]
    timed: bool = False


def read_recorded(folder: Path | str) -> RecordedEpisode:
    """Read an episode, finished or not.

    Raises:
        EpisodeError: There is none, or it is damaged.
    """
    folder = episode_folder(folder)
    gathering = _Gathering(folder)
    events = read_episode(folder)
    for event in events:
        gathering.take(event)
    started = events[0]
    assert isinstance(started, Started)  # as every log that can be read begins
    return RecordedEpisode(
        folder,
        started,
        _fingerprint(folder / LOG),
        tuple(gathering.askings()),
        tuple(gathering.done),
        gathering.stretches.timed,
    )


def check_apart(episodes: Iterable[RecordedEpisode]) -> None:
    """See that no episode is the copy of another, whose answers would count twice.

    Raises:
        CalibrationError: One is.
    """
    known: dict[str, list[Path]] = {}
    for episode in episodes:
        alike = known.setdefault(episode.log, [])
        for first in alike:
            if _share_answers(first / LOG, episode.folder / LOG):
                raise CalibrationError(
                    f"{episode.folder} is a copy of {first}, or both go on from one episode: what "
                    "was answered in both would count twice. Give one of them"
                )
        alike.append(episode.folder)


def _share_answers(one: Path, other: Path) -> bool:
    """Whether two logs are alike until something is answered, or one of them ends. That they begin
    alike says little: the same command does, run often enough; but then times soon differ."""
    with opened_plain(one) as first, opened_plain(other) as second:
        for line, same in zip(whole_lines(first), whole_lines(second), strict=False):
            if line != same:
                return False
            if _ANSWERED.search(line):
                return True
    return True


def said_in_trial(asking: Asking) -> Literal["yes", "no"] | None:
    """What a person answered to the question while the trial ran, the last time; None for
    nothing."""
    for answer in reversed(asking.answers):
        if answer.person and answer.reply in (Reply.YES, Reply.NO):
            return "yes" if answer.reply is Reply.YES else "no"
    return None


def subject_of(question: QuestionRecord) -> str:
    """The predicate or the action that a question is about."""
    text = question.atom if question.way in OF_FACTS else question.action
    return (text or "").strip("()").split(" ")[0]


def view_of(observed: Observed) -> str | None:
    """The view of a look; None where there is no picture, or several."""
    if observed.view is not None:
        return observed.view
    views = [frame.view for frame in observed.frames]
    return views[0] if len(views) == 1 else None


def _fingerprint(path: Path) -> str:
    """Of the first line of a log, which hardly another log has and which stays when it is gone on
    with: times and seeds stand in it."""
    with opened_plain(path) as descriptor:
        return sha256(next(whole_lines(descriptor))).hexdigest()[:12]


class Stretches:
    """Counts what lies between two moments at which the same need not be true.

    Attributes:
        number: Of the stretch now, from 0.
        timed: Whether time passed while actions lasted.
    """

    def __init__(self) -> None:
        self.number, self.timed = 0, False
        self._clock: float | None = None

    def take(self, event: Event) -> bool:
        """Take an event; whether a stretch begins with it."""
        match event:
            case Acting() | Resumed():
                begins = True
            case Waited():
                begins = self._clock is not None and event.clock > self._clock
                self.timed, self._clock = self.timed or begins, event.clock
            case _:
                begins = False
        self.number += begins
        return begins


@dataclass
class _Asked:
    stretch: int
    done: str
    exchange: Exchange
    answers: list[Given] = field(default_factory=list)
    pictures: dict[str, None] = field(default_factory=dict)


class _Gathering:
    """Takes events, and puts together what belongs together."""

    def __init__(self, folder: Path):
        self._folder, self._state = folder, TrialState()
        self._looks: dict[int, Observed] = {}
        self._asked: dict[tuple[int, str], _Asked] = {}
        self._said = ""
        self.stretches = Stretches()
        self.done: list[tuple[Acting, Acted | None] | None] = []

    def take(self, event: Event) -> None:
        self._state = self._state.after(event)
        if self.stretches.take(event):
            self.done.append((event, None) if isinstance(event, Acting) else None)
        match event:
            case Observed():
                self._looks[event.look] = event
            case Acting():
                self._said = event.action.said
            case Acted():
                last = self.done[-1] if self.done else None
                if last is not None:
                    self.done[-1] = (last[0], event)
            case Resumed():
                self._said = "an interruption"
            case Answered():
                for exchange in self._state.latest:
                    self._answer(exchange)

    def _answer(self, exchange: Exchange) -> None:
        question, answer, look, person = exchange
        key = (self.stretches.number, question.text)
        if key not in self._asked:
            self._asked[key] = _Asked(self.stretches.number, self._said, exchange)
        asked, seen = self._asked[key], self._looks.get(look)
        asked.answers.append(
            Given(
                question.way,
                answer.reply,
                answer.p_yes,
                look,
                None if seen is None else view_of(seen),
                person,
            )
        )
        if seen is not None:
            asked.pictures |= dict.fromkeys(frame.file for frame in seen.frames)

    def askings(self) -> Iterator[Asking]:
        """Those with an answer of the VLM's."""
        for (stretch, text), asked in self._asked.items():
            if all(answer.person for answer in asked.answers):
                continue
            question = asked.exchange.question
            alike = question.alike or ()
            yield Asking(
                episode=self._folder,
                stretch=stretch,
                text=text,
                subject=subject_of(question),
                atoms=(question.atom, *alike) if question.atom is not None else (),
                done=asked.done,
                answers=tuple(asked.answers),
                pictures=tuple(asked.pictures),
            )
