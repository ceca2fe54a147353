"""Pictures → an MP4, and a GIF that is small enough for a page."""

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tpvqa.errors import MissingExtraError, WriteError
from tpvqa.files import write_whole
from tpvqa_robots import DISTRIBUTION

GIF_SIZE, GIF_COLOURS = (720, 360), 128
_RARE = 48
"""Colours of small things, among the others."""
GIF_BYTES = 3_000_000
"""How large a GIF may be."""
REMEDY = "Make room, or name another folder with --out"


def write_mp4(file: Path, pictures: Sequence[NDArray[np.uint8]], *, rate: int) -> None:
    """Write a film as H.264, by ffmpeg in a process of its own.

    Raises:
        MissingExtraError: imageio-ffmpeg is not installed.
        WriteError: ffmpeg could not write it.
    """
    try:
        from imageio_ffmpeg import write_frames
    except ModuleNotFoundError as error:
        raise MissingExtraError(
            "imageio_ffmpeg", "sim", "An MP4", distribution=DISTRIBUTION
        ) from error
    height, width, _ = pictures[0].shape
    try:
        with TemporaryDirectory() as folder:  # a film that was begun is none
            encoded = Path(folder, file.name)
            to = write_frames(
                str(encoded), (width, height), fps=rate, quality=7, macro_block_size=1
            )
            to.send(None)
            for picture in pictures:
                to.send(np.ascontiguousarray(picture))
            to.close()
            data = encoded.read_bytes()
    except OSError as error:
        raise WriteError(f"{file} could not be encoded: {error}. {REMEDY}.") from error
    write_whole(file, data, remedy=REMEDY)


def write_gif(file: Path, pictures: Sequence[NDArray[np.uint8]], *, rate: int) -> None:
    """Write a film as a GIF of at most `GIF_BYTES`, with as many pictures as fit into that.

    Raises:
        WriteError: Not even one picture in 32 fits, or it cannot be written.
    """
    for every in (2, 3, 4, 6, 8, 12, 16, 32):
        small = [
            Image.fromarray(picture).resize(GIF_SIZE, Image.Resampling.LANCZOS)
            for picture in pictures[::every]
        ]
        palette = _palette(small[:: max(1, len(small) // 6)])
        frames = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in small]
        encoded = BytesIO()
        frames[0].save(
            encoded,
            format="GIF",
            save_all=True,
            append_images=frames[1:],
            duration=round(1000 * every / rate),
            loop=0,
            optimize=True,
        )
        if encoded.tell() <= GIF_BYTES:
            write_whole(file, encoded.getvalue(), remedy=REMEDY)
            return
    raise WriteError(f"{file} would be larger than {GIF_BYTES / 1e6:g} MB.")


def _palette(pictures: Sequence[Image.Image]) -> Image.Image:
    """Colours for all of some pictures: the commonest, and those of small things."""
    width, height = pictures[0].size
    together = Image.new("RGB", (width, height * len(pictures)))
    for number, picture in enumerate(pictures):
        together.paste(picture, (0, number * height))
    most = together.quantize(GIF_COLOURS - _RARE, method=Image.Quantize.MEDIANCUT)
    rare = together.quantize(_RARE, method=Image.Quantize.MAXCOVERAGE)
    colours: list[int] = []
    for found, wanted in ((most, GIF_COLOURS - _RARE), (rare, _RARE)):
        colours += (found.getpalette() or [])[: 3 * wanted]
    palette = Image.new("P", (1, 1))
    palette.putpalette(colours)
    return palette
