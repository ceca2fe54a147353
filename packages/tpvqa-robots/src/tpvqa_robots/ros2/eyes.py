"""The cameras of a robot behind topics: the latest picture of each, and whether it counts."""

import threading
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from tpvqa.errors import PictureError
from tpvqa.observation import Frame
from tpvqa_robots.ros2.link import Link
from tpvqa_robots.ros2.pictures import depth_of, encoded, intrinsics_of, stamp_of
from tpvqa_robots.ros2.setup import Camera, Setup


class Eye:
    """One view.

    A picture is an observation only if it was taken after the last action ended, is no older than
    the bound, and is not the very picture of before that action.

    Args:
        link: The node.
        view: The view's name.
        camera: Its topics.
        changed: Told when something came.
    """

    def __init__(self, link: Link, view: str, camera: Camera, changed: Callable[[], None]):
        from sensor_msgs.msg import CameraInfo, CompressedImage, Image

        self._view, self._camera, self._changed = view, camera, changed
        self._latest: dict[str, Any] = {}
        self._encoded: tuple[Any, tuple[bytes, str]] | None = None
        self._used: bytes | None = None
        self._before: bytes | None = None
        kind = Image if camera.raw else CompressedImage
        link.watch(kind, camera.image, partial(self._take, "image"))
        if camera.depth is not None:
            link.watch(Image, camera.depth, partial(self._take, "depth"))
        if camera.info is not None:
            link.watch(CameraInfo, camera.info, partial(self._take, "info"))

    def _take(self, what: str, message: Any) -> None:
        self._latest[what] = message
        self._changed()

    def acted(self) -> None:
        """An action was done: the picture last used is that of before it."""
        self._before = self._used or self._before
        self._used = None

    def whole(self, frame: Frame) -> bool:
        """Whether a picture has all that its camera sends: its depth may come a little later."""
        return self._camera.depth is None or frame.depth is not None

    def frame(self, now: float, after: float, age: float) -> tuple[Frame | None, str]:
        """The latest picture where it counts, else why it does not.

        Args:
            now: By the clock of the stamps.
            after: When the last action ended.
            age: Seconds that it may be old.
        """
        message, camera = self._latest.get("image"), self._camera
        if message is None:
            return None, f"no picture has come on {camera.image}"
        stamp = stamp_of(message)
        if stamp <= 0:
            return None, f"the last picture on {camera.image} bears no stamp"
        if stamp <= after:
            return (
                None,
                f"the last picture on {camera.image} is of before the last action ended",
            )
        if not -0.5 <= now - stamp <= age:
            old = f"{now - stamp:.1f} s old, {age:g} s are allowed"
            return None, f"the last picture on {camera.image} is {old}"
        named = message.header.frame_id
        if camera.frame_id and named != camera.frame_id:
            return None, f"{camera.image} is of frame {named!r:.60}, not {camera.frame_id!r}"
        try:
            if self._encoded is None or self._encoded[0] is not message:  # once: raw ones take time
                self._encoded = message, encoded(message, raw=camera.raw)
            data, media_type = self._encoded[1]
        except PictureError as error:
            return None, f"{camera.image}: {error}"
        if data == self._before:
            return None, f"the camera on {camera.image} is frozen: it shows what was before"
        self._used = data
        frame = Frame(self._view, self._view, data, media_type, source=camera.image, stamp=stamp)
        depth, info = self._latest.get("depth"), self._latest.get("info")
        if depth is not None and abs(stamp_of(depth) - stamp) <= 0.05:
            frame = replace(frame, depth=depth_of(depth))
        if info is not None:
            frame = replace(frame, intrinsics=intrinsics_of(info))
        return frame, ""


def open_eyes(link: Link, setup: Setup, changed: threading.Condition) -> dict[str, Eye]:
    """All views of a robot."""

    def tell() -> None:
        with changed:
            changed.notify_all()

    return {view: Eye(link, view, camera, tell) for view, camera in setup.cameras.items()}
