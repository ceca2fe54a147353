"""Whether a robot's camera still moves on: a frozen one shows what was before the last action."""

from collections.abc import Mapping

from tpvqa.errors import PictureError
from tpvqa.observation import Frame, Observation
from tpvqa.pictures import picture_type
from tpvqa.worlds.capabilities import is_noiseless


class Freshness:
    """Compares each look at a robot with the last one before its latest action.

    A view is frozen where its stamp has not gone on since then, or where the picture is the very
    same, byte for byte: no two pictures of a camera are, as its sensor has noise. Worlds that are
    simulated, or say that they are without noise, are not judged.

    Args:
        world: The world that is looked at.
    """

    def __init__(self, world: object):
        self._judged = not is_noiseless(world)
        self._last: Mapping[str, Frame] = {}
        self._before: Mapping[str, Frame] = {}
        self.faults: Mapping[str, str] = {}

    def acted(self) -> None:
        """An action was done."""
        self._before = self._last

    def looked(self, seen: Observation) -> None:
        """There was a look; `faults` says which of its views are frozen, and why."""
        if self._judged:
            self.faults = {
                view: why for view, frame in seen.frames.items() if (why := self._fault(frame))
            }
            self._last = {**self._last, **seen.frames}

    def _fault(self, frame: Frame) -> str:
        before = self._before.get(frame.view)
        if before is None:
            return ""
        if frame.stamp is not None and before.stamp is not None and frame.stamp <= before.stamp:
            return (
                f"the camera is frozen: its picture, of {frame.stamp:g} s, is not newer than that "
                "before the last action"
            )
        if frame.data == before.data and _is_picture(frame):
            return "the camera is frozen: its picture is that of before the last action"
        return ""


def _is_picture(frame: Frame) -> bool:
    try:
        picture_type(frame.data)
    except PictureError:
        return False
    return True
