"""What tells pictures apart: their bytes, as a VLM is given them."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

from tpvqa.observation import Frame, Observation

PICTURE_BYTES = 16
_OF_THE_LOOK = {
    Observation: frozenset({"look", "time", "detail", "facts"}),
    Frame: frozenset({"id", "source", "stamp"}),
}
"""When, and by whom, and not what is seen."""


def picture_of(observation: Observation) -> bytes:
    """The same for two looks that show the same, and no other.

    The encoded bytes count, not the pixels: they are what a VLM is sent, nothing of a stranger's
    has to be decoded, and a camera's pictures never repeat in either. Views, media types, depth
    images and intrinsics count, too.
    """
    digest = hashlib.blake2b(digest_size=PICTURE_BYTES)
    _take(digest, observation)
    return digest.digest()


def _take(digest: Any, value: object) -> None:
    """Take a value in, so that no two values give the same bytes."""
    if is_dataclass(value) and not isinstance(value, type):
        without = _OF_THE_LOOK.get(type(value), frozenset())
        told = {each.name: getattr(value, each.name) for each in fields(value)}
        value = {k: v for k, v in told.items() if k not in without and v not in (None, {}, ())}
    if isinstance(value, bytes):
        _head(digest, "bytes", len(value))
        digest.update(value)
    elif isinstance(value, Mapping):
        _head(digest, "mapping", len(value))
        for name, each in value.items():
            _take(digest, name)
            _take(digest, each)
    elif isinstance(value, Sequence) and not isinstance(value, str):
        _head(digest, "sequence", len(value))
        for each in value:
            _take(digest, each)
    else:
        text = repr(value).encode()
        _head(digest, type(value).__name__, len(text))
        digest.update(text)


def _head(digest: Any, kind: str, length: int) -> None:
    digest.update(f"{kind} {length}\n".encode())
