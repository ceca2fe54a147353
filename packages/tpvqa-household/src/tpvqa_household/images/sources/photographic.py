"""What a camera does to a picture: exposure, white balance, framing, blur, noise, compression."""

import math
from io import BytesIO

import numpy as np
from PIL import Image, ImageFilter

from tpvqa.chance import chance_array


def photographed(image: Image.Image, seed: int) -> Image.Image:
    """A picture as another camera would have taken it.

    Everything is mild enough for what the picture shows to stay visible.

    Args:
        image: RGB.
        seed: Decides the camera.
    """
    rng = chance_array(seed, 0, "camera")
    width, height = image.size
    angle = float(rng.uniform(-1.5, 1.5))
    turned = image.rotate(angle, Image.Resampling.BICUBIC)
    # The largest middle part that the turn leaves no empty corner in, or somewhat less.
    aspect = max(width, height) / min(width, height)
    scale = rng.uniform(0.96, 1) / (1 + aspect * math.sin(math.radians(abs(angle))))
    left, top = (1 - scale) / 2 * width, (1 - scale) / 2 * height
    box = (left, top, left + scale * width, top + scale * height)
    framed = turned.resize(image.size, Image.Resampling.BICUBIC, box=box)
    sharp = float(rng.uniform(0.0, 0.9)) * width / 224
    light = np.asarray(framed.filter(ImageFilter.GaussianBlur(sharp)), np.float64) / 255
    light = np.clip(light, 0, 1) ** rng.uniform(0.8, 1.25)
    light *= rng.uniform(0.92, 1.08, 3) * rng.uniform(0.85, 1.15)
    rows, columns = np.mgrid[-1 : 1 : height * 1j, -1 : 1 : width * 1j]
    light *= (1 - rng.uniform(0.0, 0.2) * (rows**2 + columns**2) / 2)[..., None]
    grain = rng.uniform(0.0, 0.03)
    light += rng.normal(0.0, 1.0, light.shape) * grain * np.sqrt(np.clip(light, 0.02, 1))
    pixels = (np.clip(light, 0, 1) * 255).round().astype(np.uint8)
    buffer = BytesIO()
    Image.fromarray(pixels).save(buffer, "JPEG", quality=int(rng.integers(55, 92)))
    return Image.open(buffer).convert("RGB")
