"""The pictures of a request: data in the request itself, never something to be fetched."""

import binascii
import hashlib
import re
from collections import OrderedDict
from collections.abc import Sequence
from threading import Lock

from tpvqa.errors import PictureError
from tpvqa.observation import Frame
from tpvqa.pictures import picture_type
from tpvqa.serving.refusal import Refusal

_DATA = re.compile(r"data:(image/[\w.+-]+)?(?:;[\w-]+=[\w-]+)*;base64,", re.IGNORECASE)
_KINDS = frozenset(f"image/{kind}" for kind in ("jpeg", "jpg", "pjpeg", "png", "x-png", "webp"))
"""What a picture may be said to be; clients often say JPEG of any of them."""
_REMEMBERED = 4_096

Key = tuple[bytes, ...]
"""Tells pictures apart by their content."""


class Pictures:
    """Reads the pictures of requests; of the same content the header is read once.

    Safe to use from several threads.

    Args:
        most: How many one request may have.
    """

    def __init__(self, *, most: int):
        self._most = most
        self._types: OrderedDict[bytes, str] = OrderedDict()
        self._lock = Lock()

    def read(self, urls: Sequence[str]) -> tuple[Key, tuple[Frame, ...]]:
        """The pictures behind addresses that hold them.

        Returns:
            What tells them from others, and the pictures, views of one moment.

        Raises:
            Refusal: There are none or too many, one is to be fetched, or it is no picture.
        """
        if not urls:
            raise Refusal(
                400,
                "The last message of the user has no picture. Send one beside the question, as "
                "image_url with a data: URL.",
                param="messages",
            )
        if len(urls) > self._most:
            raise Refusal(
                400,
                f"{len(urls)} pictures in one request; {self._most} are taken. Send fewer.",
                param="messages",
            )
        read = [self._frame(number, url) for number, url in enumerate(urls, start=1)]
        return tuple(key for key, _ in read), tuple(frame for _, frame in read)

    def _frame(self, number: int, url: str) -> tuple[bytes, Frame]:
        data = _decoded(number, url)
        key = hashlib.blake2b(data, digest_size=16).digest()
        kind = self._types.get(key)
        if kind is None:
            try:
                kind = picture_type(data)
            except PictureError as error:
                raise Refusal(400, f"Picture {number} {error}.", param="messages") from None
            with self._lock:
                self._types[key] = kind
                while len(self._types) > _REMEMBERED:
                    self._types.popitem(last=False)
        return key, Frame(f"picture{number}", f"view{number}", data, kind)


def _decoded(number: int, url: str) -> bytes:
    head = _DATA.match(url)
    if head is None:
        what = url[:40].partition(":")[0].lower()
        if what in ("http", "https", "ftp", "file"):
            raise Refusal(
                400,
                f"Picture {number} is the address of a picture elsewhere. Nothing is fetched from "
                "addresses: send its content as data:image/jpeg;base64,…",
                param="messages",
                code="remote_image_url",
            )
        raise Refusal(
            400,
            f"Picture {number} is no picture in Base64. Send it as data:image/jpeg;base64,…",
            param="messages",
        )
    said = (head[1] or "image/jpeg").lower()
    if said not in _KINDS:
        raise Refusal(
            400,
            f"Picture {number} is said to be {said[:40]}. Send JPEG, PNG or WebP, and say so.",
            param="messages",
        )
    try:
        return binascii.a2b_base64(url[head.end() :], strict_mode=True)
    except (binascii.Error, ValueError) as error:
        raise Refusal(
            400,
            f"Picture {number} is no clean Base64 ({error}). Encode it again.",
            param="messages",
        ) from None
