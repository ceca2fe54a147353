"""`tpvqa questions --draft`: writes a questions file to edit."""

import json
from pathlib import Path
from typing import TYPE_CHECKING

from tpvqa.cli.outputs import see_unread
from tpvqa.cli.saying import tell
from tpvqa.errors import TpvqaError

if TYPE_CHECKING:
    from tpvqa.config import TaskConfig


def write_draft(
    wanted: "TaskConfig", target: Path | None, *, timeout: float, force: bool, as_json: bool
) -> None:
    """Write the questions file of one's own domain, whole or not at all.

    Args:
        wanted: The task.
        target: The file; None for the one beside the problem that is found without being named.
        timeout: Seconds for reading and grounding.
        force: Whether a file that is there may be written over.
        as_json: Whether to print JSON.

    Raises:
        TpvqaError: The file is there, or is one of the task's; or the task is a shipped one and
            no file is named.
        WriteError: It cannot be written.
    """
    from tpvqa.drafting import LOOK, draft
    from tpvqa.files import write_whole
    from tpvqa.pddl import load_task
    from tpvqa.questions import QuestionBook
    from tpvqa.tasks import QUESTIONS

    if target is None:
        if wanted.problem is None:
            raise TpvqaError(
                f"{wanted.name} is a shipped task and has its questions; to draft others, name a "
                "file with --questions."
            )
        target = Path(wanted.problem).parent / QUESTIONS
    see_unread(target, "--questions", (wanted.domain, wanted.problem))
    if target.exists() and not force:
        raise TpvqaError(
            f"{target} is there, and may hold your work; name another file with --questions, or "
            "write over it with --force."
        )
    task = load_task(wanted.name or wanted.domain or "", wanted.problem, timeout=timeout)
    text = draft(task)
    write_whole(target, text.encode(), remedy="Name a file that can be written, with --questions.")
    notices = QuestionBook.load(target, task).notices
    unsure = text.count(f"# {LOOK}")
    if as_json:
        said = {"written": str(target), "to_look_at": unsure, "notices": notices}
        print(json.dumps(said, indent=1))
        return
    look = f"; {unsure} {'line is' if unsure == 1 else 'lines are'} marked {LOOK}" if unsure else ""
    tell(f"{target} is written: {len(task.fluents | task.derived)} questions to read{look}.")
    tell("Edit it, then: tpvqa check, with the same domain and problem.")
