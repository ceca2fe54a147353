"""The recorded events of an episode, as what came of the requests of the same trial."""

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from tpvqa.errors import EpisodeError, PDDLError
from tpvqa.events import Event, Resumed
from tpvqa.events.events import (
    Acted,
    Acting,
    Answered,
    Asked,
    Believed,
    Decided,
    ListenerDropped,
    Observed,
    PlanMade,
    Waited,
)
from tpvqa.events.records import answers_from, execution_from, observation_from, plan_from
from tpvqa.monitors import Ask, AskPerson, Look, PlanFrom
from tpvqa.pddl import Atom, Task
from tpvqa.trial import Act, Pending, Wait

E = TypeVar("E", bound=Event)


class Recording:
    """Events of an unfinished episode, to be fed to the same trial again.

    Args:
        events: The episode's, without its end.
        task: The task.
        folder: Where the episode's pictures lie.

    Attributes:
        snapshots: The latest states of "world" and "vlm" that were played back.
    """

    def __init__(self, events: Sequence[Event], task: Task, folder: Path | None = None):
        self._events, self._task, self._folder = deque(events), task, folder
        self._take: Callable[[Event], None] = lambda event: None
        self.snapshots: dict[str, Mapping[str, Any]] = {}

    def __bool__(self) -> bool:
        """Whether there is more to be played back."""
        return bool(self._events)

    def tell(self, take: Callable[[Event], None]) -> None:
        """Name who is told of every event that is played back."""
        self._take = take

    def say(self, said: Event) -> None:
        """Play back an event that the trial says itself.

        Raises:
            EpisodeError: The log holds another one.
        """
        recorded = self._events[0] if self._events else None
        if type(recorded) is type(said) and _told(recorded) != _told(said):
            raise EpisodeError(
                f"event {recorded.number} of the log says something else than this version would "
                f"({recorded.kind!r}): it cannot be resumed, only shown"
            )
        self.event(type(said))

    def event(self, kind: type[E]) -> E:
        """Play back an event of a kind.

        Raises:
            EpisodeError: The log holds another one.
        """
        event = self._events.popleft() if self._events else None
        if not isinstance(event, kind):
            number = "after the last" if event is None else event.number
            found = "missing" if event is None else event.kind
            raise EpisodeError(
                f"event {number} of the log is {found!r} where this version would write "
                f"{kind.model_fields['kind'].default!r}: it cannot be resumed, only shown"
            )
        if isinstance(event, Observed | Answered | Acted | Waited) and event.snapshot is not None:
            self.snapshots["vlm" if isinstance(event, Answered) else "world"] = event.snapshot
        self._take(event)
        while self._events and _beside(self._events[0]):
            self._take(self._events.popleft())
        return event

    def resumed(self) -> bool:
        """Play back that the trial was gone on with here, in a world that may have changed.

        Returns:
            Whether it was.
        """
        if not self._events or not isinstance(self._events[0], Resumed):
            return False
        self.event(Resumed)
        return True

    def value(self, pending: Pending) -> Any:
        """Play back what came of a request.

        Raises:
            EpisodeError: The log holds what came of another one.
        """
        match pending.request:
            case Look():
                seen = self.event(Observed)
                self._see_known(seen)
                return observation_from(seen, self._folder)
            case Ask(questions):
                return answers_from(self.event(Answered), questions)
            case AskPerson(question):
                return answers_from(self.event(Answered), (question,))[0]
            case PlanFrom():
                return plan_from(self.event(PlanMade), self._task)
            case Act():
                acted = self.event(Acted)
                self._see_known(acted)
                return execution_from(acted)
            case Wait():
                return self.event(Waited).clock

    def _see_known(self, event: Observed | Acted) -> None:
        for each in event.facts:
            try:
                self._task.check_atom(Atom.parse(each.atom))
            except PDDLError as error:
                raise EpisodeError(
                    f"event {event.number} of the log senses what its task does not know: {error}"
                ) from error


def _told(event: Event | None) -> object:
    """What has to be the same where a trial is played back; words may be another version's."""
    match event:
        case Decided():
            return event.when, event.step, event.action, event.decision, event.onto
        case Believed():
            return event.added, event.removed
        case PlanMade():
            return event.result, [action.pddl() for action in event.plan]
        case Asked():
            asked = [(each.atom or each.action, each.way) for each in event.questions]
            return event.look, event.person, asked
        case Acting():
            return event.step, event.action.pddl(), event.attempt
    return None


def _beside(event: Event) -> bool:
    """Whether the trial neither says an event nor has asked for it."""
    return isinstance(event, ListenerDropped) or (isinstance(event, Observed) and event.during)
