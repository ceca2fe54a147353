"""A picture as it might have been taken at another time: nearer, tilted, in other light."""

import numpy as np
from PIL import Image, ImageEnhance

from tpvqa.chance import chance_array

_NEARER = 0.85
"""The least share of width and height that is left."""
_TILTED = 4.0
"""Degrees, at most."""
_LIT = 0.3
"""How far brightness and saturation go, as a logarithm."""


def variant(picture: Image.Image, name: str, number: int, seed: int) -> Image.Image:
    """Another view of a picture. Left stays left, and colours stay what they are.

    Args:
        picture: In RGB.
        name: Of the picture; decides the view together with the number and the seed.
        number: Of the view; 0 is the picture itself.
        seed: Of all.
    """
    if number == 0:
        return picture
    rng = chance_array(seed, 0, "view of teaching", name, number)
    share, tilt = rng.uniform(_NEARER, 1.0), rng.uniform(-_TILTED, _TILTED)
    light, colour = np.exp(rng.uniform(-_LIT, _LIT, 2))
    width, height = picture.size
    left, top = rng.uniform(0, (1 - share) * width), rng.uniform(0, (1 - share) * height)
    box = (left, top, left + share * width, top + share * height)
    seen = picture.resize((width, height), Image.Resampling.BILINEAR, box=box)
    seen = seen.rotate(tilt, Image.Resampling.BILINEAR)
    seen = ImageEnhance.Brightness(seen).enhance(float(light))
    return ImageEnhance.Color(seen).enhance(float(colour))
