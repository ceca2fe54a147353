"""Definitions of messages as text, with those that they hold: a bag has them in it."""

import re
from functools import cache

from tpvqa_robots.interfaces.building import HERE

_STANDARD = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec",
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id",
    "sensor_msgs/CompressedImage": "std_msgs/Header header\nstring format\nuint8[] data",
    "sensor_msgs/Image": (
        "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\n"
        "uint8 is_bigendian\nuint32 step\nuint8[] data"
    ),
    "sensor_msgs/RegionOfInterest": (
        "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify"
    ),
    "sensor_msgs/CameraInfo": (
        "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\n"
        "float64[] d\nfloat64[9] k\nfloat64[9] r\nfloat64[12] p\nuint32 binning_x\n"
        "uint32 binning_y\nsensor_msgs/RegionOfInterest roi"
    ),
    "rcl_interfaces/Log": (
        "builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\nstring file\n"
        "string function\nuint32 line"
    ),
}
"""The fields of the standard messages that bags hold; ROS 2 need not be installed for one."""
_FIELD = re.compile(r"^\s*([A-Za-z]\w*(?:/[A-Za-z]\w*)?)[^\s]*\s+\w+", re.MULTILINE)


@cache
def definition(kind: str) -> str:
    """A message's definition, followed by those of the messages in it, as MCAP keeps it.

    Args:
        kind: E.g. `sensor_msgs/CompressedImage`.
    """
    texts = {kind: _text(kind)}
    _gather(kind, texts)
    parts = [f"MSG: {name}\n{text}" for name, text in texts.items() if name != kind]
    return f"\n{'=' * 80}\n".join([texts[kind], *parts])


def _text(kind: str) -> str:
    package, _, name = kind.partition("/")
    if kind in _STANDARD:
        return _STANDARD[kind]
    return (HERE / package / "msg" / f"{name}.msg").read_text()


def _gather(kind: str, texts: dict[str, str]) -> None:
    package = kind.partition("/")[0]
    for held in _FIELD.findall(texts[kind]):
        own = f"{package}/{held}"
        name = held if "/" in held else own
        known = name in _STANDARD or (HERE / package / "msg" / f"{held}.msg").is_file()
        if known and name not in texts:
            texts[name] = _text(name)
            _gather(name, texts)
