"""Broken questions files: always a QuestionsError with file and line, never anything else."""

from itertools import pairwise
from pathlib import Path

import pytest
import yaml
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from tpvqa.errors import QuestionsError
from tpvqa.events.records import question_record
from tpvqa.pddl import Literal, Task, load_task
from tpvqa.questions import QuestionBook
from tpvqa.tasks import find_task

UNHURRIED = [HealthCheck.function_scoped_fixture, HealthCheck.too_slow]


@pytest.fixture(scope="module")
def task() -> Task:
    return load_task("eat_apple")


def book(task: Task, folder: Path, text: str | bytes) -> QuestionBook:
    path = folder / "questions.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass"))
    return QuestionBook.load(path, task)


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("predicates:\n  neer: 'Is it?'", 2, "no predicate 'neer'. Did you mean 'near'?"),
        ("predicates:\n  near: []", 2, "found an empty list"),
        ("predicates:\n  near:\n    - Is a {x} here?\n    - Is it?", 4, "only one of this and"),
        ("predicates:\n  near:\n    - 'Is {x}?'\n    - 'Is {x}?'", 4, "given twice"),
        ("actions:\n\n  opne: {say: open}", 3, "no action 'opne'. Did you mean 'open'?"),
        ("types:\n  frigde: box", 2, "no type 'frigde'. Did you mean 'fridge'?"),
        ("predicats:\n  near: 'Is it?'", 1, "'predicats' is not known here. Did you mean"),
        ("predicates:\n  near: 'Is {y} near?'", 2, "{y} stands for none of the parameters"),
        ("predicates:\n  on: 'Is {x} on {wher}?'", 2, "Did you mean '{where}'?"),
        ("predicates:\n  near: 'Is {x.place} it?'", 2, "no attribute 'place'"),
        ("predicates:\n  near: 'Is {x'", 2, "expected '}'"),
        ("predicates:\n  near: 'Is {x!r}?'", 2, "no placeholder"),
        ("predicates:\n  near: 'Is {}?'", 2, "no placeholder"),
        ("predicates:\n  near: 'Is {0[a]}?'", 2, "no placeholder"),
        ("predicates:\n  near: [[a]]", 2, "expected text, found a list"),
        ("predicates:\n  near: {a: b}", 2, "expected text"),
        ("predicates:\n  near: 7", 2, "expected text, found '7'; write it in quotes"),
        ("predicates:\n  near: yes", 2, "write it in quotes"),
        ("predicates:\n  near:\n  on: 'Is it?'", 2, "found nothing"),
        ("predicates:\n  near: ' '", 2, "found nothing"),
        ("predicates: [near]", 1, "expected 'name: value' entries, found a list"),
        ("predicates: near", 1, "expected 'name: value' entries, found 'near'"),
        ("predicates:\n  near: 'A?'\n  near: 'B?'", 3, "given twice, first in line 2"),
        ("predicates:\n  [near]: 'A?'", 2, "expected a name"),
        ("- predicates", 1, "expected 'name: value' entries"),
        ("just words", 1, "expected 'name: value' entries"),
        ("predicates:\n near: 'A?'\n  on: 'B?'", 3, "broken YAML"),
        ("predicates:\n\tnear: 'A?'", 2, "broken YAML"),
        ("a: 'never closed", 1, "broken YAML"),
        ("predicates:\n  on: [Is the {x} there, no]", 2, "a text that has ? or { in quotes"),
        ("never_asked: [{fact: (on ?x ?y)}]", 1, "a text that has ? or { in quotes"),
        ("a: *unknown", 1, "the alias *unknown is not read here"),
        ("a:\n  b: !!python/object/apply:os.system ['id']", 2, "is not read here; leave it out"),
        ("a: !mine 'B?'", 1, "the tag '!mine' is not read here"),
        ("a: 1\n---\nb: 2", 2, "broken YAML"),
        ("a: 1\nb: \x01", 2, "broken YAML: the character '\\x01' may not stand in it; remove it"),
        ("actions:\n  open: {says: 'open'}", 2, "'says' is not known here. Did you mean 'say'"),
        ("actions:\n  open: 'open the {c}'", 2, "expected 'name: value' entries"),
        ("attributes:\n  name: 'the {name}'", 2, "each object's own"),
        ("attributes:\n  place: 'on the {x}'", 2, "{x} stands for none"),
        ("objects:\n  tv: {plaec: 'x'}", 2, "no attribute 'plaec'"),
        ("objects:\n  tv: {name: 'the {name}'}", 2, "{name} stands for none"),
        ("ways:\n  precondition: 'Is it?'", 2, "'precondition' is not known here"),
        ("ways:\n  did: 'Did {x}?'", 2, "{x} stands for none of the parameters"),
        ("never_asked: near", 1, "expected a list"),
        ("never_asked:\n  - because: no", 2, "needs 'fact'"),
        ("never_asked:\n  - '(near ?x)'", 2, "expected 'name: value' entries"),
        ("never_asked:\n  - fact: near ?x", 2, "not a fact; write it as (predicate"),
        ("never_asked:\n  - fact: (and (near ?x) (free ?h))", 2, "not a fact"),
        ("never_asked:\n  - fact: (neer ?x)", 2, "no predicate 'neer'. Did you mean 'near'?"),
        ("never_asked:\n  - fact: (near ?x ?y)", 2, "near takes 1 objects (thing), this has 2"),
        ("never_asked:\n  - fact: (near left)", 2, "left is a hand, but near takes a thing there"),
        ("never_asked:\n  - fact: (near aple)", 2, "no object 'aple'. Did you mean 'apple'?"),
        ("never_asked:\n  - fact: (near ?x - thin)", 2, "no type 'thin'. Did you mean 'thing'?"),
        ("never_asked:\n  - fact: (near - thing)", 2, "a dash stands between"),
        ("never_asked:\n  - fact: (near ?x)\n    in: fined", 3, "no action 'fined'. Did you mean"),
        ("never_asked:\n  - fact: (near ?x)\n    in: [find, {a: b}]", 3, "expected text"),
        (b"# hm\nnear: \xff\xfe\xfa", 2, "the byte 0xff is not UTF-8"),
    ],
)  # fmt: skip
def test_a_broken_file_is_a_clear_error_with_its_line(
    task: Task, tmp_path: Path, text: str | bytes, line: int | None, says: str
) -> None:
    with pytest.raises(QuestionsError) as caught:
        book(task, tmp_path, text)
    message = str(caught.value)
    place = f"{tmp_path / 'questions.yaml'}:" + ("" if line is None else f"{line}:")
    assert message.startswith(place), message
    assert says in message


def test_a_missing_file_and_a_folder_are_clear_errors(task: Task, tmp_path: Path) -> None:
    for path in (tmp_path / "none.yaml", tmp_path):
        with pytest.raises(QuestionsError, match="cannot be read"):
            QuestionBook.load(path, task)


def test_deep_nesting_and_entities_that_grow_do_no_harm(task: Task, tmp_path: Path) -> None:
    names = "abcdefghijklmnopqrstuvwx"
    bomb = "a: &a [x, x]\n" + "\n".join(f"{b}: &{b} [*{a}, *{a}]" for a, b in pairwise(names))
    for text in ("[" * 3000, "{a: " * 3000, bomb, "predicates: &a {near: *a}", "&a [*a]"):
        with pytest.raises(QuestionsError):
            book(task, tmp_path, text)


SCALARS = st.sampled_from(
    ["near", "on", "in_hand", "find", "apple", "tv", "name", "article", "place", "say", "done",
     "fact", "in", "because", "(near ?x)", "(not (on ?x fridge))", "(free", "Is the {x} here?",
     "{x.place}", "{x", "}", "{{}}", "?", "did", "a {x} {x}"]
) | st.text(max_size=8) | st.none() | st.booleans() | st.integers() | st.floats()  # fmt: skip
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(SCALARS, inner, max_size=3),
    max_leaves=10,
)
SECTIONS = st.sampled_from(
    ["predicates", "actions", "attributes", "types", "objects", "never_asked", "ways"]
)


def harmless(task: Task, folder: Path, text: str | bytes) -> None:
    """The file is read or refused; what is read can be asked."""
    try:
        found = book(task, folder, text)
    except QuestionsError:
        return
    for atom in task.init:
        assert found.fact(Literal(atom)).text
    for action in task.ground_actions()[:20]:
        assert found.say(action)
        found.preconditions(action, task.init)
        found.effects(action, task.init)
        found.possible(action)


@settings(max_examples=300, suppress_health_check=UNHURRIED)
@given(text=st.text() | st.binary())
@example(text="!!python/object/apply:os.system ['true']")
@example(text="? !!set {a, b}\n: !!timestamp x")
@example(text="%YAML 9.9\n---\na")
def test_no_text_at_all_gives_another_error(task: Task, tmp_path: Path, text: str | bytes) -> None:
    harmless(task, tmp_path, text)


@settings(max_examples=500, suppress_health_check=UNHURRIED)
@given(content=st.dictionaries(SECTIONS, VALUES, max_size=4))
def test_no_yaml_of_any_shape_gives_another_error(
    task: Task, tmp_path: Path, content: dict[str, object]
) -> None:
    harmless(task, tmp_path, yaml.safe_dump(content, allow_unicode=True))


@settings(max_examples=200, suppress_health_check=UNHURRIED)
@given(
    st.integers(0, 1800),
    st.integers(0, 6),
    st.sampled_from(["", "{", "}", ":", "\n", "- ", "\t", "'", "x"]),
)
def test_no_slip_of_the_keyboard_in_a_good_file_gives_another_error(
    task: Task, tmp_path: Path, at: int, removed: int, typed: str
) -> None:
    good = Path(str(find_task("eat_apple").questions)).read_text()
    harmless(task, tmp_path, good[:at] + typed + good[at + removed :])


def test_the_examples_of_the_documentation_are_understood(task: Task, tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs" / "questions.md").read_text()
    blocks = [block.partition("```")[0] for block in page.split("```yaml\n")[1:]]
    assert len(blocks) == 6
    again = [block for block in blocks[1:] if block.startswith("predicates:")]
    for block in again:  # the same in several wordings: a file of its own
        assert book(task, tmp_path, block).wordings("near") == 2
    found = book(task, tmp_path, "\n".join(block for block in blocks if block not in again))
    assert (
        found.say(task.action("place", ["knife", "sink", "left"])) == "place the knife on the sink"
    )
    assert found.name("tv") == "TV"
    assert not any(" near;" in notice or " place " in notice for notice in found.notices)


def test_the_first_of_several_wordings_is_asked_and_the_others_are_known(
    task: Task, tmp_path: Path
) -> None:
    words = ("Is a {x} here?", "Is there an {x}?", "Is  a {x} here?!")
    text = "predicates:\n  near:\n" + "".join(f"    - {each}\n" for each in words)
    known = book(task, tmp_path, text)
    near = next(atom for atom in sorted(task.atoms()) if atom.predicate == "near")
    first = known.fact(Literal(near, False))
    name = known.name(near.arguments[0])
    assert (first.wording, first.family, first.expected) == (0, first.text, False)
    second, third = known.in_other_words(first)
    assert third.text == f"Is {'an' if name[0] in 'aeiou' else 'a'} {name} here?!"
    assert [each.wording for each in (second, third)] == [1, 2]
    assert {each.family for each in (first, second, third)} == {first.text}
    assert known.in_other_words(third) == (first, second)
    assert question_record(first).wording is None
    assert question_record(third).wording == 2


def test_a_question_in_one_wording_has_no_other_words(task: Task, tmp_path: Path) -> None:
    known = book(task, tmp_path, "predicates:\n  near: ['Is a {x} here?']")
    near = next(atom for atom in sorted(task.atoms()) if atom.predicate == "near")
    assert known.wordings("near") == 1
    assert known.in_other_words(known.fact(Literal(near))) == ()
