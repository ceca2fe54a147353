"""How often actions failed in recorded episodes, as what a robot knows before its next trial."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from tpvqa.belief.chances import Chances
from tpvqa.belief.experience import Experience
from tpvqa.episodes import read_episode
from tpvqa.errors import CalibrationError
from tpvqa.events.events import Acted
from tpvqa.worlds.outcome import Failure


def experience_from(folders: Iterable[Path | str], redone: Sequence[bool] = ()) -> Experience:
    """Count the faults of recorded episodes, on top of what is believed of any robot.

    A failure counts as one that could have disturbed something wherever an action had achieved
    something before.

    Args:
        folders: The episodes' folders.
        redone: Whether something came undone, of their actions that had nothing left to do.

    Raises:
        CalibrationError: No episode says what truly came of its actions.
        EpisodeError: There is no episode, or it is damaged.
    """
    chances, trials, known = Chances(), 0, False
    for folder in folders:
        trials += 1
        achieved = False
        for event in read_episode(folder):
            if not isinstance(event, Acted) or event.truth is None:
                continue
            known = True
            failed = event.truth.failure in (Failure.CHANCE, Failure.SCRIPT)
            worked = event.truth.succeeded and bool(event.truth.added)
            chances.failure.yes += failed
            chances.failure.no += worked
            if achieved and not event.truth.succeeded:
                disturbed = event.truth.undone is not None
                chances.disturbance.yes += disturbed
                chances.disturbance.no += not disturbed
            achieved = achieved or worked
            if achieved and event.truth.succeeded:
                lost = event.truth.undone is not None
                chances.spontaneous.yes += lost
                chances.spontaneous.no += not lost
    if not known:
        raise CalibrationError(
            "No episode says what truly came of its actions, as in a simulated world it would. "
            "Leave --experience out: `tpvqa run --experience FILE` learns while it runs"
        )
    chances.redone.yes += sum(redone)
    chances.redone.no += len(redone) - sum(redone)
    return Experience.of(chances, None, trials)
