"""One self-contained HTML page about an episode: pictures, questions, answers, decisions."""

import base64
import os
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from tpvqa.episodes.answers_worth import AnswersWorth, calibration_used
from tpvqa.episodes.fact_words import words_of
from tpvqa.episodes.log import episode_folder, read_episode
from tpvqa.episodes.notable_facts import probability
from tpvqa.episodes.own_files import belongs_to
from tpvqa.episodes.report.belief_chart import chart
from tpvqa.episodes.report.story import Story, tell
from tpvqa.episodes.true_start import true_start_said
from tpvqa.errors import EpisodeError, PictureError
from tpvqa.events.events import Event, Started
from tpvqa.files import opened_plain, write_whole
from tpvqa.pages import template
from tpvqa.pictures import picture_type, read_picture
from tpvqa.questions import FactWords

if TYPE_CHECKING:
    from jinja2 import Template

__all__ = ["Story", "render_report", "tell", "write_report"]


MOST = 256 * 2**20
"""Bytes of all pictures of a page at most; those beyond are named in it, but not shown."""
_FIRST, _TITLE = b"<!doctype html>", " · tpvqa episode</title>".encode()
"""What the first line of a page is, and its third ends with."""
_LONGEST = 2**16
"""Bytes of such a line."""


class Shown(NamedTuple):
    """A picture as the page holds it: its source, or why there is none."""

    source: str = ""
    why: str = ""


def write_report(folder: Path | str, out: Path | str | None = None, *, force: bool = False) -> Path:
    """Write the page; it needs nothing beside it.

    Args:
        folder: The episode's folder, or its `episode.jsonl`.
        out: The file to write; `report.html` in the folder by default. An earlier report that
            lies there is written over.
        force: Whether any other file that lies there may be, too; none of the episode's own is.

    Returns:
        The file that was written.

    Raises:
        EpisodeError: There is no episode, or no folder to write the page in; or what lies there
            is to be kept.
        WriteError: The page cannot be written.
    """
    folder = episode_folder(folder)
    path = folder / "report.html" if out is None else Path(out)
    if path.is_dir():
        raise EpisodeError(f"{path} is a folder; name the file to write, e.g. {path}/report.html")
    if out is not None and not path.parent.is_dir():
        raise EpisodeError(f"{path}: there is no folder {path.parent}; make it, or name another")
    # A link that lies in the folder of an episode was put there by who gave it away.
    _see_free(path, folder, force=force or (out is None and path.is_symlink()))
    page = render_report(read_episode(folder), folder)
    data = page.encode(errors="replace")
    write_whole(path, data, remedy="Name another file with --out")
    return path


def _see_free(path: Path, folder: Path, *, force: bool) -> None:
    if belongs_to(path, folder):
        raise EpisodeError(
            f"{path} is what the episode consists of, and would be lost; name another file with "
            "--out"
        )
    if not (force or not os.path.lexists(path) or _is_report(path)):
        raise EpisodeError(
            f"{path} is there, and is no report of an episode; name another file with --out, or "
            "write over it with --force"
        )


def _is_report(path: Path) -> bool:
    """Whether a file is a page that was written here, by its head."""
    try:
        with opened_plain(path) as descriptor, open(descriptor, "rb", closefd=False) as file:
            first, _, titled = (file.readline(_LONGEST).rstrip() for _ in range(3))
    except OSError:
        return False
    return first == _FIRST and titled.endswith(_TITLE)


def render_report(events: list[Event], folder: Path) -> str:
    """The page as text, pictures embedded."""
    left = MOST

    @cache
    def picture(file: str) -> Shown:
        nonlocal left
        try:
            data = read_picture(file, inside=folder)
        except PictureError as error:
            return Shown(why=str(error))
        if len(data) > left:
            return Shown(why=f"{file}: the pictures of this page have {MOST:,} bytes already")
        left -= len(data)
        return Shown(f"data:{picture_type(data)};base64,{base64.b64encode(data).decode()}")

    first = events[0] if events else None
    words = words_of(first) if isinstance(first, Started) else FactWords()
    story, worth = tell(events, words), AnswersWorth()
    for event in events:
        worth.take(event)
    return _page().render(
        story=story,
        picture=picture,
        chart=chart(story, words.say),
        say=words.say,
        probability=probability,
        calibration=calibration_used(story.started),
        begun=true_start_said(story.started, words.say),
        saves=worth.more_would_save(),
        unmet="; ".join(map(words.say, story.ended.unmet or ())) if story.ended else "",
    )


@cache
def _page() -> "Template":
    return template("tpvqa.episodes.report")
