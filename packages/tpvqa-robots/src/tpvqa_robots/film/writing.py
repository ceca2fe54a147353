"""Pictures → an MP4, and a GIF that is small enough for a page."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tpvqa.errors import MissingExtraError, WriteError
from tpvqa_robots import DISTRIBUTION

GIF_SIZE, GIF_COLOURS = (720, 360), 64
GIF_BYTES = 3_000_000
"""How large a GIF may be."""


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
        to = write_frames(str(file), (width, height), fps=rate, quality=7, macro_block_size=1)
        to.send(None)
        for picture in pictures:
            to.send(np.ascontiguousarray(picture))
        to.close()
    except OSError as error:
        raise WriteError(f"{file} could not be written: {error}") from error


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
        palette = small[len(small) // 2].quantize(GIF_COLOURS)
        frames = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in small]
        try:
            frames[0].save(
                file,
                save_all=True,
                append_images=frames[1:],
                duration=round(1000 * every / rate),
                loop=0,
                optimize=True,
            )
        except OSError as error:
            raise WriteError(f"{file} could not be written: {error}") from error
        if file.stat().st_size <= GIF_BYTES:
            return
    file.unlink()
    raise WriteError(f"{file} would be larger than {GIF_BYTES / 1e6:g} MB.")
