"""What a robot sees in one look."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from io import BytesIO
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Frame:
    """One camera image, as encoded bytes.

    Attributes:
        id: Names the frame within its episode; a file name without its ending.
        view: The view it was taken from ("front" unless a world has several).
        data: The encoded picture.
        media_type: "image/jpeg" or "image/png".
        source: Where it comes from (a file of the picture set, a camera), for the log.
    """

    id: str
    view: str
    data: bytes = field(repr=False)
    media_type: str = "image/jpeg"
    source: str = ""

    @property
    def suffix(self) -> str:
        """The file ending that fits the media type, with its dot."""
        return {"image/jpeg": ".jpg", "image/png": ".png"}[self.media_type]

    @cached_property
    def pixels(self) -> "NDArray[np.uint8]":
        """The picture as an array, height × width × 3 (red, green, blue), 0 to 255."""
        import numpy as np
        from PIL import Image

        with Image.open(BytesIO(self.data)) as picture:
            return np.asarray(picture.convert("RGB"))


@dataclass(frozen=True)
class Observation:
    """One look at the world: the same question about it gets the same answer.

    Attributes:
        look: Number of the look within its episode, from 0.
        time: Seconds since the episode began, by the world's clock.
        frames: The images, by view. Empty in worlds that are not seen but only told.
        detail: What else a world reports about the look, for the log only.
    """

    look: int
    time: float
    frames: Mapping[str, Frame] = field(default_factory=dict)
    detail: Mapping[str, Any] = field(default_factory=dict)
