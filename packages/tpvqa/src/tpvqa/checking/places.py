"""Where in a domain, a problem or a YAML file something stands."""

import re
from pathlib import Path

from tpvqa.pddl import Task


def line_of_action(task: Task, name: str) -> int | None:
    """The line of the domain in which an action begins."""
    return _line(task.domain_text, rf"\(\s*:(?:durative-)?action\s+{re.escape(name)}(?![\w-])")


def line_of_predicate(task: Task, name: str) -> int | None:
    """The line of the domain in which a predicate is declared."""
    start = re.search(r"\(\s*:predicates", task.domain_text, re.IGNORECASE)
    if start is None:
        return None
    return _line(task.domain_text, rf"\(\s*{re.escape(name)}(?![\w-])", start.end())


def line_of_goal(task: Task) -> int | None:
    """The line of the problem in which the goal begins."""
    return _line(task.problem_text, r"\(\s*:goal")


def line_of_object(task: Task, name: str) -> int | None:
    """The line of the problem in which an object is declared."""
    return _line(task.problem_text, rf"(?<![\w-]){re.escape(name)}(?![\w-])")


def line_of_entry(file: Path | None, section: str, word: str) -> int | None:
    """The line of a YAML file's section in which a word stands first."""
    if file is None:
        return None
    text = file.read_text(encoding="utf-8-sig", errors="replace")
    start = re.search(rf"^{re.escape(section)}\s*:", text, re.MULTILINE)
    if start is None:
        return None
    return _line(text, rf"(?<![\w-]){re.escape(word)}(?![\w-])", start.end(), comment="#")


def _line(text: str, pattern: str, start: int = 0, *, comment: str = ";") -> int | None:
    """The first line outside comments in which a pattern begins."""
    for found in re.compile(pattern, re.IGNORECASE).finditer(text, start):
        before = text[text.rfind("\n", 0, found.start()) + 1 : found.start()]
        if comment not in before:
            return text.count("\n", 0, found.start()) + 1
    return None
