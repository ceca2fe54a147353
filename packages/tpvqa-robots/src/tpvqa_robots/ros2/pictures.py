"""Pictures and depth between ROS 2's messages and `Frame`."""

from io import BytesIO
from typing import Any

import numpy as np
from PIL import Image

from tpvqa.errors import PictureError
from tpvqa.observation import Depth, Frame, Intrinsics
from tpvqa.pictures import picture_type

_CHANNELS = {"rgb8": 3, "bgr8": 3, "rgba8": 4, "bgra8": 4, "mono8": 1}
LARGEST = 64_000_000
"""Bytes of a picture that is taken."""


def stamp_of(message: Any) -> float:
    """When a message's data were taken, in seconds."""
    return float(message.header.stamp.sec) + float(message.header.stamp.nanosec) / 1e9


def set_stamp(message: Any, stamp: float, frame_id: str) -> Any:
    """The message, with its header filled in."""
    message.header.stamp.sec = int(stamp)
    message.header.stamp.nanosec = min(round((stamp - int(stamp)) * 1e9), 999_999_999)
    message.header.frame_id = frame_id
    return message


def encoded(message: Any, *, raw: bool) -> tuple[bytes, str]:
    """The picture of a message, encoded, and what it is encoded as.

    Raises:
        PictureError: It is of another format, or damaged.
    """
    data = bytes(message.data)
    if len(data) > LARGEST:
        raise PictureError(f"a picture of {len(data):,} bytes is too large")
    if not raw:
        return data, picture_type(data)
    channels = _CHANNELS.get(message.encoding)
    if channels is None:
        known = ", ".join(_CHANNELS)
        raise PictureError(f"pictures are {known}, not {message.encoding!r:.40}")
    height, width, step = int(message.height), int(message.width), int(message.step)
    if min(height, width) < 1 or step < width * channels or len(data) != step * height:
        raise PictureError("the picture's size is not that of its data")
    rows = np.frombuffer(data, np.uint8).reshape(height, step)[:, : width * channels]
    pixels = rows.reshape(height, width, channels)[:, :, : 3 if channels > 1 else 1]
    if message.encoding.startswith("bgr"):
        pixels = pixels[:, :, ::-1]
    file = BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels.squeeze())).convert("RGB").save(file, "png")
    return file.getvalue(), "image/png"


def depth_of(message: Any) -> Depth | None:
    """The depth of a `sensor_msgs/Image`; None where it is of another form."""
    kinds = {"16UC1": (np.uint16, 1000.0), "mono16": (np.uint16, 1000.0), "32FC1": (np.float32, 1)}
    kind, unit = kinds.get(message.encoding, (None, 1.0))
    data, height, width = bytes(message.data), int(message.height), int(message.width)
    if kind is None or message.is_bigendian or not 0 < len(data) <= LARGEST:
        return None
    size = np.dtype(kind).itemsize
    step = int(message.step)
    if min(height, width) < 1 or step < width * size or len(data) != step * height:
        return None
    rows = np.frombuffer(data, np.uint8).reshape(height, step)[:, : width * size]
    values = np.ascontiguousarray(rows).view(kind).astype(np.float32)
    return Depth.from_metres(values / np.float32(unit))


def intrinsics_of(message: Any) -> Intrinsics | None:
    """The pinhole of a `sensor_msgs/CameraInfo`; None where it is not calibrated."""
    k = [float(value) for value in message.k]
    if not all(np.isfinite(k)) or k[0] <= 0 or k[4] <= 0:
        return None
    return Intrinsics(k[0], k[4], k[2], k[5], int(message.width), int(message.height))


def messages_of(frame: Frame, stamp: float, frame_id: str) -> tuple[Any, Any | None, Any | None]:
    """`CompressedImage`, depth as `Image` in 32FC1, and `CameraInfo` of a frame."""
    from sensor_msgs.msg import CameraInfo, CompressedImage
    from sensor_msgs.msg import Image as ImageMessage

    picture = set_stamp(CompressedImage(), stamp, frame_id)
    picture.format = frame.media_type.rpartition("/")[2]
    picture.data = frame.data
    depth = info = None
    if frame.depth is not None:
        metres = np.ascontiguousarray(frame.depth.metres, np.float32)
        depth = set_stamp(ImageMessage(), stamp, frame_id)
        depth.height, depth.width = metres.shape
        depth.encoding, depth.step = "32FC1", metres.shape[1] * 4
        depth.data = metres.tobytes()
    if frame.intrinsics is not None:
        of = frame.intrinsics
        info = set_stamp(CameraInfo(), stamp, frame_id)
        info.width, info.height = of.width, of.height
        info.distortion_model, info.d = "plumb_bob", [0.0] * 5
        info.k = [of.fx, 0.0, of.cx, 0.0, of.fy, of.cy, 0.0, 0.0, 1.0]
        info.p = [of.fx, 0.0, of.cx, 0.0, 0.0, of.fy, of.cy, 0.0, 0.0, 0.0, 1.0, 0.0]
    return picture, depth, info
