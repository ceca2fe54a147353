"""Pictures from anywhere, made into files of the set: upright, RGB, small, without metadata."""

from io import BytesIO

from PIL import Image, ImageOps

from tpvqa.errors import PictureError
from tpvqa.pictures import in_colour

LONGEST = 512
"""Pixels of the longer side at most. Photos tell where they were taken; that is left out too."""
QUALITY = 90


def read_picture(data: bytes) -> Image.Image:
    """Decode a picture, upright as its camera meant it.

    Raises:
        ValueError: It is no picture, or a broken one; says which.
    """
    try:
        return in_colour(data)
    except PictureError as error:
        raise ValueError(str(error)) from error


def as_jpeg(image: Image.Image) -> bytes:
    """Encode a picture for the set."""
    kept = image.copy()
    kept.thumbnail((LONGEST, LONGEST), Image.Resampling.LANCZOS)
    buffer = BytesIO()
    kept.save(buffer, "JPEG", quality=QUALITY, optimize=True)
    return buffer.getvalue()


def square(image: Image.Image, side: int) -> Image.Image:
    """The middle of a picture, scaled to side × side."""
    return ImageOps.fit(image, (side, side), Image.Resampling.LANCZOS)


def as_png(image: Image.Image) -> bytes:
    """Encode a picture without loss, as images APIs want it."""
    buffer = BytesIO()
    image.save(buffer, "PNG")
    return buffer.getvalue()
