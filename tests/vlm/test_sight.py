"""Dead cameras are *cannot see*, and readable pictures are not, however dark."""

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from tests.doubles import worded
from tpvqa.drivers import Parts, Performer
from tpvqa.monitors import Ask
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Action, Conjunction
from tpvqa.questions import Question
from tpvqa.trial import Act, Pending
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.capabilities import NoiseModel
from tpvqa.vlm.sight import ask_seeing, picture_fault
from tpvqa.worlds import Execution, Report
from tpvqa.worlds.capabilities import Noiseless

Pixels = NDArray[np.uint8]
QUESTION = worded("Is the fridge open?")
SHIPPED = sorted(
    (Path(__file__).parents[2] / "packages/tpvqa-household/src/tpvqa_household/images/data").glob(
        "*.jpg"
    )
)


def encoded(pixels: NDArray[np.generic], kind: str = "png", **how: object) -> bytes:
    file = BytesIO()
    Image.fromarray(np.clip(pixels, 0, 255).astype(np.uint8)).save(file, kind, **how)
    return file.getvalue()


def frame(data: bytes, view: str = "front", stamp: float | None = None) -> Frame:
    return Frame("a", view, data, "image/png", stamp=stamp)


def kitchen(darker: float = 1.0, noise: float = 0.0, number: int = 0) -> Pixels:
    pixels = np.asarray(Image.open(SHIPPED[number]).convert("RGB"), np.float64) * darker
    pixels += np.random.default_rng(number).normal(0, noise, pixels.shape) if noise else 0
    return np.clip(pixels, 0, 255).astype(np.uint8)


def static(size: tuple[int, int], *, grey: bool = False, grain: int = 1) -> Pixels:
    rng = np.random.default_rng(1)
    small = rng.integers(0, 256, (*size, 1 if grey else 3), dtype=np.uint8)
    return np.broadcast_to(small.repeat(grain, 0).repeat(grain, 1), (
        size[0] * grain, size[1] * grain, 3))  # fmt: skip


SIZES = [(64, 64), (224, 224), (480, 640)]


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize(
    ("level", "said"), [(0, "black"), (20, "black"), (128, "of one colour"), (255, "white")]
)
def test_one_colour(size: tuple[int, int], level: int, said: str) -> None:
    pixels = np.full((*size, 3), level)
    sensor = np.random.default_rng(0).normal(0, 3, pixels.shape)
    assert said in picture_fault(frame(encoded(pixels)))
    assert picture_fault(frame(encoded(pixels + sensor)))
    assert picture_fault(frame(encoded(pixels + sensor, "jpeg", quality=60)))


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("grey", [True, False])
@pytest.mark.parametrize("quality", [None, 90, 30])
def test_noise(size: tuple[int, int], grey: bool, quality: int | None) -> None:
    pixels = static(size, grey=grey)
    data = encoded(pixels) if quality is None else encoded(pixels, "jpeg", quality=quality)
    assert "noise" in picture_fault(frame(data))


def test_coarse_and_faint_noise() -> None:
    assert "noise" in picture_fault(frame(encoded(static((120, 160), grain=4))))
    faint = 128 + np.random.default_rng(0).normal(0, 15, (224, 224, 3))
    assert "noise" in picture_fault(frame(encoded(faint)))
    specks = np.where(np.random.default_rng(0).random((224, 224, 1)) < 0.02, 255, 0)
    assert "noise" in picture_fault(frame(encoded(specks.repeat(3, 2))))


def test_no_shipped_picture_is_called_dead_by_day_or_night() -> None:
    assert not [path.name for path in SHIPPED if picture_fault(frame(path.read_bytes()))]
    for darker in (0.2, 0.07):
        night = [encoded(kitchen(darker, number=n)) for n in range(0, len(SHIPPED), 20)]
        assert not any(map(picture_fault, map(frame, night)))


def test_a_noisy_picture_at_night_is_readable() -> None:
    night = [encoded(kitchen(0.15, 6.0, n), "jpeg", quality=70) for n in range(0, len(SHIPPED), 20)]
    assert not any(map(picture_fault, map(frame, night)))


def test_patterns_and_single_things_are_seen() -> None:
    board = np.kron(np.indices((8, 8)).sum(0) % 2 * 255, np.ones((28, 28)))
    thing = np.full((224, 224), 250.0)
    thing[100:110, 50:60] = 30
    for pixels in (board, thing):
        assert not picture_fault(frame(encoded(pixels[..., None].repeat(3, 2))))


def test_a_picture_cut_off_in_the_wire_is_damaged() -> None:
    assert "damaged" in picture_fault(frame(SHIPPED[0].read_bytes()[:2000]))
    assert not picture_fault(frame(b"another encoding, left to the VLM"))


class Sure:
    """A VLM that says no to everything, and is sure of it."""

    name = "sure"

    def __init__(self) -> None:
        self.shown: list[tuple[str, ...]] = []

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        self.shown.append(tuple(observation.frames))
        return [Answer(question, Reply.NO, p_yes=0.01) for question in questions]


class SureNoise(Sure, NoiseModel): ...


BLACK, GOOD = encoded(np.zeros((64, 64, 3))), encoded(kitchen())


def test_no_vlm_is_asked_about_a_dead_camera() -> None:
    vlm, noise = Sure(), SureNoise()
    blind = Observation(frames={"front": frame(BLACK)})
    (answer,) = ask_seeing(vlm, blind, [QUESTION])
    assert (answer.reply, answer.p_yes, answer.source) == (Reply.CANNOT_SEE, None, "camera")
    assert answer.text == "the picture is black all over"
    assert not vlm.shown
    assert ask_seeing(noise, blind, [QUESTION])[0].reply is Reply.NO
    assert ask_seeing(vlm, Observation(), [QUESTION])[0].reply is Reply.NO


def test_of_several_views_the_dead_are_left_out() -> None:
    vlm = Sure()
    frames = {"front": frame(BLACK), "hand": frame(GOOD, "hand")}
    assert ask_seeing(vlm, Observation(frames=frames), [QUESTION])[0].reply is Reply.NO
    assert vlm.shown == [("hand",)]
    frames["hand"] = frame(BLACK, "hand")
    (answer,) = ask_seeing(vlm, Observation(frames=frames), [QUESTION])
    assert answer.reply is Reply.CANNOT_SEE
    assert answer.text.startswith("front: the picture is black")


class Robot:
    """A live robot whose camera gives what it is told to."""

    def __init__(self, *data: bytes, stamps: Sequence[float | None] = ()):
        self.looks = zip(data, [*stamps, *[None] * len(data)], strict=False)

    def views(self) -> Sequence[str]:
        return ("front",)

    def observe(self, view: str | None = None) -> Observation:
        data, stamp = next(self.looks)
        return Observation(frames={"front": frame(data, stamp=stamp)})

    def execute(self, action: Action, **_: object) -> Execution:
        return Execution(Report.DONE, 0.0)

    def close(self) -> None: ...


class Simulator(Robot, Noiseless): ...


def replies(world: Robot, steps: str) -> list[Answer]:
    """What is answered when a robot looks (l) and acts (a) in this order."""
    parts = Parts(None, None, None, world, Sure())  # type: ignore[arg-type]
    performer = Performer(parts, save_frame=lambda _: "frames/a.png", snapshots=False)
    answers: list[Answer] = []
    for number, step in enumerate(steps):
        if step == "a":
            performer.perform(Pending(Act(Action("open", ("fridge",), Conjunction(), ()))))
        else:
            seen = performer.look(None, number).value
            answers += performer.perform(Pending(Ask((QUESTION,)), seen=seen)).value
    return answers


OTHER, AGAIN = encoded(kitchen(number=7)), encoded(kitchen(noise=1.0))


@pytest.mark.parametrize(
    ("world", "steps", "frozen"),
    [
        (Robot(GOOD, OTHER), "lal", [False, False]),
        (Robot(GOOD, AGAIN), "lal", [False, False]),
        (Robot(GOOD, GOOD), "lal", [False, True]),
        (Robot(GOOD, GOOD), "ll", [False, False]),
        (Robot(GOOD, GOOD, OTHER), "lalal", [False, True, False]),
        (Robot(GOOD, GOOD, GOOD), "lall", [False, True, True]),
        (Robot(GOOD, OTHER, stamps=(1.0, 2.0)), "lal", [False, False]),
        (Robot(GOOD, OTHER, stamps=(2.0, 2.0)), "lal", [False, True]),
        (Robot(GOOD, OTHER, stamps=(2.0, 1.0)), "lal", [False, True]),
        (Robot(GOOD, GOOD, stamps=(1.0, 2.0)), "lal", [False, True]),
        (Robot(GOOD, OTHER, stamps=(1.0, 1.0)), "ll", [False, False]),
        (Simulator(GOOD, GOOD), "lal", [False, False]),
        (Robot(b"raw", b"raw"), "lal", [False, False]),
    ],
)
def test_a_camera_that_does_not_move_on_is_frozen(
    world: Robot, steps: str, frozen: list[bool]
) -> None:
    found = replies(world, steps)
    assert [answer.reply is Reply.CANNOT_SEE for answer in found] == frozen
    assert all("frozen" in answer.text for answer in found if answer.reply is Reply.CANNOT_SEE)
