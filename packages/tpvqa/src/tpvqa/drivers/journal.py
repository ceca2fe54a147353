"""Where the events of a trial go: into the log, and to whoever listens."""

import logging
from collections.abc import Callable, Sequence
from typing import Protocol

from tpvqa.events import Event, TrialState
from tpvqa.events.events import ListenerDropped
from tpvqa.observation import Frame

Listener = Callable[[Event], None]
"""Told of every event, when it is in the log."""
_LOG = logging.getLogger(__name__)


class Writer(Protocol):
    """Where events go.

    Attributes:
        resumable: Whether an episode may be gone on with from what was written, so that the
            states of world and VLM belong into the events.
    """

    resumable: bool

    def append(self, event: Event) -> Event:
        """Write an event; it is given its number and its time."""

    def save_frame(self, frame: Frame) -> str:
        """Save a picture; its path within the episode."""


class Journal:
    """Writes events, folds them into where the trial stands, and tells listeners.

    A listener that raises is told of nothing more, and named in the log before the next event; it
    never ends a trial.

    Args:
        writer: Where events go.
        listeners: Told of every event, recorded ones too.
    """

    def __init__(self, writer: Writer, listeners: Sequence[Listener] = ()):
        self.writer = writer
        self.state = TrialState()
        self._listeners = list(listeners)
        self._unsaid: list[ListenerDropped] = []

    def listen(self, listener: Listener) -> None:
        """Tell one more listener from now on."""
        self._listeners.append(listener)

    def write(self, event: Event) -> Event:
        """Write an event that happens now."""
        unsaid, self._unsaid = self._unsaid, []
        for each in (*unsaid, event):
            self.take(self.writer.append(each))
        return event

    def take(self, event: Event) -> None:
        """Take in an event that is in the log."""
        self.state = self.state.after(event)
        for listener in tuple(self._listeners):
            try:
                listener(event)
            except (Exception, SystemExit) as error:  # noqa: BLE001 — whatever it is, the trial goes on
                self._listeners.remove(listener)
                name = getattr(listener, "__qualname__", type(listener).__qualname__)
                _LOG.warning("%s broke and is told of nothing more: %r", name, error)
                said = f"{type(error).__name__}: {error}"
                self._unsaid.append(ListenerDropped(listener=name, error=said))
