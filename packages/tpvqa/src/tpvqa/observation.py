"""What a robot sees and senses. Pictures stay encoded until somebody looks at their pixels, and
those of a simulation may stay undrawn until somebody asks for them."""

import mimetypes
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from io import BytesIO
from typing import TYPE_CHECKING, Any, cast

from tpvqa.pddl import Atom
from tpvqa.pictures import decoded, in_colour

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

PNG, NPY = "image/png", "application/x-npy"


@dataclass(frozen=True, slots=True)
class Intrinsics:
    """A pinhole camera, in pixels; the centre of the top left pixel is (0, 0).

    Attributes:
        fx: Focal length along the rows.
        fy: Focal length along the columns.
        cx: Where the optical axis meets the picture, from the left.
        cy: The same, from the top.
        width: Of the picture that these are of.
        height: The same.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int


@dataclass(frozen=True)
class Depth:
    """How far away things are along the camera's axis, for every pixel, as encoded bytes.

    Attributes:
        data: The encoded distances.
        media_type: "image/png" for whole millimetres in 16 bits, 0 where nothing was measured;
            "application/x-npy" for a NumPy file of metres, NaN where nothing was measured.

    Raises:
        ValueError: The media type is another.
    """

    data: bytes = field(repr=False)
    media_type: str = PNG

    def __post_init__(self) -> None:
        if self.media_type not in (PNG, NPY):
            raise ValueError(f"a depth image is {PNG} or {NPY}, not {self.media_type!r}")

    @staticmethod
    def from_metres(metres: "NDArray[np.floating[Any]]", media_type: str = PNG) -> "Depth":
        """Encode distances in metres, height × width.

        As PNG they are rounded to millimetres; beyond 65.535 m, nothing was measured.
        """
        import numpy as np
        from PIL import Image

        file = BytesIO()
        if media_type == PNG:
            millimetres = np.rint(np.nan_to_num(metres, nan=0, posinf=0, neginf=0) * 1000)
            fits = (millimetres >= 0) & (millimetres <= 65535)
            Image.fromarray(np.where(fits, millimetres, 0).astype(np.uint16)).save(file, "png")
        else:
            np.save(file, np.asarray(metres, np.float32), allow_pickle=False)
        return Depth(file.getvalue(), media_type)

    @property
    def suffix(self) -> str:
        """The file ending that fits the media type, with its dot."""
        return suffix_of(self.media_type)

    @cached_property
    def metres(self) -> "NDArray[np.float32]":
        """The distances, height × width, in metres; NaN where nothing was measured.

        Raises:
            ValueError: The bytes are no such image.
            OSError: The same.
            PictureError: The same.
        """
        import numpy as np

        metres: NDArray[np.float32]
        if self.media_type == NPY:
            metres = np.load(BytesIO(self.data), allow_pickle=False).astype(np.float32)
        else:
            picture = decoded(self.data)
            if not picture.mode.startswith("I"):
                raise ValueError(f"a depth image has 16 bits a pixel; mode {picture.mode}")
            millimetres = np.asarray(picture, np.float32)
            metres = np.where(millimetres == 0, np.float32("nan"), millimetres / 1000)
        if metres.ndim != 2:
            raise ValueError(f"a depth image is height × width; this one is {metres.shape}")
        return metres


@dataclass(frozen=True)
class Frame:
    """One camera image, as encoded bytes.

    Attributes:
        id: Names the frame; a file name without its ending. In an episode the loop names it.
        view: The view it was taken from ("front" unless a world has several).
        data: The encoded picture.
        media_type: What it is encoded as, e.g. "image/jpeg". JPEG, PNG and WebP can be looked at.
        source: Where it comes from (a file of the picture set, a camera), for the log.
        stamp: When it was taken, in seconds by the clock of `Observation.time`; None where that
            is not known apart from it.
        intrinsics: The camera, where it is known.
        depth: How far away everything is, where that was measured.
    """

    id: str
    view: str
    data: bytes = field(repr=False)
    media_type: str = "image/jpeg"
    source: str = ""
    stamp: float | None = None
    intrinsics: Intrinsics | None = None
    depth: Depth | None = None

    @property
    def suffix(self) -> str:
        """The file ending that fits the media type, with its dot."""
        return suffix_of(self.media_type)

    @cached_property
    def pixels(self) -> "NDArray[np.uint8]":
        """The picture as an array, height × width × 3 (red, green, blue), 0 to 255.

        Raises:
            PictureError: It is no JPEG, PNG or WebP, is damaged, or has too many pixels.
        """
        import numpy as np

        return np.asarray(in_colour(self.data))

    def named(self, name: str) -> "Frame":
        """The same frame under another id."""
        return replace(self, id=name)


class LateDepth(Depth):
    """Distances that are measured and encoded when they are first asked for.

    Args:
        make: Gives the encoded distances; called once at most.
        media_type: As `Depth` has it.
    """

    def __init__(self, make: Callable[[], bytes], media_type: str = PNG):
        super().__init__(cast(bytes, make), media_type)

    @property
    def data(self) -> bytes:
        """The encoded distances."""
        return _made(self)

    @data.setter
    def data(self, data: bytes) -> None:
        _keep(self, data)


class LateFrame(Frame):
    """A picture that is drawn when it is first asked for: of a simulation's, most never are.

    Whoever saves it, or shows it to a VLM, has it drawn. A noise model looks at none.

    Args:
        id: As `Frame` has it, and so the others.
        view: From where.
        data: Gives the encoded picture as it was when the frame was made; called once at most.
    """

    def __init__(
        self,
        id: str,
        view: str,
        data: Callable[[], bytes] | bytes,
        media_type: str = "image/jpeg",
        source: str = "",
        stamp: float | None = None,
        intrinsics: Intrinsics | None = None,
        depth: Depth | None = None,
    ):
        made = cast(bytes, data)  # `_keep` tells them apart
        super().__init__(id, view, made, media_type, source, stamp, intrinsics, depth)

    @property
    def data(self) -> bytes:
        """The encoded picture."""
        return _made(self)

    @data.setter
    def data(self, data: bytes) -> None:
        _keep(self, data)

    def named(self, name: str) -> Frame:
        """The same frame under another id, still not drawn."""
        return LateFrame(
            name,
            self.view,
            self.__dict__["_made"],
            self.media_type,
            self.source,
            self.stamp,
            self.intrinsics,
            self.depth,
        )


def _keep(late: Depth | Frame, data: Callable[[], bytes] | bytes) -> None:
    late.__dict__["_made"] = cache(data) if callable(data) else data


def _made(late: Depth | Frame) -> bytes:
    made: Callable[[], bytes] | bytes = late.__dict__["_made"]
    return made() if callable(made) else made


@dataclass(frozen=True, slots=True)
class SensedFact:
    """A fact that the robot itself has measured: the gripper closed on something, a code was read.

    Attributes:
        atom: The fact.
        probability: How probable this reading makes it, where it was as likely as not before: near
            1 says that it holds, near 0 that it does not, 0.5 nothing.
    """

    atom: Atom
    probability: float = 1.0


@dataclass(frozen=True)
class Observation:
    """One look at the world: the same question about it gets the same answer.

    Attributes:
        look: Number of the look within its episode, from 0. The loop counts; a world need not.
        time: When it was taken: seconds since the episode began, by the world's own clock. In a
            simulation that is simulated time, on a robot any clock that never goes back.
        frames: The images, by view. Empty in worlds that are not seen but only told.
        detail: What else a world reports about the look, for the log only.
        facts: What the robot's own sensors tell at the look.
        before: The look before the latest action, where a VLM is to be shown it, too.
    """

    look: int = 0
    time: float = 0.0
    frames: Mapping[str, Frame] = field(default_factory=dict)
    detail: Mapping[str, Any] = field(default_factory=dict)
    facts: Sequence[SensedFact] = ()
    before: "Observation | None" = field(default=None, repr=False)


_ENDINGS = mimetypes.MimeTypes()  # Python's own: those of the system differ between machines


def suffix_of(media_type: str) -> str:
    """A file ending for a media type, with its dot: the usual one, or else one made of its name."""
    plain = media_type.partition(";")[0].strip().lower()
    known = _ENDINGS.guess_extension(plain, strict=False)
    if known is not None:
        return known
    name = re.sub(r"^(?:x-|vnd\.)|\+.*$", "", plain.partition("/")[2])
    return f".{name}" if re.fullmatch(r"[a-z0-9]{1,16}", name) else ".bin"
