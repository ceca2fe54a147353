"""Takes the pictures of a film while a trial runs: the room, what the robot sees, what is asked."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from tpvqa_robots.toys.cameras import OVERHEAD, ROOM
from tpvqa_robots.world import ToysWorld

RATE, SPEED = 10, 5.0
"""Pictures a second, and how much quicker than the robot's own time the film is."""
READING = 1.3
"""Seconds for which answers and decisions stand."""
SIZE = (960, 480)
_INK, _DIM = (28, 30, 34), (110, 115, 122)
_COLOURS = {"yes": (26, 127, 55), "no": (190, 38, 30), "unknown": (150, 110, 10)}
_DECISIONS = {"go on": (26, 127, 55), "repeat": (180, 95, 6), "replan": (190, 38, 30)}


class Recorder:
    """A listener to a trial's events that draws its world.

    Args:
        world: The world of the trial.
        speed: How much quicker than the robot's own time the film is.
    """

    def __init__(self, world: ToysWorld, *, speed: float = SPEED):
        self.pictures: list[NDArray[np.uint8]] = []
        self._world, self._next = world, 0.0
        self._speed = speed
        self._said: dict[str, str] = {}
        self._asked: tuple[str, ...] = ()
        self._action = self._course = ""
        self._answers: list[tuple[str, str]] = []
        self._last: tuple[Any, Any] | None = None
        world.robot.machine.on_tick = self.tick

    def tick(self) -> None:
        """Draw one picture whenever it is time for it."""
        machine = self._world.robot.machine
        if machine.time < self._next:
            return
        self._next = machine.time + self._speed / RATE
        self._draw()

    def __call__(self, event: Any) -> None:
        """Take in what the trial says."""
        match event.kind:
            case "plan made":
                self._said |= {step.pddl(): step.said for step in event.plan}
            case "acting":
                self._action, self._answers, self._course = event.action.said, [], ""
            case "asked":
                self._asked = tuple(question.text for question in event.questions)
            case "answered":
                replies = (str(answer.reply.value) for answer in event.answers)
                self._answers += list(zip(self._asked, replies, strict=True))
            case "decided" if event.acts or event.when == "after" or event.course != "go on":
                name = self._said.get(event.action, event.action)
                self._action = f"{event.when}: {name}"
                self._course = str(event.course)
                self._hold(READING if self._answers else 0.2)
                self._answers = []
            case "ended":
                self._course = "goal reached" if event.completed else str(event.ending)
                self._hold(2.5)

    def _draw(self) -> None:
        robot = self._world.robot
        data, cameras = robot.machine.data, robot.cameras
        self._last = cameras.picture(data, ROOM), cameras.picture(data, OVERHEAD)
        self.pictures.append(self._composed())

    def _hold(self, seconds: float) -> None:
        if self._last is None:
            self._draw()
        self.pictures += [self._composed()] * max(1, round(seconds * RATE))

    def _composed(self) -> NDArray[np.uint8]:
        assert self._last is not None
        room, seen = self._last
        canvas = Image.new("RGB", SIZE, (250, 250, 251))
        canvas.paste(Image.fromarray(room), (0, 0))
        canvas.paste(Image.fromarray(seen).resize((320, 240), Image.Resampling.LANCZOS), (640, 0))
        draw = ImageDraw.Draw(canvas)
        large, small = (ImageFont.load_default(size=size) for size in (18, 14))
        y = 250
        for line in _lines(self._action, 34):
            draw.text((652, y), line, _INK, large)
            y += 22
        y += 10
        for text, reply in self._answers[:6]:
            for line in _lines(text, 40):
                draw.text((652, y), line, _INK, small)
                y += 17
            draw.text((664, y), reply, _COLOURS.get(reply, _DIM), small)
            y += 20
        if self._course:
            colour = _DECISIONS.get(self._course, _INK)
            draw.text((652, 452), self._course, colour, large)
        clock = f"{self._world.robot.machine.time:.0f} s, {self._speed:g} times as fast"
        draw.text((12, 456), clock, (235, 236, 238), small)
        return np.asarray(canvas)


def _lines(text: str, width: int) -> list[str]:
    lines = [""]
    for word in text.split():
        if len(lines[-1]) + len(word) >= width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return lines
