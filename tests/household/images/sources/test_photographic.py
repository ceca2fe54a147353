"""What another camera does to a picture."""

from io import BytesIO

import numpy as np
from PIL import Image

from tpvqa_household.images.manifest import load_pictures
from tpvqa_household.images.sources.photographic import photographed
from tpvqa_household.images.sources.picture_file import LONGEST, as_jpeg, read_picture


def test_a_seed_is_a_camera() -> None:
    image = Image.linear_gradient("L").convert("RGB")
    one = np.asarray(photographed(image, 1))
    assert one.shape == (256, 256, 3)
    assert np.array_equal(one, np.asarray(photographed(image, 1)))
    assert not np.array_equal(one, np.asarray(photographed(image, 2)))


def test_what_a_picture_shows_stays_visible() -> None:
    pictures = load_pictures()
    for number, entry in enumerate(pictures.manifest.pictures[::60]):
        image = read_picture(pictures.read(entry))
        taken = photographed(image, number)
        small = [np.asarray(one.convert("L").resize((24, 24)), float) for one in (image, taken)]
        assert np.corrcoef(small[0].ravel(), small[1].ravel())[0, 1] > 0.85


def test_no_corner_is_left_empty() -> None:
    white = Image.new("RGB", (224, 160), "white")
    for seed in range(40):
        taken = np.asarray(photographed(white, seed), float).mean(2)
        corners = [taken[y, x] for y in (0, -1) for x in (0, -1)]
        assert min(corners) > 100


def test_pictures_are_upright_small_and_without_metadata() -> None:
    exif = Image.Exif()
    exif[0x0112] = 6  # the camera was held sideways
    exif[0x010F] = "a camera's maker"
    buffer = BytesIO()
    Image.new("RGB", (1200, 600), "red").save(buffer, "JPEG", exif=exif)
    data = as_jpeg(read_picture(buffer.getvalue()))
    with Image.open(BytesIO(data)) as kept:
        assert kept.size == (LONGEST // 2, LONGEST)
        assert not kept.getexif()
