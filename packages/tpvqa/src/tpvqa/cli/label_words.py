"""Keys and words of `tpvqa label`, in the terminal and on the page."""

from typing import TYPE_CHECKING

from tpvqa.cli.saying import tell

if TYPE_CHECKING:
    from tpvqa.labelling import Asking, Session
    from tpvqa.labelling.session import Progress

_SHOWN = 3
"""Pictures that are named for one question."""
_KEYS = "y yes · n no · c cannot see · s skip · b back · q quit"


def press(session: "Session", key: str) -> bool:
    """Do what a key says; whether to go on. Other keys do nothing."""
    from tpvqa.labelling.session import KEYS

    key = key.strip().lower()
    if key in KEYS:
        session.say(KEYS[key])
        if session.notice:
            tell(f"note: {session.notice}", error=True)
    elif key == "s":
        session.skip()
    elif key == "b":
        if not session.back():
            tell("there is nothing before this", error=True)
    elif key == "q":
        return False
    elif key:
        tell(f"{key} is no key: {_KEYS}", error=True)
    return True


def question_lines(session: "Session") -> str:
    """The question that is to be labelled now, with its pictures and keys."""
    asking = session.now
    assert asking is not None
    lines = [f"[{session.progress.labels + 1}] {asking.text}"]
    for picture in asking.pictures[:_SHOWN]:
        path = asking.episode / picture
        lines.append(f"picture: {path}{'' if path.exists() else ' (is not there)'}")
    if len(asking.pictures) > _SHOWN:
        lines.append(f"and {len(asking.pictures) - _SHOWN} more of the same moment")
    lines.append(when(asking) if asking.pictures else f"no picture; {when(asking)}")
    before = session.label_of(asking)
    lines.append(_KEYS if before is None else f"now: {before}; {_KEYS}")
    return "\n".join(lines)


def when(asking: "Asking") -> str:
    """Where in its episode something was asked."""
    place = f"{asking.episode}, look {asking.of_vlm[0].look}"
    return f"{place}, after: {asking.done}" if asking.done else f"{place}, at the start"


def progress_line(progress: "Progress") -> str:
    """How far it has come, and what more would do."""
    standing = progress.standing
    done = f"{progress.labels} labels tell how often an answer is right to ±{standing.error:.3f}"
    if not standing.left:
        return f"{done}; no question is left"
    return f"{done}; ten more: ±{standing.after:.3f}"
