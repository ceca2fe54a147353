"""A picture file as an observation."""

from io import BytesIO
from pathlib import Path

from tpvqa.errors import AnswerError
from tpvqa.observation import Frame, Observation


def observe_file(path: str | Path) -> Observation:
    """One look at a picture in a file, of any format that Pillow reads.

    JPEG and PNG are taken as they are, others are turned into PNG.

    Raises:
        AnswerError: The file cannot be read, or is not a picture.
    """
    from PIL import Image, UnidentifiedImageError

    path = Path(path)
    try:
        data = path.read_bytes()
        with Image.open(BytesIO(data)) as picture:
            picture.load()
            media_type = {"JPEG": "image/jpeg", "PNG": "image/png"}.get(picture.format or "")
            if media_type is None:
                as_png = BytesIO()
                picture.convert("RGB").save(as_png, "PNG")
                data, media_type = as_png.getvalue(), "image/png"
    except UnidentifiedImageError as error:
        raise AnswerError(f"{path} is not a picture. Give a JPEG or PNG file.") from error
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        why = getattr(error, "strerror", None) or error
        raise AnswerError(f"{path} cannot be read as a picture: {why}") from error
    frame = Frame(path.stem, "front", data, media_type, source=str(path))
    return Observation(frames={"front": frame})
