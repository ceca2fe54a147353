"""Make a moving picture of a trial: `python tools/episode_gif.py EPISODE OUT.gif`.

Each frame shows what the robot saw last, the plan with the step that it is at, what was asked with
the answers, and what was decided. Needs Pillow, and matplotlib for its fonts.
"""

import argparse
import re
from collections.abc import Iterator, Sequence
from functools import cache
from io import BytesIO
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

from matplotlib import font_manager
from PIL import Image, ImageColor, ImageDraw, ImageFont

from tpvqa.episodes import read_episode
from tpvqa.events import Exchange, Started, TrialState
from tpvqa.events.events import Acted, Acting, Answered, Decided, Ended, Event, Observed, PlanMade
from tpvqa.pictures import decoded, read_picture
from tpvqa.vlm import Reply

WIDTH, HEIGHT, MARGIN = 800, 462, 22
PICTURE = 336
RIGHT = MARGIN + PICTURE + 26
TOP = 58
ROWS = 6
"""Steps of a plan that are shown at once."""
PAPER, INK, SOFT, LINE = "#ffffff", "#17202f", "#667085", "#d9dee7"
BLUE, PALE = "#1d5fd1", "#e8effc"
DECIDED = {"go on": "#15835a", "repeat": "#b4530a", "replan": "#6d3fd0", "done": "#15835a"}
REPLIED = {Reply.YES: BLUE, Reply.NO: INK}
SHADES = 5
"""Of each colour of the text, from its own to the paper's."""
ALIKE = 8
"""Colours that differ by no more, of 256, pass for one."""
STEP, ANSWER, AGAIN, ONWARD, TURN, END = 600, 1100, 400, 900, 2200, 3200
"""Milliseconds that an action, an answer, one more answer, a decision to go on, another decision,
and the end stay."""


class Scene(NamedTuple):
    """What a frame shows.

    Attributes:
        state: Where the trial stands.
        picture: What was seen last, encoded.
        truth: What went wrong without the robot's knowing, where the log tells.
        asked: What was asked about this step, and answered.
        head: What is going on, in a word or two.
        text: The same in a line.
        colour: Of the head.
        lasts: Milliseconds.
    """

    state: TrialState
    picture: bytes | None
    truth: str
    asked: Sequence[Exchange]
    head: str
    text: str
    colour: str
    lasts: int


def scenes(events: Sequence[Event], folder: Path) -> Iterator[Scene]:
    """The frames of an episode."""
    state, picture, truth = TrialState(), None, ""
    asked: list[Exchange] = []
    fresh = False
    for event in events:
        state = state.after(event)
        told: tuple[str, str, str, int] | None = None
        match event:
            case PlanMade() if not event.considered:
                head = "new plan" if state.replans else "plan"
                asked, told = [], (head, _steps(len(event.plan), event.planner), BLUE, TURN)
            case Observed() if event.frames:
                picture = read_picture(event.frames[0].file, inside=folder)
            case Acting():
                asked, truth = [], ""
                told = ("act", event.action.said, BLUE, STEP)
            case Acted() if event.truth is not None and event.truth.failure is not None:
                truth = event.truth.undoing or event.truth.failure.said
            case Answered():
                told = ("look and ask", "", BLUE, AGAIN if asked else ANSWER)
                asked = [*asked, *state.latest]
                fresh = True
            case Decided() if fresh or event.course != "go on":
                fresh = False
                course = event.course if event.course in DECIDED else "go on"
                lasts = ONWARD if course == "go on" else TURN
                told = (event.course, _short(event.reason), DECIDED[course], lasts)
            case Ended():
                reached = event.completed or (event.completed is None and event.believed_goal)
                colour = DECIDED["done" if reached else "repeat"]
                told = ("goal reached" if reached else event.ending, _counts(event), colour, END)
        if told is not None:
            yield Scene(state, picture, truth, asked, *told)


def _steps(number: int, planner: str) -> str:
    return f"{number} step{'s' * (number != 1)}, made by {planner}"


def _counts(ended: Ended) -> str:
    told = ("actions", "questions", "repeats", "replans")
    counted = [(getattr(ended, name), name) for name in told]
    return ", ".join(f"{n} {name[:-1] if n == 1 else name}" for n, name in counted)


def _short(reason: str) -> str:
    """The first thing that a reason says, without what needs it."""
    return re.sub(r", which .*? needs?$", "", reason.split("; ")[0])


def _grouped(asked: Sequence[Exchange]) -> list[tuple[tuple[str, Reply], list[Exchange]]]:
    """Questions that were asked again and answered alike, together."""
    together = groupby(asked, lambda each: (each.question.text, each.answer.reply))
    return [(alike, list(times)) for alike, times in together]


@cache
def font(size: int, bold: bool = False) -> ImageFont.FreeTypeFont:
    """A font that every machine with matplotlib has."""
    weight = "bold" if bold else "normal"
    found = font_manager.FontProperties(family="DejaVu Sans", weight=weight)
    return ImageFont.truetype(font_manager.findfont(found), size)


def _cut(text: str, width: float, face: ImageFont.FreeTypeFont) -> str:
    if face.getlength(text) <= width:
        return text
    while text and face.getlength(text + " …") > width:
        text = text.rpartition(" ")[0] or text[:-1]
    return text + " …"


class Canvas:
    """One frame being drawn."""

    def __init__(self, title: str, goal: str):
        self.image = Image.new("RGB", (WIDTH, HEIGHT), PAPER)
        self.draw = ImageDraw.Draw(self.image)
        self.text(MARGIN, 18, title, 21, bold=True)
        at = MARGIN + font(21, True).getlength(title) + 16
        self.text(at, 22, _cut(f"goal: {goal}", WIDTH - MARGIN - at, font(15)), 15, SOFT)

    def text(
        self, x: float, y: float, text: str, size: int, colour: str = INK, *, bold: bool = False
    ) -> None:
        """Text, by its upper left corner."""
        self.draw.text((x, y), text, colour, font(size, bold))

    def pill(self, x: float, y: float, text: str, colour: str, size: int = 14) -> float:
        """White words on a colour; gives the right end."""
        end = x + font(size, True).getlength(text) + 22
        self.draw.rounded_rectangle((x, y, end, y + size + 12), (size + 12) / 2, colour)
        self.text(x + 11, y + 4, text, size, PAPER, bold=True)
        return end

    def before(self, failure: float | None) -> None:
        """What to know before there is a picture."""
        box = (MARGIN, TOP, MARGIN + PICTURE, TOP + PICTURE)
        self.draw.rounded_rectangle(box, 10, PALE)
        drawn = (
            f"Each action fails with\nprobability {failure:g}.\n"
            if failure
            else "Actions may fail.\n"
        )
        told = f"{drawn}Nobody tells the robot:\nit looks, and asks."
        middle = (MARGIN + PICTURE / 2, TOP + PICTURE / 2)
        self.draw.multiline_text(
            middle, told, INK, font(20), anchor="mm", align="center", spacing=10
        )

    def picture(self, data: bytes, truth: str) -> None:
        """What the robot saw last, and what went wrong that it was not told."""
        box = (MARGIN, TOP, MARGIN + PICTURE, TOP + PICTURE)
        opened = decoded(data)
        seen = opened.convert("RGB").resize((PICTURE, PICTURE), Image.Resampling.LANCZOS)
        mask = Image.new("L", seen.size, 0)
        ImageDraw.Draw(mask).rounded_rectangle((0, 0, PICTURE - 1, PICTURE - 1), 10, 255)
        self.image.paste(seen, box[:2], mask)
        if truth:
            line = _cut(f"unknown to the robot: {truth}", PICTURE - 24, font(13))
            top = TOP + PICTURE - 30
            self.draw.rounded_rectangle((MARGIN, top, MARGIN + PICTURE, top + 30), 10, "#17202f")
            self.text(MARGIN + 12, top + 7, line, 13, PAPER)

    def plan(self, state: TrialState, *, ended: bool) -> None:
        """The plan's steps, the one that comes now marked."""
        said = [action.said for action in state.plan.plan] if state.plan else []
        now = len(said) if ended else state.index
        first = max(0, min(now - ROWS + 2, len(said) - ROWS))
        for row, number in enumerate(range(first, min(first + ROWS, len(said)))):
            y = TOP + 27 * row
            text = f"{number + 1}  {said[number]}"
            if number == now:
                self.draw.rounded_rectangle((RIGHT, y, WIDTH - MARGIN, y + 26), 7, PALE)
                self.text(RIGHT + 30, y + 4, text, 16, BLUE, bold=True)
                arrow = [(RIGHT + 12, y + 7), (RIGHT + 20, y + 13), (RIGHT + 12, y + 19)]
                self.draw.polygon(arrow, BLUE)
            else:
                self.text(RIGHT + 30, y + 4, text, 16, SOFT if number < now else INK)
            if number < now:
                tick = [(RIGHT + 9, y + 13), (RIGHT + 14, y + 18), (RIGHT + 22, y + 8)]
                self.draw.line(tick, DECIDED["done"], 3)

    def answers(self, asked: Sequence[Exchange]) -> None:
        """The latest questions, each with its answer and how likely yes is."""
        y = TOP + 27 * ROWS + 14
        self.draw.line((RIGHT, y - 6, WIDTH - MARGIN, y - 6), LINE)
        for (text, reply), times in _grouped(asked)[-3:]:
            answer = times[-1].answer
            self.text(RIGHT, y + 3, _cut(text, WIDTH - MARGIN - RIGHT, font(16)), 16)
            colour = REPLIED.get(reply, SOFT)
            end = self.pill(RIGHT, y + 26, str(reply), colour, 12)
            if len(times) > 1:
                self.text(end + 12, y + 30, f"{len(times)} times", 13, SOFT)
            elif answer.p_yes is not None and reply in REPLIED:
                bar = (end + 12, y + 34, end + 132, y + 42)
                self.draw.rounded_rectangle(bar, 4, LINE)
                if answer.p_yes > 0.03:
                    filled = (bar[0], bar[1], bar[0] + 120 * answer.p_yes, bar[3])
                    self.draw.rounded_rectangle(filled, 4, colour)
                self.text(end + 142, y + 30, f"P(yes) = {answer.p_yes:.2f}", 13, SOFT)
            y += 56

    def band(self, head: str, text: str, colour: str) -> None:
        """What is going on, along the lower edge."""
        top = TOP + PICTURE + 18
        end = self.pill(MARGIN, top, head, colour, 16)
        self.text(end + 14, top + 5, _cut(text, WIDTH - MARGIN - end - 14, font(15)), 15)


def draw(scene: Scene) -> Image.Image:
    """One frame."""
    started = scene.state.started
    assert started is not None
    canvas = Canvas(started.task, started.goal.replace("?, ", "? "))
    if scene.picture is None:
        simulation = started.config.simulation
        canvas.before(None if simulation is None else simulation.failure)
    else:
        canvas.picture(scene.picture, scene.truth)
    canvas.plan(scene.state, ended=scene.state.ended is not None)
    canvas.answers(scene.asked)
    canvas.band(scene.head, scene.text, scene.colour)
    return canvas.image


def encode(found: Sequence[Scene]) -> bytes:
    """The frames as a GIF that begins again."""
    frames = [draw(scene) for scene in found]
    made = [frame.quantize(palette=_palette(frame), dither=Image.Dither.NONE) for frame in frames]
    out = BytesIO()
    lasting = [scene.lasts for scene in found]
    made[0].save(out, "GIF", save_all=True, append_images=made[1:], duration=lasting, loop=0)
    return out.getvalue()


def _palette(frame: Image.Image) -> Image.Image:
    """The colours of a frame: those of the text as they are, the picture's as near as may be."""
    inks = [ImageColor.getrgb(colour)[:3] for colour in (PAPER, LINE, PALE)]
    paper = inks[0]
    for colour in dict.fromkeys((INK, SOFT, BLUE, *DECIDED.values())):
        full = ImageColor.getrgb(colour)
        for step in range(SHADES):
            r, g, b = (f + step * (p - f) // SHADES for f, p in zip(full, paper, strict=False))
            inks.append((r, g, b))
    box = (MARGIN, TOP, MARGIN + PICTURE, TOP + PICTURE)
    seen = frame.crop(box).quantize(256 - len(inks)).getpalette() or []
    colours = [value for ink in inks for value in ink]
    for found in zip(*[iter(seen)] * 3, strict=True):
        # A colour of the picture that is nearly one of the text must not be taken for it.
        if all(max(abs(x - y) for x, y in zip(found, ink, strict=True)) > ALIKE for ink in inks):
            colours += found
    palette = Image.new("P", (1, 1))
    palette.putpalette(colours)
    return palette


def main() -> None:
    """Read an episode and write the GIF."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("episode", type=Path, help="an episode's folder, as `tpvqa run` leaves it")
    parser.add_argument("out", type=Path)
    given = parser.parse_args()
    events = read_episode(given.episode)
    assert isinstance(events[0], Started)
    found = list(scenes(events, given.episode))
    data = encode(found)
    given.out.write_bytes(data)
    seconds = sum(scene.lasts for scene in found) / 1000
    print(f"{given.out}: {len(found)} frames, {seconds:.0f} s, {len(data) / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
