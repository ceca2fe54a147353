"""Pictures as a server is sent them: shrunken to a stated size, and compressed, once."""

from collections import OrderedDict
from dataclasses import replace
from hashlib import blake2b
from io import BytesIO

from tpvqa.errors import PictureError
from tpvqa.observation import Frame
from tpvqa.pictures import as_colour, decoded, upright

LONGEST = 1024
"""Pixels of the longest side where none is named: models look at tiles of 336 to 768 pixels."""
QUALITY = "90"
"""Of a JPEG, where a picture has to be made smaller and none is named."""
_KEPT = 64


class SentPictures:
    """Makes pictures fit to be sent; each picture once.

    A picture that is not larger is sent as it is, byte by byte, unless a quality is named, or its
    EXIF data say that it is to be turned: servers differ in whether they do. What is no picture
    that can be decoded is left to the server.

    Args:
        longest: Pixels that the longest side may have.
        quality: Of a JPEG, "1" to "100", or "png"; None for JPEG of `QUALITY` where a picture is
            made smaller.
    """

    def __init__(self, longest: int = LONGEST, quality: str | None = None):
        self.longest, self.quality = longest, quality
        self._known: OrderedDict[bytes, Frame] = OrderedDict()

    def __call__(self, frame: Frame) -> Frame:
        """The picture as it is sent."""
        key = blake2b(frame.data, digest_size=16).digest()
        if key not in self._known:
            self._known[key] = self._fit(frame)
            while len(self._known) > _KEPT:
                self._known.popitem(last=False)
        made = self._known[key]
        return replace(frame, data=made.data, media_type=made.media_type)

    def _fit(self, frame: Frame) -> Frame:
        from PIL import Image

        try:
            picture = decoded(frame.data)
        except PictureError:
            return frame
        larger = max(picture.size) > self.longest
        if not larger and self.quality is None:
            return replace(frame, data=upright(frame.data))
        picture = as_colour(picture)
        if larger:
            picture.thumbnail((self.longest, self.longest), Image.Resampling.LANCZOS)
        file = BytesIO()
        if self.quality == "png":
            picture.save(file, "PNG", optimize=True)
            return replace(frame, data=file.getvalue(), media_type="image/png")
        picture.save(file, "JPEG", quality=int(self.quality or QUALITY), optimize=True)
        return replace(frame, data=file.getvalue(), media_type="image/jpeg")
