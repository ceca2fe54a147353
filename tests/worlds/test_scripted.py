"""Scripts: faults that are written down come true, and what cannot come true is said."""

from pathlib import Path

import pytest

from tpvqa.errors import WorldFileError
from tpvqa.pddl import Atom, Task, load_task
from tpvqa.tasks import find_task
from tpvqa.worlds.scripted import ScriptedWorld
from tpvqa.worlds.simulation import Simulation
from tpvqa.worlds.world_file import load_world_file


@pytest.fixture(scope="module")
def task() -> Task:
    return load_task("clean_dishes")


def scripted(task: Task, folder: Path, script: str) -> ScriptedWorld:
    path = folder / "story.yaml"
    path.write_text(script)
    rules = load_world_file(find_task("clean_dishes").world, task)
    return ScriptedWorld.from_spec(str(path), simulation=Simulation(task, rules))


DROP = """script:
  - action: (find plate tv)
    then:
      add: (on plate floor)
      delete: [(on plate table)]
  - action: (pick_up plate floor left)
    attempt: 2
    fails: true
"""


def test_what_is_written_comes_true(task: Task, tmp_path: Path) -> None:
    world = scripted(task, tmp_path, DROP)
    world.execute(task.action("find", ("plate", "tv")))
    assert world.truth.holds(Atom.parse("(on plate floor)"))
    assert not world.truth.holds(Atom.parse("(on plate table)"))


def test_entries_that_never_came_to_pass_are_told_at_the_end(
    task: Task, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    world = scripted(task, tmp_path, DROP)
    world.close()
    assert caplog.messages == []  # nothing was tried at all
    world = scripted(task, tmp_path, DROP)
    world.execute(task.action("find", ("plate", "tv")))
    world.close()
    world.close()
    assert caplog.messages == [
        f"{tmp_path / 'story.yaml'}:6: attempt 2 of (pick_up plate floor left) did not take "
        "place: the action never came"
    ]


def test_the_rules_of_the_world_file_hold_in_a_script_too(task: Task, tmp_path: Path) -> None:
    """The robot sets out from where it is, wherever it is believed to be."""
    world = scripted(task, tmp_path, "script: []")
    world.execute(task.action("find", ("plate", "sink")))  # it is near the TV
    assert world.truth.holds(Atom.parse("(near plate)"))
    assert not world.truth.holds(Atom.parse("(near tv)"))


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("script:\n  - action: (fnd plate tv)", 2, "no action 'fnd'. Did you mean 'find'?"),
        ("script:\n  - action: (find plat tv)", 2, "no object 'plat'. Did you mean 'plate'?"),
        ("script:\n  - action: (find left tv)", 2, "left is a hand"),
        ("script:\n  - action: (find plate)", 2, "takes 2 arguments"),
        ("script:\n  - action: ()", 2, "expected an action"),
        ("script:\n  - fails: true", 2, "needs 'action'"),
        ("script: (find plate tv)", 1, "expected a list"),
        ("script:\n  - action: (find plate tv)\n    attempt: 0", 3, "counts from 1"),
        ("script:\n  - action: (find plate tv)\n    fails: maybe", 3, "expected true or false"),
        ("script:\n  - action: (find plate tv)\n    fail: true", 3, "Did you mean 'fails'?"),
        (DROP.replace("floor)\n      delete", "flor)\n      delete"), 4, "no object 'flor'"),
        (DROP.replace("(on plate table)", "(onn plate table)"), 5, "no predicate 'onn'"),
        (DROP.replace("(on plate table)", "'(on ?x table)'"), 5, "?x is a variable"),
        (DROP + "  - action: (find plate tv)", 9, "is given twice, first at"),
        ("script: [\xe9]".encode("latin-1"), 1, "the byte 0xe9 is not UTF-8"),
    ],
)  # fmt: skip
def test_a_broken_script_is_a_clear_error_with_its_line(
    task: Task, tmp_path: Path, text: str | bytes, line: int, says: str
) -> None:
    path = tmp_path / "story.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(WorldFileError) as caught:
        ScriptedWorld.from_spec(str(path), simulation=Simulation(task))
    assert str(caught.value).startswith(f"{path}:{line}: ")
    assert says in str(caught.value)


@pytest.mark.parametrize("text", ["", "a: [", "script_: []"])
def test_a_file_that_is_no_script(task: Task, tmp_path: Path, text: str) -> None:
    with pytest.raises(WorldFileError, match=r"story\.yaml:"):
        scripted(task, tmp_path, text)
