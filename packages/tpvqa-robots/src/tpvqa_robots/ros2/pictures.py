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


def picture_message(frame: Frame, stamp: float, frame_id: str) -> Any:
    """A frame's picture as `CompressedImage`."""
    from sensor_msgs.msg import CompressedImage

    message = set_stamp(CompressedImage(), stamp, frame_id)
    message.format = frame.media_type.rpartition("/")[2]
    message.data = frame.data
    return message


def depth_message(frame: Frame, stamp: float, frame_id: str) -> Any | None:
    """Its depth as `Image` in 32FC1; None where it has none."""
    from sensor_msgs.msg import Image as ImageMessage

    if frame.depth is None:
        return None
    metres = np.ascontiguousarray(frame.depth.metres, np.float32)
    message = set_stamp(ImageMessage(), stamp, frame_id)
    message.height, message.width = metres.shape
    message.encoding, message.step = "32FC1", metres.shape[1] * 4
    message.data = metres.tobytes()
    return message


def info_message(frame: Frame, stamp: float, frame_id: str) -> Any | None:
    """Its pinhole as `CameraInfo`; None where it is not known."""
    from sensor_msgs.msg import CameraInfo

    if frame.intrinsics is None:
        return None
    of, message = frame.intrinsics, set_stamp(CameraInfo(), stamp, frame_id)
    message.width, message.height = of.width, of.height
    message.distortion_model, message.d = "plumb_bob", [0.0] * 5
    message.k = [of.fx, 0.0, of.cx, 0.0, of.fy, of.cy, 0.0, 0.0, 1.0]
    message.p = [of.fx, 0.0, of.cx, 0.0, 0.0, of.fy, of.cy, 0.0, 0.0, 0.0, 1.0, 0.0]
    return message
