"""`tpvqa label`: a person says what was right in recorded episodes."""

import json
import sys
import webbrowser
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tpvqa.cli.label_words import press, progress_line, question_lines
from tpvqa.cli.saying import tell
from tpvqa.errors import pasted

if TYPE_CHECKING:
    from tpvqa.labelling import Asking, Session

_EXIT = (
    "Exit codes: 0 ended, 2 bad input, 6 a label could not be written (those before it are kept), "
    "130 interrupted (nothing is lost)."
)

_PICTURES = (".jpg", ".jpeg", ".png", ".webp")


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command(epilog=_EXIT)(label)


def label(
    episodes: Annotated[list[Path], typer.Argument(help="Folders of recorded episodes.")],
    *,
    vlm: Annotated[
        str | None,
        typer.Option(help="Whose answers to label. Default: whoever answered in the first."),
    ] = None,
    page: Annotated[
        bool,
        typer.Option("--page", help="A page in your browser, served to this machine alone."),
    ] = False,
    port: Annotated[
        int, typer.Option(help="With --page: the port; 0 for a free one.", min=0, max=65535)
    ] = 0,
    open_: Annotated[
        bool,
        typer.Option("--open", help="Open the page, or in the terminal each picture, by itself."),
    ] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print what came of it as JSON; all else to stderr.")
    ] = False,
) -> None:
    """Label recorded questions: say what was right, the most informative question first.

    Labels are kept beside each log, in labels.jsonl, each at once; the log itself stays as it is.
    Stop when you like and go on later. `tpvqa calibrate EPISODES` learns from them.

    Keys: y yes, n no, c cannot see, s skip, b back, q quit. Where standard input is no terminal,
    its lines are the keys.
    """
    from tpvqa.labelling import Session

    with Session(episodes, vlm=vlm) as session:
        if not any(asking.pictures for asking in session.order.askings):
            tell(
                "note: nothing here was recorded with a picture; label what you saw yourself. Of "
                "simulated worlds `tpvqa calibrate` needs no labels: their logs hold the truth",
                error=True,
            )
        try:
            if page:
                _serve(session, port=port, opened=open_)
            else:
                _go_through(session, opened=open_)
        finally:
            if as_json:
                typer.echo(json.dumps(_summary(session), indent=1))
            else:
                _say_end(session, episodes)


def _serve(session: "Session", *, port: int, opened: bool) -> None:
    from tpvqa.cli.label_page import LabelPage

    with LabelPage(session, port=port) as served:
        tell(f"label here: {served.address}  (Ctrl-C, or q in the page, ends it)", error=True)
        if opened:
            webbrowser.open(served.address)
        served.serve()


def _go_through(session: "Session", *, opened: bool) -> None:
    told = session.progress.standing.enough
    if told and session.now is not None:
        tell("there are labels enough; more do no harm", error=True)
    while session.now is not None:
        asking = session.now
        tell(question_lines(session), error=True)
        if opened:
            _open_picture(asking)
        if not press(session, _key()):
            return
        if not told and session.progress.standing.enough:
            told = True
            tell(f"enough: {progress_line(session.progress)}", error=True)


def _open_picture(asking: "Asking") -> None:
    """Open the first picture, where it is one: an episode may be a stranger's, and a browser goes
    by the name of a file."""
    from tpvqa.errors import PictureError
    from tpvqa.pictures import read_picture

    for picture in asking.pictures[:1]:
        try:
            read_picture(picture, inside=asking.episode)
        except PictureError as error:
            tell(f"not opened: {error}", error=True)
            return
        if Path(picture).suffix.lower() in _PICTURES:
            webbrowser.open((asking.episode / picture).resolve().as_uri())


def _key() -> str:
    """The next key: one that is pressed, or a line where standard input is no terminal."""
    if sys.stdin is None:
        return "q"
    if not sys.stdin.isatty():
        line = sys.stdin.readline()
        return line if line else "q"
    with _one_by_one():
        key = sys.stdin.read(1)
    return "q" if key in ("", "\x04") else key


@contextmanager
def _one_by_one() -> Iterator[None]:
    """Let keys come without Enter."""
    import termios
    import tty

    before = termios.tcgetattr(sys.stdin)
    try:
        tty.setcbreak(sys.stdin)
        yield
    finally:
        with suppress(termios.error):
            termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)


def _summary(session: "Session") -> dict[str, object]:
    progress = session.progress
    standing = progress.standing
    return {
        "vlm": session.vlm,
        "labels": progress.labels,
        "cannot_see": progress.cannot_see,
        "skipped": progress.skipped,
        "answers": progress.answers,
        "left": standing.left,
        "standard_error": round(standing.error, 4),
        "after_ten_more": round(standing.after, 4),
        "enough": standing.enough,
    }


def _say_end(session: "Session", episodes: list[Path]) -> None:
    progress = session.progress
    enough = progress.standing.enough
    tell(f"{progress_line(progress)}; {'enough' if enough else 'not enough yet'}")
    named = " ".join(pasted(each) for each in episodes[:8])
    more = " …" if len(episodes) > 8 else ""
    tell(f"next: {'tpvqa calibrate' if enough else 'go on with tpvqa label'} {named}{more}")
