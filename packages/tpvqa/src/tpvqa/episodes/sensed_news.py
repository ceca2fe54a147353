"""What a robot's own readings tell, in words."""

from collections.abc import Callable, Sequence

from tpvqa.events.events import SensedRecord

MOST = 6
"""Readings that are told at once. Of more than these, those that say nothing new are left out."""


class SensedNews:
    """Keeps the readings of an episode: sensors say the same of most facts again and again.

    Args:
        say: Says a fact in words.
    """

    def __init__(self, say: Callable[[str], str]):
        self._say = say
        self._last: dict[str, float] = {}
        self._since: dict[str, float] = {}

    def of(self, facts: Sequence[SensedRecord], *, acted: bool = True) -> str:
        """The readings in one line, of many those that differ from the last ones of their facts;
        empty where there is nothing to tell.

        Args:
            facts: The readings.
            acted: Whether they are of an action's end; of a look, what was read since then is no
                news.
        """
        if acted:
            self._since.clear()
        new = [each for each in facts if self._since.get(each.atom) != each.probability]
        self._since.update((each.atom, each.probability) for each in facts)
        if len(new) > MOST:
            new = [each for each in new if self._last.get(each.atom) != each.probability]
        self._last.update((each.atom, each.probability) for each in facts)
        more = [f"{len(new) - MOST} more"] if len(new) > MOST else []
        return ", ".join([*map(self._said, new[:MOST]), *more])

    def _said(self, reading: SensedRecord) -> str:
        words, p = self._say(reading.atom), reading.probability
        return f"{words} {p:.2f}" if p >= 0.5 else f"not {words} {1 - p:.2f}"
