"""World files: what is wrong in them is said, with its line."""

import re
from pathlib import Path

import pytest

from tests.pddl.feature_domains import DERIVED
from tpvqa.errors import WorldFileError
from tpvqa.pddl import Atom, Task, load_task, task_from_text
from tpvqa.worlds.world_file import load_world_file

UNDO = "undo:\n  - fact: (in_hand ?x ?h)\n    outcomes:\n      - "
SENSED = "sensed:\n  - fact: (in_hand ?x ?h)\n    "
REBIND = "rebind:\n  - action: find\n    argument: ?from\n    to: (near ?from)"


@pytest.fixture(scope="module")
def task() -> Task:
    return load_task("eat_apple")


def test_what_is_written_well_is_read(task: Task, tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(f'{UNDO}add: "(on ?x floor)"\n{REBIND}\n')
    rules = load_world_file(path, task)
    ((outcome,),) = (rule.outcomes for rule in rules.undo)
    assert [str(pattern) for pattern in outcome.add] == ["(on ?x floor)"]
    assert rules.rebind[0].argument == "?from"


def test_the_file_of_the_documentation_is_read(task: Task, tmp_path: Path) -> None:
    """And every key stands in it."""
    page = (Path(__file__).parents[2] / "docs/world.md").read_text()
    examples = re.findall(r"```yaml\n(.*?)```", page, re.DOTALL)
    path = tmp_path / "world.yaml"
    path.write_text("".join(examples))
    rules = load_world_file(path, task)
    assert [str(rule.fact) for rule in rules.undo] == [
        "(on ?x ?d - dish)",
        "(in_hand ?x ?h)",
        "(opened ?c)",
    ]
    assert [each.action for each in rules.rebind] == ["find"]
    assert [str(rule.fact) for rule in rules.sensed] == ["(in_hand ?x ?h)", "(opened ?c)"]
    assert [each.action for each in rules.reports] == ["pick_up"]
    for key in ("right", "at", "notices", "false_alarms"):
        assert f"{key}:" in path.read_text()
        assert f"| `{key}` |" in page
    for key in ("fact", "outcomes", "say", "last", "when", "unless", "add", "delete"):
        assert f"{key}:" in path.read_text()
        assert f"| `{key}` |" in page


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        (UNDO + 'add: ["(on ?y floor)"]', 4, "nothing says what ?y stands for"),
        (UNDO + 'add: ["(on ?x flor)"]', 4, "no object 'flor'. Did you mean 'floor'?"),
        (UNDO + 'add: ["(onn ?x floor)"]', 4, "no predicate 'onn'. Did you mean 'on'?"),
        (UNDO + 'add: ["(on ?x)"]', 4, "on takes 2 objects (thing, thing), this has 1"),
        (UNDO + 'add: ["(on ?h floor)"]', 4, "?h must be a thing here"),
        (UNDO + 'add: ["(on left floor)"]', 4, "left is a hand, but on takes a thing there"),
        (UNDO + 'when: ["(on ?x ?d - dsh)"]', 4, "no type 'dsh'. Did you mean 'dish'?"),
        (UNDO + 'when: ["(on ?x ?d - hand)"]', 4, "?d can be no hand, as on takes a thing there"),
        (UNDO + 'delete: ["(on ?x"]', 4, "not a fact"),
        (UNDO + 'last: ["(near ?x)", "(near ?x)"]', 4, "expected one fact"),
        (UNDO + "ad: (on ?x floor)", 4, "'ad' is not known here. Did you mean 'add'?"),
        (UNDO + "say: [it]", 4, "expected text"),
        ("undo:\n  - fact: (opened ?c)", 2, "a list of 'outcomes'"),
        ("undo: 3", 1, "expected a list"),
        ("rebind:\n  - action: find", 2, "needs 'action', 'argument' and 'to'"),
        (REBIND.replace("find", "fnd"), 2, "no action 'fnd'. Did you mean 'find'?"),
        (REBIND.replace("argument: ?from", "argument: ?fro"), 3, "Did you mean '?from'?"),
        (REBIND.replace("(near ?from)", "(near ?x)"), 4, "does not speak of ?from"),
        ("undo: [", 1, "broken YAML"),
        (UNDO + "add: [(on ?x floor)]", 4, "quotes, such as \"(near ?x)\""),
        ("sensed: [{fact: (on ?x floor)}]", 1, "within [ ] and { } write a text that has ? or {"),
        ("shown: [{where: ?x}]", 1, "in quotes"),
        ("undo:\nrebind: *a", 2, "the alias *a is not read here"),
        ("undo: &a\nrebind: []", 1, "the anchor &a is not read here; leave it out"),
        ("undo:\n - fact: &b (on)", 2, "the anchor &b is not read here; leave it out"),
        ("undo:\nundo:", 2, "'undo' is given twice, first in line 1"),
        ("undo: " + "[" * 100_000, 1, "nested more than 50 deep"),
        ("undo: 1" + ":59" * 100_000, 1, "has 300,001 letters"),
        ("undo: !!python/object/apply:os.system [x]\nundos: 3", 1, "is not read here"),
        ("undo: []\n---\nundo: []", 2, "broken YAML"),
        ("undo:\n\t- 3", 2, "broken YAML"),
        (UNDO + "say: " + "x" * 5000 + "\n        ad: 3", 5, "'ad' is not known"),
        ("# k\xfcche\nundo: []".encode("latin-1"), 1, "the byte 0xfc is not UTF-8"),
        ("sensed:\n  - right: 1", 2, "an entry needs 'fact'"),
        ("sensed:\n  - fact: (onn ?x ?y)", 2, "no predicate 'onn'. Did you mean 'on'?"),
        (SENSED + "right: 1.5", 3, "expected a number from 0 to 1, found '1.5'"),
        (SENSED + "right: nan", 3, "expected a number from 0 to 1"),
        (SENSED + "right: [1]", 3, "expected a number from 0 to 1, found a list"),
        (SENSED + "claims: 0.2", 3, "says the opposite; give 0.5 to 1"),
        (SENSED + "at: lok", 3, "'lok' is no occasion. Did you mean 'look'?"),
        (SENSED + "at: []", 3, "name an occasion: effect, action, look"),
        (SENSED + "rigth: 1", 3, "'rigth' is not known here. Did you mean 'right'?"),
        ("reports:\n  - action: fnd", 2, "no action 'fnd'. Did you mean 'find'?"),
        ("reports:\n  - notices: often", 2, "expected a number from 0 to 1, found 'often'"),
    ],
)  # fmt: skip
def test_a_broken_file_is_a_clear_error_with_its_line(
    task: Task, tmp_path: Path, text: str | bytes, line: int, says: str
) -> None:
    path = tmp_path / "world.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(WorldFileError) as caught:
        load_world_file(path, task)
    assert str(caught.value).startswith(f"{path}:{line}: ")
    assert says in str(caught.value)


def test_derived_facts_cannot_be_undone(tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    path.write_text("undo:\n  - fact: (clear ?x)\n    outcomes: [{say: it ends}]")
    with pytest.raises(WorldFileError, match=r":2: .*clear is derived"):
        load_world_file(path, task_from_text(DERIVED.domain, DERIVED.problem))


def test_a_missing_file(task: Task, tmp_path: Path) -> None:
    with pytest.raises(WorldFileError, match="cannot be read"):
        load_world_file(tmp_path / "gone.yaml", task)


def test_a_skill_that_starts_elsewhere_needs_no_cost_from_there(tmp_path: Path) -> None:
    task = task_from_text(
        """(define (domain walks) (:requirements :typing :action-costs) (:types place)
 (:predicates (at ?p - place) (joined ?a ?b - place))
 (:functions (total-cost) - number (steps ?a ?b - place) - number)
 (:action walk :parameters (?from ?to - place) :precondition (and (at ?from) (joined ?from ?to))
  :effect (and (at ?to) (not (at ?from)) (increase (total-cost) (steps ?from ?to)))))""",
        """(define (problem walk) (:domain walks) (:objects w x y z - place)
 (:init (at x) (joined x y) (joined y z) (= (steps x y) 1) (= (steps y z) 1)
  (= (steps w z) 2) (= (total-cost) 0))
 (:goal (at z)) (:metric minimize (total-cost)))""",
    )
    path = tmp_path / "world.yaml"
    path.write_text("rebind:\n  - action: walk\n    argument: ?from\n    to: (at ?from)\n")
    (rebind,) = load_world_file(path, task).rebind
    named = task.action("walk", ["y", "z"])
    assert rebind.apply(named, task.init, task) == named  # from x no way leads to z
    assert not task.has_cost("walk", ["x", "z"])
    from_there = rebind.apply(named, frozenset({Atom("at", ("w",))}), task)
    assert from_there == task.action("walk", ["w", "z"])
