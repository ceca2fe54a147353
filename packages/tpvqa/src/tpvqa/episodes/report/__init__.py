"""One self-contained HTML page about an episode: pictures, questions, answers, decisions."""

import base64
from contextlib import suppress
from pathlib import Path

from tpvqa.episodes.fact_words import words_of
from tpvqa.episodes.log import episode_folder, read_episode
from tpvqa.episodes.notable_facts import probability
from tpvqa.episodes.report.belief_chart import chart
from tpvqa.episodes.report.story import Story, tell
from tpvqa.errors import EpisodeError
from tpvqa.events.events import Event, FrameRecord

__all__ = ["Story", "render_report", "tell", "write_report"]


def write_report(folder: Path | str, out: Path | str | None = None) -> Path:
    """Write the page; it needs nothing beside it.

    Args:
        folder: The episode's folder, or its `episode.jsonl`.
        out: The file to write; `report.html` in the folder by default.

    Returns:
        The file that was written.

    Raises:
        EpisodeError: There is no episode, or the page cannot be written.
    """
    folder = episode_folder(folder)
    path = folder / "report.html" if out is None else Path(out)
    if path.is_dir():
        raise EpisodeError(f"{path} is a folder; name the file to write, e.g. {path}/report.html")
    page = render_report(read_episode(folder), folder)
    temporary = path.with_name(path.name + ".part")
    try:
        temporary.write_text(page, encoding="utf-8")
        temporary.replace(path)
    except OSError as error:
        with suppress(OSError):
            temporary.unlink()
        raise EpisodeError(f"{path}: cannot be written ({error.strerror})") from error
    return path


def render_report(events: list[Event], folder: Path) -> str:
    """The page as text, pictures embedded."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("tpvqa.episodes.report", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )

    def picture(frame: FrameRecord) -> str:
        try:
            data = (folder / frame.file).read_bytes()
        except OSError:
            return ""
        return f"data:{frame.media_type};base64,{base64.b64encode(data).decode()}"

    story = tell(events)
    words = words_of(story.started)
    return environment.get_template("report.html.j2").render(
        story=story,
        picture=picture,
        chart=chart(story, words.say),
        say=words.say,
        probability=probability,
    )
