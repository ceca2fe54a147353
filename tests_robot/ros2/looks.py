"""What holds in every episode of a robot behind topics, whoever was killed in it."""

from collections.abc import Iterable, Sequence

from tpvqa.events import Event
from tpvqa.events.decision import Decision
from tpvqa.events.events import Acting, Decided, Observed


def stamps(events: Iterable[Event]) -> list[float]:
    """When the pictures of looks were taken, by the clock on the wall."""
    return [float(each.detail["stamp"]) for each in events if isinstance(each, Observed)]


def until_next_action(events: Sequence[Event], after: int) -> Sequence[Event]:
    """The events after one of them, up to where the next action begins."""
    following = events[after + 1 :]
    end = next(n for n, each in enumerate(following) if isinstance(each, Acting))
    return following[:end]


def check_looks(events: Sequence[Event]) -> None:
    """Every action but the first begins after a new picture, and is done again only where the
    monitor decided so."""
    latest, looked, decided, last = 0.0, True, False, ""
    for event in events:
        for stamp in stamps([event]):
            assert stamp >= latest
            looked, latest = looked or stamp > latest, stamp
        if isinstance(event, Decided) and event.decision is not Decision.GO_ON:
            decided = True
        if isinstance(event, Acting):
            action = event.action.pddl()
            assert looked, f"{action} began without a look"
            assert decided or action != last, f"{action} was done twice"
            looked, decided, last = False, False, action
