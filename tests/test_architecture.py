"""The table of docs/architecture.md against the imports."""

import ast
import re
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "packages" / "tpvqa" / "src" / "tpvqa"
HOUSEHOLD = ROOT / "packages" / "tpvqa-household" / "src" / "tpvqa_household"
PAGE = (ROOT / "docs" / "architecture.md").read_text()
ROBOTS = ROOT / "packages" / "tpvqa-robots" / "src" / "tpvqa_robots"
TABLES = {
    SOURCE: "Rooms of the core",
    HOUSEHOLD: "Rooms of the household",
    ROBOTS: "Rooms of the robots",
}
BELIEF = SOURCE / "belief"


def rooms(source: Path) -> dict[str, set[str]]:
    """Room → what it may import, from the table; "everything above" spelled out."""
    return table(TABLES[source])


def table(title: str) -> dict[str, set[str]]:
    found: dict[str, set[str]] = {}
    section = PAGE.partition(f"## {title}\n")[2].partition("\n## ")[0]
    for line in section.splitlines():
        match = re.match(r"\| `(\w+)` \|.*\| ([^|]+) \|$", line)
        if match:
            allowed = match[2].strip()
            above = set(found)
            found[match[1]] = above if "everything" in allowed else set(re.findall(r"\w+", allowed))
    return found


def public() -> set[str]:
    """The rooms of the core that other distributions may import."""
    return set(re.findall(r"\w+", PAGE.partition("that are for everybody:")[2].partition(".")[0]))


def source_of(path: Path) -> Path:
    return next(source for source in TABLES if source in path.parents)


def room_of(path: Path) -> str:
    return path.relative_to(source_of(path)).parts[0].removesuffix(".py")


def imports(source: str) -> set[str]:
    """The modules that a source file imports, by statement or by name."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            found.add(node.module or "")
        elif isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
            name = ast.unparse(node.func).rpartition(".")[2]
            if name in ("import_module", "__import__"):
                found.add(str(node.args[0].value))
    return found


def imported_rooms(path: Path, package: str) -> set[str]:
    names = imports(path.read_text())
    return {name.split(".")[1] for name in names if name.startswith(f"{package}.")}


def test_modules_import_each_other_in_no_circle() -> None:
    """Late imports count, too."""
    modules = {
        ".".join(path.relative_to(source_of(path).parent).with_suffix("").parts): path
        for path in FILES
    }
    graph = {name: imports(path.read_text()) & set(modules) for name, path in modules.items()}
    list(TopologicalSorter(graph).static_order())


GPL = {"fast_downward", "up_fast_downward", "pyperplan", "up_pyperplan", "up_symk", "up_enhsp"}


def imports_gpl_code(source: str) -> bool:
    return not GPL.isdisjoint(name.partition(".")[0] for name in imports(source))


FILES = sorted(
    path
    for source in TABLES
    for path in source.rglob("*.py")
    if path.name != "__init__.py" or path.parent != source
)
OF_THE_CORE = [path for path in FILES if SOURCE in path.parents]
OF_THE_HOUSEHOLD = [path for path in FILES if HOUSEHOLD in path.parents]
OF_THE_ROBOTS = [path for path in FILES if ROBOTS in path.parents]


def test_every_room_is_in_the_table() -> None:
    for source in TABLES:
        found = {room_of(path) for path in FILES if source in path.parents}
        assert found
        assert found <= set(rooms(source))


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_room_imports_only_what_the_table_allows(path: Path) -> None:
    source, room = source_of(path), room_of(path)
    assert imported_rooms(path, source.name) - {room} <= rooms(source)[room]


def test_rooms_of_the_belief_import_only_what_their_table_allows() -> None:
    allowed, met = table("Rooms of the belief"), set()
    for path in BELIEF.rglob("*.py"):
        room = path.relative_to(BELIEF).parts[0].removesuffix(".py")
        if room == "__init__":
            continue
        met.add(room)
        names = imports(path.read_text())
        imported = {name.split(".")[2] for name in names if name.startswith("tpvqa.belief.")}
        assert imported - {room} <= allowed[room], path
    assert met == set(allowed)


def test_the_core_imports_nothing_of_the_other_distributions() -> None:
    for path in OF_THE_CORE:
        roots = {name.partition(".")[0] for name in imports(path.read_text())}
        assert roots.isdisjoint({"tpvqa_household", "tpvqa_robots", "tpvqa_experiments"}), path


def test_the_household_imports_what_is_public_and_nothing_of_the_experiments() -> None:
    assert public() < set(rooms(SOURCE))
    for path in OF_THE_HOUSEHOLD:
        text = path.read_text()
        roots = {name.partition(".")[0] for name in imports(text)}
        assert "tpvqa_experiments" not in roots, path
        assert imported_rooms(path, "tpvqa") <= public(), path
        assert not re.search(r"from tpvqa\.[\w.]+ import [^\n]*\b_\w", text), path


TRIALS = {"drivers", "episodes", "events", "monitors", "trial"}
DRIVING = {
    "film": {"episodes"},
    "bridges": TRIALS,
    "ros2_trial": TRIALS | {"assembly", "cli", "config"},
    "plansys2": TRIALS | {"assembly", "cli", "config"},
}


def test_the_robots_import_what_is_public_and_whoever_drives_trials_what_that_takes() -> None:
    for path in OF_THE_ROBOTS:
        text = path.read_text()
        allowed = public() | DRIVING.get(room_of(path), set())
        assert imported_rooms(path, "tpvqa") <= allowed, path
        roots = {name.partition(".")[0] for name in imports(text)}
        assert roots.isdisjoint({"tpvqa_household", "tpvqa_experiments", "robosuite"}), path


def test_nothing_imports_the_planners_gpl_code_into_the_packages_process() -> None:
    worker = SOURCE / "pddl" / "worker"
    importing = {path for path in FILES if imports_gpl_code(path.read_text())}
    assert importing  # the worker does
    assert {path for path in importing if worker not in path.parents} == set()


@pytest.mark.parametrize(
    "statement",
    [
        "import fast_downward",
        "import os, fast_downward.translate as translate",
        "from fast_downward.translate import pddl",
        "def late():\n    from up_fast_downward import FastDownwardPDDLPlanner",
        "import importlib\nimportlib.import_module('fast_downward.translate')",
    ],
)
def test_every_way_to_import_it_is_noticed(statement: str) -> None:
    assert imports_gpl_code(statement)
    assert not imports_gpl_code(statement.replace("fast_downward", "other"))


def test_a_source_file_is_one_idea() -> None:
    long = {
        str(path.relative_to(ROOT)): n
        for path in FILES
        if (n := len(path.read_text().splitlines())) > 400
    }
    assert long == {}


def test_no_script_hides_a_module_of_the_standard_library_from_those_beside_it() -> None:
    scripts = [path for room in ("benchmarks", "tools") for path in (ROOT / room).glob("*.py")]
    assert len(scripts) > 20
    assert not [path for path in scripts if path.stem in sys.stdlib_module_names]


CORE = "packages/tpvqa/src/tpvqa"
ASKING = {
    f"{CORE}/vlm/checking.py": "vlm.ask",
    f"{CORE}/belief/weighing/evidence.py": "self._words.ask",
    f"{CORE}/monitors/asker.py": "asker.ask",
    f"{CORE}/monitors/correcting.py": "self._asker.ask",
    f"{CORE}/monitors/palme_vqa.py": "self._asker.ask",
    f"{CORE}/monitors/success_vqa.py": "self._asker.ask",
    f"{CORE}/serving/app.py": "self._desk.ask",
}
"""Who speaks of something's `ask`: but for the first no VLM's, and nobody who answers as one."""


def asks(source: str) -> set[str]:
    """What a source file asks: all of which it takes `ask`, and what it has called by that name."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Attribute) and node.attr == "ask":
            found.add(ast.unparse(node))
        elif isinstance(node, ast.Call) and re.search(r"called|getattr|methodcaller", _name(node)):
            words = [each.value for each in node.args if isinstance(each, ast.Constant)]
            if "ask" in words:
                found.add(ast.unparse(node))
    return found


def _name(call: ast.Call) -> str:
    return ast.unparse(call.func).rpartition(".")[2]


def test_every_vlm_is_asked_where_its_answers_are_checked() -> None:
    """It may be anybody's, and so may a person be who answers in its place."""
    asking = {
        str(path.relative_to(ROOT)): asks(path.read_text())
        for path in (*FILES, *(ROOT / "experiments").rglob("*.py"))
    }
    assert {path: found for path, found in asking.items() if found} == {
        path: {what} for path, what in ASKING.items()
    }


@pytest.mark.parametrize(
    "statement",
    [
        "vlm.ask(seen, questions)",
        "parts.person.ask(None, questions)",
        "ask = vlm.ask",
        "called(vlm, 'ask', list, seen, questions)",
        "plugged.called(self.vlm, 'ask', list)",
        "getattr(vlm, 'ask')(seen, questions)",
    ],
)
def test_every_way_to_ask_is_noticed(statement: str) -> None:
    assert asks(statement)
