"""Encoded pictures, which may come from a stranger: read from disk and decoded within bounds.

Everything that reads a picture goes through here. A file is read if it is a regular one and not too
large; where a folder is given it has to lie inside it, and no link on the way is followed. Only
JPEG, PNG and WebP are decoded, by Pillow, after their headers have said how many pixels there are.
Pixels are upright, as every viewer shows them: phones write them as the sensor lay, and in the EXIF
data how they are to be turned.
"""

import errno
import os
import stat
import warnings
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from tpvqa.errors import PictureError

if TYPE_CHECKING:
    from PIL import Image

FORMATS = {"JPEG": "image/jpeg", "MPO": "image/jpeg", "PNG": "image/png", "WEBP": "image/webp"}
"""What Pillow calls what is decoded, and its media type. MPO is what some phones write: JPEG."""
MOST_BYTES = 32 * 2**20
"""Of a file."""
MOST_PIXELS = 50_000_000
"""Of a picture: as many as the largest photos of phones."""
_QUALITY = 95  # of a picture that is encoded again, in percent
_TURNS = {
    2: "FLIP_LEFT_RIGHT",
    3: "ROTATE_180",
    4: "FLIP_TOP_BOTTOM",
    5: "TRANSPOSE",
    6: "ROTATE_270",
    7: "TRANSVERSE",
    8: "ROTATE_90",
}  # how each orientation of EXIF is made upright; EXIF is not written again, as it may be damaged
_SAYING_TURNS = ("exif", "Raw profile type exif", "XML:com.adobe.xmp", "xmp")
_MOST_SCANS = 100  # of a JPEG; each is decoded over the whole picture, photos have some ten


def read_file(path: str | Path, *, inside: Path | None = None, most: int = MOST_BYTES) -> bytes:
    """The bytes of a regular file that may come from a stranger. Never waits for a pipe.

    Args:
        path: The file. With `inside`, as seen from that folder.
        inside: Where it has to lie. Then the path has to be relative, without "..", and neither
            the file nor a folder below `inside` may be a link.
        most: How many bytes it may have.

    Raises:
        PictureError: It is missing, no regular file, too large, or lies elsewhere.
    """
    shown = _shown(path if inside is None else inside / path)
    try:
        file = _open(Path(path)) if inside is None else _open_inside(str(path), inside)
    except (OSError, ValueError) as error:  # a ValueError for a NUL in the path
        why = _LOOP if inside is None and _is_loop(error) else _why(error)
        raise PictureError(f"{shown}: cannot be read ({why})") from error
    try:
        if not stat.S_ISREG(os.fstat(file).st_mode):
            raise PictureError(f"{shown}: is no regular file. Name a file on disk")
        parts, left = [], most + 1
        while left and (part := os.read(file, min(left, 2**20))):
            parts.append(part)
            left -= len(part)
    except OSError as error:
        raise PictureError(f"{shown}: cannot be read ({_why(error)})") from error
    finally:
        os.close(file)
    if not left:
        raise PictureError(f"{shown}: has more than {most / 2**20:g} MiB. Make it smaller")
    return b"".join(parts)


def read_picture(path: str | Path, *, inside: Path | None = None) -> bytes:
    """The bytes of a picture in a file; as `read_file`, and its header has been read.

    Raises:
        PictureError: As `read_file` and `picture_type` do.
    """
    data = read_file(path, inside=inside)
    try:
        picture_type(data)
    except PictureError as error:
        shown = _shown(path if inside is None else inside / path)
        raise PictureError(f"{shown}: {error}") from error
    return data


def picture_type(data: bytes) -> str:
    """The media type of an encoded picture, by its content.

    Raises:
        PictureError: It is no JPEG, PNG or WebP, or has too many pixels.
    """
    with _opened(data) as picture:
        return FORMATS[picture.format or ""]


def decoded(data: bytes) -> "Image.Image":
    """The pixels of an encoded picture, upright.

    Raises:
        PictureError: It is no JPEG, PNG or WebP, is damaged, or has too many pixels.
    """
    from PIL import Image

    picture = _opened(data)
    try:
        picture.load()
    except Exception as error:  # decoders raise of every kind
        raise PictureError(f"is a damaged picture ({error})") from error
    turn = _TURNS.get(_orientation(picture))
    if turn is None:
        return picture
    turned = picture.transpose(Image.Transpose[turn])
    for name in _SAYING_TURNS:
        turned.info.pop(name, None)
    return turned


def upright(data: bytes) -> bytes:
    """An encoded picture for whoever may not know that EXIF data turn it: the same bytes where they
    do not, or else encoded again.

    Raises:
        PictureError: As `decoded` does.
    """
    opened = _opened(data)
    if _orientation(opened) not in _TURNS:
        return data
    file = BytesIO()
    kind = "JPEG" if opened.format == "MPO" else opened.format
    in_colour(data).save(file, kind, quality=_QUALITY)
    return file.getvalue()


def _orientation(picture: "Image.Image") -> int:
    """What EXIF data say of it; 1, upright, where they say nothing that can be read."""
    from PIL import ExifTags

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return int(picture.getexif().get(ExifTags.Base.Orientation, 1))
    except Exception:  # noqa: BLE001 — what a camera wrote there may be anything; viewers go on
        return 1


def in_colour(data: bytes) -> "Image.Image":
    """The same in red, green and blue of 8 bits each, as VLMs take it.

    Raises:
        PictureError: As `decoded` does.
    """
    return as_colour(decoded(data))


def as_colour(picture: "Image.Image") -> "Image.Image":
    """Pixels in red, green and blue; 16 bits of grey, which Pillow would cut off at 255, too."""
    if picture.mode.startswith("I"):
        picture = picture.point(lambda grey: grey / 257).convert("L")
    if picture.mode == "P" and "transparency" in picture.info:  # Pillow warns of the direct way
        picture = picture.convert("RGBA")
    return picture.convert("RGB")


def _opened(data: bytes) -> "Image.Image":
    from PIL import Image, UnidentifiedImageError

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            picture = Image.open(BytesIO(data), formats=("JPEG", "PNG", "WEBP"))
    except UnidentifiedImageError as error:
        raise PictureError("is not a JPEG, PNG or WebP picture. Save it as one") from error
    except Image.DecompressionBombError as error:
        raise PictureError(_TOO_LARGE) from error
    except Exception as error:  # so do readers of headers
        raise PictureError(f"is a damaged picture ({error})") from error
    width, height = picture.size
    if width * height > MOST_PIXELS:
        raise PictureError(f"{width} × {height}: {_TOO_LARGE}")
    if picture.format in ("JPEG", "MPO") and data.count(b"\xff\xda") > _MOST_SCANS:
        raise PictureError("is a JPEG of very many scans. Save it again as an ordinary one")
    return picture


_LOOP = "its links lead in a circle; name the file itself"
_TOO_LARGE = f"has more than {MOST_PIXELS // 10**6} million pixels. Make it smaller"


def _open(path: Path) -> int:
    return os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC | os.O_NOCTTY)


def _open_inside(path: str, folder: Path) -> int:
    """Open a file step by step, so that no link leads elsewhere."""
    parts = path.split("/")
    if any(part in ("", ".", "..") for part in parts):
        raise OSError(0, "its path leads out of the folder")
    kinds = os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC | os.O_NOCTTY
    at = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    for part in parts[:-1]:
        try:
            below = os.open(part, kinds | os.O_NOFOLLOW | os.O_DIRECTORY, dir_fd=at)
        finally:
            os.close(at)
        at = below
    try:
        return os.open(parts[-1], kinds | os.O_NOFOLLOW, dir_fd=at)
    finally:
        os.close(at)


def _is_loop(error: Exception) -> bool:
    return isinstance(error, OSError) and error.errno == errno.ELOOP


def _why(error: Exception) -> str:
    strerror = getattr(error, "strerror", None)
    if _is_loop(error):
        return "it is a link, which is not followed; put the file itself there"
    return str(strerror or error)


def _shown(path: str | Path) -> str:
    """A path for a message: what could steer a terminal, or is not UTF-8, is escaped."""
    text = str(path)
    return text if text.isprintable() else ascii(text)[1:-1]
