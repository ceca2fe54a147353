"""States in files."""

import json
from pathlib import Path

import pytest

from tests.pddl.feature_domains import DERIVED
from tpvqa.errors import PDDLError
from tpvqa.pddl import Atom, Task, load_task, task_from_text
from tpvqa.pddl.state_file import read_state


@pytest.fixture(scope="module")
def task() -> Task:
    return load_task("eat_apple")


EXPECTED = {Atom.parse("near tv"), Atom.parse("on plate table"), Atom.parse("free left")}


@pytest.mark.parametrize(
    "text",
    [
        "(near tv)\n(on plate table)\n(free left)\n",
        "; a comment\n(near tv) (on plate table)   # two\n\nFREE(Left)\n",
        "# a\x0c(near x)\n(near tv)\x0c(on plate table)\n; b\u2028(near y)\n(free left)",
        "near(tv)\non(plate, table)\nfree left",
        '["(near tv)", ["on", "plate", "table"], "free(left)"]',
    ],
)
def test_ways_to_write_a_state(task: Task, tmp_path: Path, text: str) -> None:
    path = tmp_path / "state"
    path.write_text(text)
    assert read_state(path, task) == EXPECTED


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("(near tv)\n(on plate tabel)", ":2: .*Did you mean 'table'"),
        ("(near tv)\n\n(nearr tv)", ":3: .*Did you mean 'near'"),
        ("(on plate)", ":1: .*takes 2 arguments"),
        ("(near tv)\n(in_hand plate plate)", ":2: .*plate is a dish, but .h of in_hand must be"),
        ("(near left)", ":1: .*left is a hand, but .x of near must be a thing"),
        ("()", ":1: .*not an atom"),
        ('["(near tv)",\n "(nearr tv)"]', ":2: .*Did you mean 'near'"),
        ('["(near tv)",\n["free", "left"], "(near tv)",\n\n "(nearr tv)"]', ":4: .*'near'"),
        ('["(near tv)",\n 3]', "entry 2 of the list is no atom: '3'"),
        ('["(near tv)"\n "(free left)"]', ":2: this is not JSON"),
        ('{"near": "tv"}', "expected a JSON list"),
        ("[" * 100_000, "no JSON list"),
        ("[" + "9" * 5000 + "]", "no JSON list"),
    ],
)
def test_errors_name_the_line(task: Task, tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "state"
    path.write_text(text)
    with pytest.raises(PDDLError, match=message):
        read_state(path, task)


def test_a_missing_file(task: Task, tmp_path: Path) -> None:
    with pytest.raises(PDDLError, match="cannot be read"):
        read_state(tmp_path / "gone", task)


def test_static_facts_may_be_left_out_and_derived_ones_must(tmp_path: Path) -> None:
    task = task_from_text(DERIVED.domain, DERIVED.problem)
    path = tmp_path / "state"
    path.write_text(json.dumps(["(table a)", "(table b)", "(on c a)"]))
    assert read_state(path, task) >= {Atom.parse("block a"), Atom.parse("on c a")}
    path.write_text("(table a)\n(clear a)")
    with pytest.raises(PDDLError, match=r":2: .*clear is derived"):
        read_state(path, task)


def test_a_long_list_takes_no_longer_for_each_entry(task: Task, tmp_path: Path) -> None:
    """100,000 entries took minutes once: each was sought in the whole text."""
    path = tmp_path / "state"
    state = {Atom.parse("near tv"), Atom.parse("free left")}
    text = json.dumps([["near", "tv"], "(free left)"] * 50_000)
    for written in (text, text.replace("(free", "(\\u0066ree")):
        path.write_text(written)
        assert read_state(path, task) == state
