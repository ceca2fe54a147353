"""A picture file as an observation; and a picture to try a server with."""

from io import BytesIO
from pathlib import Path

from tpvqa.errors import PictureError
from tpvqa.observation import PNG, Frame, Observation
from tpvqa.pictures import decoded, picture_type, read_picture


def observe_file(path: str | Path) -> Observation:
    """One look at a picture in a file.

    JPEG and PNG are taken as they are, WebP, which few servers read, is made a PNG.

    Raises:
        PictureError: It is no regular file, no JPEG, PNG or WebP, damaged, or too large.
    """
    path = Path(path)
    data = read_picture(path)
    media_type = picture_type(data)
    try:
        picture = decoded(data)
    except PictureError as error:
        raise PictureError(f"{path}: {error}") from error
    if media_type == "image/webp":
        as_png = BytesIO()
        picture.convert("RGB").save(as_png, "PNG")
        data, media_type = as_png.getvalue(), PNG
    frame = Frame(path.stem, "front", data, media_type, source=str(path))
    return Observation(frames={"front": frame})


def grey_frame() -> Frame:
    """A picture that is grey all over."""
    from PIL import Image

    file = BytesIO()
    Image.new("RGB", (64, 64), (128, 128, 128)).save(file, "png")
    return Frame("check", "front", file.getvalue(), PNG)
