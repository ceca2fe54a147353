"""Whether the events of a log hang together, as those of every trial do."""

from functools import lru_cache

from tpvqa.errors import EpisodeError
from tpvqa.events.events import (
    Acted,
    Acting,
    ActionRecord,
    Answered,
    Asked,
    Believed,
    Decided,
    Ended,
    Event,
    ListenerDropped,
    Observed,
    OutcomeRecord,
    PlanMade,
    QuestionRecord,
    Resumed,
    Started,
    Waited,
)
from tpvqa.pddl import Atom

FRAMES = "frames"
"""The folder of an episode's pictures, within its own."""
_INTRINSICS = {"fx", "fy", "cx", "cy", "width", "height"}
_LARGEST = 1e6


class LogShape:
    """Checks one event of a log after the other.

    What it lets through can be folded, shown, told in a report and played back without a surprise:
    answers have their questions, actions their plan, looks their numbers, facts their names.
    """

    def __init__(self) -> None:
        self._count = self._looks = 0
        self._plan: tuple[ActionRecord, ...] | None = None
        self._asked: Asked | None = None
        self._acting: Acting | None = None
        self._last: Event | None = None

    def take(self, event: Event) -> None:
        """Check the next event.

        Raises:
            EpisodeError: It cannot follow what came before, or says what cannot be; says why.
        """
        if event.number != self._count and not _interrupted(event, self._count):
            raise _wrong(f"it is number {event.number}, and {self._count} is expected")
        if event.time < 0:
            raise _wrong("its time lies before the beginning")
        if isinstance(event, Started) != (self._count == 0):
            raise _wrong(f"a {event.kind!r} cannot stand here: a log begins with one 'started'")
        if isinstance(self._last, Ended):
            raise _wrong("it follows the end")
        self._between(event)
        self._look_into(event)
        self._count, self._last = self._count + 1, event

    def _between(self, event: Event) -> None:
        """What may stand between a question and its answer, and while an action runs."""
        if isinstance(event, ListenerDropped | Ended | Resumed):
            if isinstance(event, Resumed):
                self._asked = None
            return
        if self._asked is not None and not isinstance(event, Answered):
            raise _wrong(f"a {event.kind!r} stands where the answers are expected")
        running = isinstance(event, Acted) or (isinstance(event, Observed) and event.during)
        if running and self._acting is None:
            raise _wrong(f"a {event.kind!r} of an action stands where none is executed")
        if not running and self._acting is not None:
            raise _wrong(f"a {event.kind!r} stands where an action is executed")

    def _look_into(self, event: Event) -> None:
        match event:
            case Started():
                _atoms(*event.initial, *(event.true_start or ()))
            case PlanMade():
                _atoms(*event.state)
                if event.result == "plan" and not event.considered:
                    self._plan = event.plan
            case Observed():
                self._observed(event)
            case Asked():
                if not 0 <= event.look < self._looks:
                    raise _wrong(f"it asks about look {event.look}, which was never taken")
                for question in event.questions:
                    _question(question)
                self._asked = event
            case Answered():
                asked, self._asked = self._asked, None
                if asked is None:
                    raise _wrong("it answers what was not asked")
                if len(asked.questions) != len(event.answers):
                    raise _wrong(
                        f"it holds {len(event.answers)} answers to {len(asked.questions)} questions"
                    )
            case Believed():
                _atoms(*event.added, *event.removed)
            case Decided():
                _atoms(*event.belief)
                if not all(0 <= p <= 1 for p in event.belief.values()):
                    raise _wrong("a probability is not between 0 and 1")
                if event.onto is not None and not 0 <= event.onto <= len(self._plan or ()):
                    raise _wrong(f"there is no step {event.onto} in the plan")
                if event.action or self._plan is not None:  # else of the look before there is one
                    self._step(event.step, event.action)
            case Acting():
                self._step(event.step, event.action.pddl())
                if event.attempt < 0:
                    raise _wrong(f"its attempt is number {event.attempt}")
                self._acting = event
            case Acted():
                self._acting = None
                _atoms(*(each.atom for each in event.facts))
                _truth(event.truth)
            case Waited():
                _truth(event.truth)

    def _step(self, step: int, action: str) -> None:
        if self._plan is None or not 0 <= step < len(self._plan):
            raise _wrong(f"there is no step {step} in the plan")
        if self._plan[step].pddl() != action:
            raise _wrong(f"step {step} of the plan is another action")

    def _observed(self, event: Observed) -> None:
        _atoms(*(each.atom for each in event.facts))
        if event.look != self._looks:
            raise _wrong(f"it is look {event.look}, and {self._looks} is expected")
        self._looks += 1
        for frame in event.frames:
            for name in (frame.file, frame.depth):
                if name is not None and not is_frame(name):
                    raise _wrong(f"the picture {name[:80]!r} does not lie in {FRAMES}/")
            seen = frame.intrinsics
            if seen is not None and (
                seen.keys() != _INTRINSICS or any(abs(value) > _LARGEST for value in seen.values())
            ):
                raise _wrong("the intrinsics of a camera are incomplete or beyond measure")


def _truth(truth: OutcomeRecord | None) -> None:
    if truth is not None:
        _atoms(*truth.added, *truth.removed)
        _atoms(*(() if truth.undone is None else (truth.undone,)))


def _interrupted(event: Event, count: int) -> bool:
    """Whether it is an end by Ctrl-C that was numbered as tpvqa 0.2 did where that came while the
    event before it was written."""
    return isinstance(event, Ended) and event.because == "cancelled" and event.number == count - 1


def is_frame(name: str) -> bool:
    """Whether this is the path of a picture as an episode names it: a file in `FRAMES`."""
    folder, slash, file = name.partition("/")
    return (folder, slash) == (FRAMES, "/") and not {"/", "\0"} & {*file} and file.strip(".") != ""


def _question(question: QuestionRecord) -> None:
    if question.atom is None and question.action is None:
        raise _wrong("a question is about a fact or about an action")
    _atoms(*(question.alike or ()), *((question.atom,) if question.atom is not None else ()))


def _atoms(*texts: str) -> None:
    for text in texts:
        if not _is_fact(text):
            raise _wrong(f"{text[:80]!r} is no fact")


@lru_cache(maxsize=65_536)
def _is_fact(text: str) -> bool:
    try:
        return bool(Atom.parse(text).predicate)
    except ValueError:
        return False


def _wrong(why: str) -> EpisodeError:
    return EpisodeError(why)
