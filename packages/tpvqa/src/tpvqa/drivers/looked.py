"""The pictures of a look, held against what the world says of its views and of their formats."""

from collections.abc import Collection, Mapping
from dataclasses import replace

from tpvqa.errors import PictureError
from tpvqa.observation import Frame, LateFrame
from tpvqa.pictures import FORMATS, picture_type

NO_PICTURE = "the look holds no picture"


def declared(frames: Mapping[str, Frame], views: Collection[str], look: int) -> dict[str, Frame]:
    """The frames of a look, each with the name of the file that it is saved as.

    Args:
        frames: By view, as a world gave them.
        views: Those that the world says it has.
        look: Its number.

    Raises:
        ValueError: One is of another view.
    """
    for view, frame in frames.items():
        for named in (view, frame.view):
            if named not in views:
                raise ValueError(
                    f"a frame of the view {named!r}, which views() does not list: it lists "
                    f"{', '.join(views) or 'none'}. List it there, or name the frame so"
                )
    return {
        view: _as_encoded(frame).named(f"{look:04d}-{frame.view}") for view, frame in frames.items()
    }


def _as_encoded(frame: Frame) -> Frame:
    """The frame with the media type that its bytes have: a PNG is one whatever it is declared."""
    if isinstance(frame, LateFrame) or frame.media_type not in FORMATS.values():
        return frame
    try:
        kind = picture_type(frame.data)
    except PictureError:
        return frame  # whoever looks at it is told
    return frame if kind == frame.media_type else replace(frame, media_type=kind)
