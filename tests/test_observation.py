"""What a robot sees: media types, depth, and what the loop numbers."""

import re
import subprocess
import sys
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from PIL import Image

from tpvqa.assembly import Trial
from tpvqa.config import TrialConfig
from tpvqa.drivers import Parts, Performer
from tpvqa.episodes import EpisodeWriter
from tpvqa.events.events import Observed
from tpvqa.events.records import observation_from
from tpvqa.observation import NPY, PNG, Depth, Frame, Intrinsics, LateDepth, LateFrame, Observation

DISTANCES = arrays.arrays(
    np.float32,
    st.tuples(st.integers(1, 6), st.integers(1, 6)),
    elements=st.floats(2**-9, 65.5, width=32) | st.just(float("nan")),
)


def test_types_are_there_without_numpy_and_pillow() -> None:
    script = (
        "import sys, tpvqa.observation; sys.exit('numpy' in sys.modules or 'PIL' in sys.modules)"
    )
    subprocess.run([sys.executable, "-c", script], check=True)


@pytest.mark.parametrize(
    ("media_type", "suffix"),
    [
        ("image/jpeg", ".jpg"),
        ("image/png", ".png"),
        ("image/webp", ".webp"),
        ("Image/PNG; quality=1", ".png"),
        ("image/x-nothing", ".nothing"),
        ("application/x-npy", ".npy"),
        ("picture", ".bin"),
        ("image/../../etc", ".bin"),
    ],
)
def test_every_media_type_has_a_file_ending(media_type: str, suffix: str) -> None:
    assert Frame("a", "front", b"", media_type).suffix == suffix


@given(st.text())
def test_a_file_ending_is_only_that(media_type: str) -> None:
    assert re.fullmatch(r"\.[a-z0-9]+", Frame("a", "front", b"", f"image/{media_type}").suffix)


@pytest.mark.parametrize("kind", ["png", "webp"])
def test_pictures_have_pixels(kind: str) -> None:
    red = np.zeros((2, 3, 3), np.uint8)
    red[..., 0] = 255
    file = BytesIO()
    Image.fromarray(red).save(file, kind, **({"lossless": True} if kind == "webp" else {}))
    assert (Frame("a", "front", file.getvalue(), f"image/{kind}").pixels == red).all()


@given(DISTANCES)
def test_depth_comes_back_in_metres(metres: np.ndarray) -> None:
    exact = Depth.from_metres(metres, NPY)
    assert exact.metres.dtype == np.float32
    np.testing.assert_array_equal(exact.metres, metres)
    rounded = Depth.from_metres(metres, PNG)
    np.testing.assert_allclose(rounded.metres, metres, atol=0.000505, rtol=0)
    again = Depth.from_metres(rounded.metres, PNG)
    np.testing.assert_array_equal(again.metres, rounded.metres)
    assert (exact.suffix, rounded.suffix) == (".npy", ".png")


def test_what_was_not_measured_is_nan() -> None:
    metres = np.array([[0.0, -1.0, 66.0, np.inf, np.nan, 1.5]])
    assert np.isnan(Depth.from_metres(metres).metres[0, :5]).all()
    assert Depth.from_metres(metres).metres[0, 5] == 1.5


def test_what_is_no_depth_image_is_refused() -> None:
    with pytest.raises(ValueError, match="image/png or application/x-npy"):
        Depth(b"", "image/jpeg")
    file = BytesIO()
    Image.new("L", (2, 2)).save(file, "png")
    with pytest.raises(ValueError, match="16 bits"):
        Depth(file.getvalue()).metres  # noqa: B018
    with pytest.raises(ValueError, match="height × width"):
        Depth.from_metres(np.zeros((2, 2, 3)), NPY).metres  # noqa: B018


class Cameras:
    """A world that counts nothing."""

    def views(self) -> tuple[str, ...]:
        return ("front", "hand")

    def observe(self, view: str | None = None) -> Observation:
        camera = Intrinsics(600.0, 600.0, 319.5, 239.5, 640, 480)
        depth = Depth.from_metres(np.ones((2, 3)), NPY)
        frames = {
            each: Frame("now", each, b"a picture", stamp=2.5, intrinsics=camera, depth=depth)
            for each in self.views()
        }
        return Observation(time=2.6, frames=frames)


def test_looks_are_numbered_frames_named_and_all_of_it_is_read_back(tmp_path: Path) -> None:
    writer = EpisodeWriter(tmp_path)
    with Trial(TrialConfig(task="build_tower", world="symbolic", vlm="oracle")) as trial:
        parts = trial.parts
        cameras = Parts(parts.task, parts.book, parts.planner, Cameras(), parts.vlm)  # type: ignore[arg-type]
        performer = Performer(cameras, save_frame=writer.save_frame)
        looks = [performer.look(None, number) for number in range(3)]
    writer.close()
    last = looks[2].event
    assert isinstance(last, Observed)
    assert [frame.file for frame in last.frames] == [
        "frames/0002-front.jpg",
        "frames/0002-hand.jpg",
    ]
    seen: Observation = looks[2].value
    assert seen.look == 2
    assert seen.frames["hand"].stamp == 2.5
    again = observation_from(Observed.model_validate_json(last.model_dump_json()), tmp_path)
    assert again == seen


def test_a_late_frame_is_drawn_when_it_is_looked_at_and_once() -> None:
    drawn: list[str] = []

    def draw() -> bytes:
        drawn.append("picture")
        return b"a picture"

    def measure() -> bytes:
        drawn.append("depth")
        return b"distances"

    frame = LateFrame("now", "front", draw, stamp=2.5, depth=LateDepth(measure))
    named = frame.named("0000-front")
    assert frame.depth is not None
    assert (named.id, named.suffix, frame.depth.suffix, drawn) == ("0000-front", ".jpg", ".png", [])
    assert (frame.data, named.data, drawn) == (b"a picture", b"a picture", ["picture"])
    assert replace(named, data=b"smaller").data == b"smaller"
    assert (frame.depth.data, frame.depth.data) == (b"distances", b"distances")
    assert drawn == ["picture", "depth"]
    with pytest.raises(ValueError, match="a depth image is"):
        LateDepth(measure, "image/jpeg")
