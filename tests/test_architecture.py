"""The table of docs/architecture.md against the imports."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "tpvqa"


def rooms() -> dict[str, set[str]]:
    """Room → what it may import, from the table; "everything above" spelled out."""
    found: dict[str, set[str]] = {}
    for line in (ROOT / "docs" / "architecture.md").read_text().splitlines():
        match = re.match(r"\| `(\w+)` \|.*\| ([^|]+) \|$", line)
        if match:
            allowed = match[2].strip()
            above = set(found)
            found[match[1]] = above if "everything" in allowed else set(re.findall(r"\w+", allowed))
    return found


def room_of(path: Path) -> str:
    return path.relative_to(SOURCE).parts[0].removesuffix(".py")


def imported_rooms(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        names = (
            [alias.name for alias in node.names]
            if isinstance(node, ast.Import)
            else [node.module or ""]
            if isinstance(node, ast.ImportFrom) and node.level == 0
            else []
        )
        found |= {name.split(".")[1] for name in names if name.startswith("tpvqa.")}
    return found


FILES = sorted(
    path for path in SOURCE.rglob("*.py") if path.name != "__init__.py" or path.parent != SOURCE
)


def test_every_room_is_in_the_table() -> None:
    assert {room_of(path) for path in FILES} <= set(rooms())


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(SOURCE)))
def test_a_room_imports_only_what_the_table_allows(path: Path) -> None:
    room = room_of(path)
    assert imported_rooms(path) - {room} <= rooms()[room]


def test_nothing_imports_the_planners_gpl_code_into_the_packages_process() -> None:
    worker = SOURCE / "pddl" / "worker"
    offenders = [
        path
        for path in FILES
        if worker not in path.parents and "import fast_downward" in path.read_text()
    ]
    assert offenders == []


def test_a_source_file_is_one_idea() -> None:
    long = {
        str(path.relative_to(SOURCE)): n
        for path in FILES
        if (n := len(path.read_text().splitlines())) > 400
    }
    assert long == {}
