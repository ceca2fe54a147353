"""Pictures of strangers: what is read from disk, and what is decoded."""

import os
import socket
import struct
import zlib
from collections.abc import Callable
from contextlib import suppress
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image, ImageOps

from tpvqa.errors import PictureError
from tpvqa.observation import Frame
from tpvqa.pictures import (
    MOST_BYTES,
    decoded,
    in_colour,
    picture_type,
    read_file,
    read_picture,
    upright,
)


def encoded(kind: str, size: tuple[int, int] = (4, 3)) -> bytes:
    file = BytesIO()
    Image.new("RGB", size, (200, 30, 30)).save(file, kind)
    return file.getvalue()


def png_that_says(width: int, height: int) -> bytes:
    """A PNG of a few bytes whose header promises many pixels."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", b"") + chunk(b"IEND", b"")


@pytest.mark.parametrize("kind", ["jpeg", "png", "webp"])
def test_jpeg_png_and_webp_are_read(kind: str, tmp_path: Path) -> None:
    (tmp_path / "picture").write_bytes(encoded(kind))
    data = read_picture(tmp_path / "picture")
    assert read_picture("picture", inside=tmp_path) == data == encoded(kind)
    assert picture_type(data) == f"image/{kind}"
    assert decoded(data).size == (4, 3)


def test_sixteen_bits_of_grey_are_as_light_as_they_were() -> None:
    file = BytesIO()
    Image.frombytes("I;16", (2, 1), struct.pack("<HH", 0, 137 * 257)).save(file, "PNG")
    assert np.asarray(in_colour(file.getvalue())).tolist() == [[[0] * 3, [137] * 3]]


@pytest.mark.filterwarnings("error")
def test_a_palette_with_transparent_colours_is_read_without_a_warning() -> None:
    file = BytesIO()
    picture = Image.new("P", (2, 1))
    picture.putpalette([200, 30, 30, 30, 200, 30])
    picture.putdata([0, 1])
    picture.save(file, "PNG", transparency=b"\xff\x40")
    assert np.asarray(in_colour(file.getvalue())).tolist() == [[[200, 30, 30], [30, 200, 30]]]


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (encoded("bmp"), "JPEG, PNG or WebP"),
        (encoded("gif"), "JPEG, PNG or WebP"),
        (b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n", "JPEG, PNG or WebP"),
        (b"", "JPEG, PNG or WebP"),
        (png_that_says(13000, 13000), "13000 × 13000: has more than 50 million pixels"),
        (png_that_says(100_000, 100_000), "million pixels"),
        (encoded("jpeg") + b"\xff\xda" * 200, "scans"),
    ],
    ids=["bmp", "gif", "eps", "empty", "169 megapixels", "10 gigapixels", "scans"],
)
def test_what_is_no_picture_or_too_large_is_told_before_it_is_decoded(
    data: bytes, said: str, tmp_path: Path, recwarn: pytest.WarningsRecorder
) -> None:
    (tmp_path / "picture.jpg").write_bytes(data)
    with pytest.raises(PictureError, match=said) as caught:
        read_picture(tmp_path / "picture.jpg")
    assert str(caught.value).startswith(f"{tmp_path / 'picture.jpg'}: ")
    with pytest.raises(PictureError, match=said):
        Frame("a", "front", data).pixels  # noqa: B018
    assert not recwarn.list


@given(st.binary(max_size=200), st.integers(0, 300), st.sampled_from(["jpeg", "png", "webp"]))
def test_damaged_pictures_are_pictures_or_told(junk: bytes, at: int, kind: str) -> None:
    whole = encoded(kind)
    with suppress(PictureError):
        decoded(whole[:at] + junk + whole[at + len(junk) :])


def fifo(path: Path) -> None:
    os.mkfifo(path)


def device(path: Path) -> None:
    path.symlink_to("/dev/zero")


def listening(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as one:
        one.bind(str(path))


@pytest.mark.parametrize("make", [fifo, device, listening, Path.mkdir])
def test_what_is_no_regular_file_is_told_and_nobody_waits(
    make: Callable[[Path], None], tmp_path: Path
) -> None:
    make(tmp_path / "p.png")
    for inside in (None, tmp_path):
        with pytest.raises(PictureError, match=r"p\.png: "):
            read_file("p.png" if inside else tmp_path / "p.png", inside=inside)


def test_a_file_that_is_too_large_is_told(tmp_path: Path) -> None:
    with (tmp_path / "p.png").open("wb") as file:
        file.truncate(MOST_BYTES + 1)
    with pytest.raises(PictureError, match="more than 32 MiB"):
        read_file(tmp_path / "p.png")
    assert len(read_file(tmp_path / "p.png", most=MOST_BYTES + 1)) == MOST_BYTES + 1


@pytest.mark.parametrize(
    "path",
    [
        "../secret.png",
        "below/../../secret.png",
        "/etc/hostname",
        "link.png",
        "folder/secret.png",
        "loop/below/p.png",
        "p.png/",
        "./p.png",
        "",
        ".",
        "p.png\0",
        "missing.png",
        "n" * 300,
        "\x1b[2J.png",
        "\udcff.png",
    ],
)
def test_a_path_that_leads_out_of_the_folder_is_not_followed(path: str, tmp_path: Path) -> None:
    folder = tmp_path / "set"
    (folder / "below").mkdir(parents=True)
    (tmp_path / "secret.png").write_bytes(encoded("png"))
    (folder / "p.png").write_bytes(encoded("png"))
    (folder / "below" / "p.png").write_bytes(encoded("png"))
    (folder / "link.png").symlink_to(tmp_path / "secret.png")
    (folder / "folder").symlink_to(tmp_path)
    (folder / "loop").symlink_to(folder)
    assert read_file("below/p.png", inside=folder)
    with pytest.raises(PictureError) as caught:
        read_file(path, inside=folder)
    assert str(caught.value).isprintable()
    str(caught.value).encode()


def test_the_folder_itself_may_be_a_link(tmp_path: Path) -> None:
    (tmp_path / "set").mkdir()
    (tmp_path / "set" / "p.png").write_bytes(encoded("png"))
    (tmp_path / "here").symlink_to(tmp_path / "set")
    assert read_picture("p.png", inside=tmp_path / "here")


def _phone(
    kind: str, size: tuple[int, int] = (60, 40), orientation: int = 6, damage: int | None = None
) -> bytes:
    """A picture that is red at its left, blue at its right, and says how it is to be turned.

    Args:
        kind: Its format.
        size: Its size as it is kept.
        orientation: How it is to be turned.
        damage: The kind of number, as EXIF counts them, that another of its tags claims to be.
    """
    picture = Image.new("RGB", size, "red")
    picture.paste("blue", (size[0] // 2, 0, *size))
    exif = Image.Exif()
    exif[0x0112] = orientation
    exif[0x0128] = 2
    said = exif.tobytes()
    if damage is not None:
        kept = struct.pack(">HHL", 0x0128, 3, 1)
        assert kept in said
        said = said.replace(kept, struct.pack(">HHL", 0x0128, damage, 1))
    file = BytesIO()
    picture.save(file, kind, exif=said)
    return file.getvalue()


@pytest.mark.parametrize("kind", ["JPEG", "PNG", "WEBP"])
def test_a_picture_of_a_phone_is_upright_to_everybody(kind: str) -> None:
    data = _phone(kind)
    for picture in (decoded(data), decoded(upright(data)), Image.open(BytesIO(upright(data)))):
        assert picture.size == (40, 60)
        above, below = (np.asarray(picture.convert("RGB"))[row, 20] for row in (10, 50))
        assert above[0] > 200 > 50 > above[2]
        assert below[2] > 200 > 50 > below[0]
        assert not dict(picture.getexif()).get(0x0112)
    assert Frame("a", "front", data).pixels.shape == (60, 40, 3)
    assert picture_type(upright(data)) == picture_type(data)


@pytest.mark.parametrize("orientation", range(1, 9))
def test_every_orientation_is_turned_as_viewers_do(orientation: int) -> None:
    data = _phone("PNG", orientation=orientation)
    shown = ImageOps.exif_transpose(Image.open(BytesIO(data)))
    assert np.array_equal(np.asarray(decoded(data)), np.asarray(shown))


@pytest.mark.parametrize("kind", ["JPEG", "PNG", "WEBP"])
@pytest.mark.parametrize("damage", [2, 4, 7, 12])
def test_a_tag_that_is_damaged_keeps_no_picture_from_being_upright(kind: str, damage: int) -> None:
    data = _phone(kind, damage=damage)
    assert decoded(data).size == decoded(upright(data)).size == in_colour(data).size == (40, 60)


@pytest.mark.parametrize("orientation", [1, 9, 0])
def test_what_is_not_turned_keeps_every_byte(orientation: int) -> None:
    data = _phone("JPEG", orientation=orientation)
    assert upright(data) is data
    assert decoded(data).size == (60, 40)


def test_exif_data_that_are_nonsense_turn_nothing() -> None:
    data = _phone("JPEG")
    broken = data.replace(b"Exif\0\0MM\0*", b"Exif\0\0XX\0*")
    assert broken != data
    assert decoded(broken).size == (60, 40)


def test_links_in_a_circle_are_called_that(tmp_path: Path) -> None:
    path = tmp_path / "round.png"
    path.symlink_to(path)
    with pytest.raises(PictureError, match="its links lead in a circle; name the file itself"):
        read_file(path)
