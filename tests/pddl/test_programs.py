"""Logic programs as tasks."""

import contextlib
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.planning.judges import val_accepts
from tpvqa.errors import GroundingTimedOut, PDDLError, PlannerError, TpvqaError
from tpvqa.pddl import Atom, Literal, Task, literals, load_task, validate
from tpvqa.pddl.programs.lifting import Arguments, Guards, Item, patterns
from tpvqa.planning import Plan, Unsolvable
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.making import make_planner

pytest.importorskip("clingo")

PROGRAMS = Path(__file__).parents[2] / "examples" / "programs"
TASKS = ("clean_dishes", "serve_breakfast", "eat_apple")


@pytest.mark.parametrize("name", TASKS)
def test_the_programs_are_the_tasks_of_the_paper(name: str, tmp_path: Path) -> None:
    program, task = load_task(PROGRAMS / f"{name}.lp"), load_task(name)
    assert program.init == task.init
    assert set(literals(program.goal)) == set(literals(task.goal))
    assert program.atoms() == task.atoms()
    assert set(program.reachable_actions) == set(task.reachable_actions)
    assert set(program.mutex_groups) == set(task.mutex_groups)
    assert program.objects == task.objects
    for action in task.ground_actions():
        own = program.action(action.name, action.arguments)
        assert set(own.effects) == set(action.effects)
        for state in (task.init, frozenset(task.atoms())):
            assert program.applicable(state, own) == task.applicable(state, action)
    for spec in ("fast-downward:optimal", "clingo"):
        plan, other = make_planner(spec).plan(program), FastDownward(search="optimal").plan(task)
        assert isinstance(plan, Plan)
        assert isinstance(other, Plan)
        assert len(plan.actions) == len(other.actions)
        own_actions = tuple(task.action(step.name, step.arguments) for step in plan.actions)
        assert validate(task, own_actions).valid
        assert val_accepts(task, task.init, own_actions, tmp_path)


def task_of(tmp_path: Path, text: str) -> Task:
    path = tmp_path / "own.lp"
    path.write_text(text)
    return load_task(path)


def test_conditions_costs_and_what_follows(tmp_path: Path) -> None:
    task = task_of(
        tmp_path,
        """room(1..3). action(go(X,Y)) :- room(X), room(Y), X != Y.
        fluent(at(R)) :- room(R). executable(go(X,Y), at(X)) :- action(go(X,Y)).
        causes(go(X,Y), (at(Y), -at(X))) :- action(go(X,Y)).
        causes(go(X,3), wet, -dry) :- room(X), X != 3.      % an effect under a condition
        impossible(go(1,3), -allowed).                       % only for some arguments
        action(allow). causes(allow, allowed). cost(allow, 2).
        derived(done, (at(3), wet)). initially(at(1)). initially(unused).
        fluent(dry;wet;allowed). goal(done).
        """,
    )
    assert task.derived == {"done"}
    plan = FastDownward(search="optimal").plan(task)
    assert isinstance(plan, Plan)
    assert [str(step) for step in plan.actions] == ["go(n1, n2)", "go(n2, n3)"]
    only = task.apply(task.apply(task.init, task.action("allow")), task.action("go", ("n1", "n3")))
    assert Atom("wet") in only
    assert not task.applicable(task.init, task.action("go", ("n1", "n3")))
    assert task.action("allow").cost == 2


def test_a_program_without_a_plan(tmp_path: Path) -> None:
    task = task_of(
        tmp_path, "action(a). executable(a, g). causes(a, f). fluent(f). fluent(g). goal(f)."
    )
    assert isinstance(FastDownward().plan(task), Unsolvable)


BAD = [
    ("action(a).\ngoal(f.\n", 2, "syntax error"),
    ("action(a).\n#script (python)\nimport os\n#end.\ngoal(f).", 2, "#script is not read"),
    ('action(a).\n#  include "/etc/passwd".\n', 2, "#include is not read"),
    ("action(a). causes(a,g).\ngoal(f).", 2, "nothing ever makes f true"),
    ("action(a).\ncauses(b,f).\ngoal(f).", 2, "there is no action(b)"),
    ("action(a).\ncause(a,f).\ngoal(f).", 2, "Did you mean causes?"),
    ("goal(f).\n{ action(a) }.", 2, "no choice"),
    ("action(a).\ncauses(a,f). goal(f). x :- not y. y :- not x.", None, "more than one answer set"),
    ("action(a). goal(a). :- goal(a).", None, "no answer set"),
    ("action(a).\nholds(f,0). goal(f).", 2, "holds/2 is about time steps"),
    ("action(a).\ncauses(a,f,g,h). goal(f).", 2, "write causes(A,L) or causes(A,L,C)"),
    ("action(a).", None, "nothing says goal(F)"),
    ("", None, "nothing says action(A)"),
    ('action("x y"). goal(f).', 1, "is no fluent or action"),
    ("action(a).\ncauses(a,f(@sys())). goal(f(1)).", 2, "function 'sys' not found"),
    ("action(a).\ncauses(X,f). goal(f).", 2, "unsafe"),
    ("action(a). causes(a,f).\ncost(a,-3). goal(f).", 2, "is no cost"),
    ("action(a). causes(a,p(b)). causes(a,p(b,c)).\ngoal(p(b)).", 2, "1 and with 2 arguments"),
    ("action(a). causes(a,p(bB)). causes(a,p(bb)).\ngoal(p(bb)).", None, "both become bb"),
    ("action(a). causes(a,f).\n#minimize{1}. goal(f).", 2, "is not read"),
    ("action(a). causes(a,f).\n#program step(t).\ngoal(f).", 2, "#program step is not read"),
    ("action(a). causes(a,f). derived(f,g). causes(a,g).\ngoal(f).", None, "derived and caused"),
    (
        "n(1..40). action(a(X,Y)) :- n(X),n(Y). causes(a(X,Y),f(X*Y+X)) :- n(X),n(Y). goal(f(7)).",
        None,
        "not of one shape",
    ),
    ("action(a). fluent(g). causes(a,f).\ngoal(f).", 1, "which no fluent(F) declares"),
]


@pytest.mark.parametrize(("text", "line", "says"), BAD, ids=[says for _, _, says in BAD])
def test_bad_programs_say_where_and_what_to_do(
    text: str, line: int | None, says: str, tmp_path: Path
) -> None:
    with pytest.raises(PDDLError) as caught:
        task_of(tmp_path, text)
    assert says in str(caught.value)
    assert caught.value.line == line
    assert str(caught.value.file).endswith("own.lp")


def test_a_script_is_not_run(tmp_path: Path) -> None:
    proof = tmp_path / "ran"
    for hidden in ("%* *% #script", "%* %* *%\n#script", '"\\"" . #script'):
        program = f"{hidden} (python)\nopen({str(proof)!r}, 'w')\n#end.\naction(a). goal(a)."
        with pytest.raises(PDDLError):
            task_of(tmp_path, program)
    assert not proof.exists()


def test_grounding_that_does_not_end_is_ended(tmp_path: Path) -> None:
    endless = "p(0). p(X+1) :- p(X). action(a). causes(a,f). goal(f)."
    (tmp_path / "endless.lp").write_text(endless)
    start = time.monotonic()
    with pytest.raises(GroundingTimedOut, match="ever new terms"):
        load_task(tmp_path / "endless.lp", timeout=1)
    assert time.monotonic() - start < 6
    (tmp_path / "wide.lp").write_text("q(1..4000,1..4000). action(a). causes(a,f). goal(f).")
    with pytest.raises(PlannerError, match="out of memory"):
        load_task(tmp_path / "wide.lp", timeout=60, memory=150)


NAMES = ("?a", "?b")
PAIRS = st.frozensets(st.tuples(st.sampled_from("xyz"), st.sampled_from("xyz")))


@given(PAIRS, PAIRS)
def test_a_guard_holds_for_its_arguments_and_for_no_others(
    inside: frozenset[tuple[str, str]], others: frozenset[tuple[str, str]]
) -> None:
    outside = others - inside
    guards = Guards()
    said = guards.condition("if", NAMES, inside, outside)
    for one, two in inside | outside:
        assert _holds(said, one, two, guards) == ((one, two) in inside)


def _holds(said: str, one: str, two: str, guards: Guards) -> bool:
    """Reads what a guard may say: equalities, one `or`, one `and`, a static fact."""
    if not said:
        return True
    words = (
        said.replace("?a", one).replace("?b", two).replace("(", " ( ").replace(")", " ) ").split()
    )

    def read(place: int) -> tuple[bool, int]:
        head, place, parts = words[place + 1], place + 2, []
        plain: list[str] = []
        while words[place] != ")":
            if words[place] == "(":
                value, place = read(place)
                parts.append(value)
            else:
                plain.append(words[place])
                place += 1
        if head == "=":
            return plain[0] == plain[1], place + 1
        if head in ("and", "or"):
            return (all if head == "and" else any)(parts), place + 1
        if head == "not":
            return not parts[0], place + 1
        return tuple(plain) in guards.facts[head], place + 1

    return read(0)[0]


LITERALS = st.tuples(st.sampled_from("pq"), st.sampled_from("xyz"), st.booleans())


@given(
    st.dictionaries(
        st.tuples(st.sampled_from("xyz"), st.sampled_from("xyz")),
        st.frozensets(LITERALS, max_size=4),
        max_size=6,
    )
)
def test_patterns_give_every_instance_what_it_had(
    given_items: dict[tuple[str, str], frozenset[tuple[str, str, bool]]],
) -> None:
    items: dict[Arguments, list[Item]] = {
        arguments: [
            ((Literal(Atom(name, (thing,)), positive),), None) for name, thing, positive in own
        ]
        for arguments, own in given_items.items()
    }
    again: dict[Arguments, set[object]] = {arguments: set() for arguments in items}
    for (clause, _), having in patterns(items, NAMES):
        for arguments in having:
            values = dict(zip(NAMES, arguments, strict=True))
            (literal,) = clause
            thing = literal.atom.arguments[0]
            again[arguments].add(
                (literal.atom.predicate, values.get(thing, thing), literal.positive)
            )
    assert again == {arguments: set(own) for arguments, own in given_items.items()}


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_a_damaged_program_is_read_or_refused(data: st.DataObject) -> None:
    """Lines left out or doubled, letters changed: a task, or an error that says what is wrong."""
    lines = (PROGRAMS / "clean_dishes.lp").read_text().splitlines()
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(lines) - 1))
        line = lines[at]
        cut = data.draw(st.integers(0, len(line)))
        put = data.draw(
            st.sampled_from(["", ".", "(", ")", ",", "-", "X", "not ", "{", "1", "#", "é", "%*"])
        )
        lines[at] = data.draw(
            st.sampled_from(["", line + line, line[:cut] + put + line[cut + 1 :]])
        )
    with contextlib.suppress(TpvqaError), tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "own.lp").write_text("\n".join(lines))
        task = load_task(Path(folder) / "own.lp", timeout=10)
        assert task.ground_actions() or task.goal


def test_a_whole_trial_of_a_program_with_the_questions_of_the_task(tmp_path: Path) -> None:
    from tpvqa.tasks import find_task

    questions = find_task("eat_apple").questions
    done = _tpvqa(
        tmp_path,
        *("run", PROGRAMS / "eat_apple.lp", "--questions", questions, "--planner", "clingo"),
        *("--vlm", "oracle:0.95", "--world", "symbolic", "--seed", "3", "--out", "trial"),
    )
    assert done.returncode == 0, done.stderr
    assert "goal reached" in done.stdout
    assert "find the knife" in done.stdout
    shown = _tpvqa(tmp_path, "show", "trial")
    assert shown.returncode == 0
    assert "clingo" in shown.stdout


def test_a_bad_program_on_the_command_line(tmp_path: Path) -> None:
    (tmp_path / "bad.lp").write_text("action(a).\ngoal(f.\n")
    done = _tpvqa(tmp_path, "plan", "bad.lp")
    assert done.returncode == 2
    assert "bad.lp:2: syntax error" in done.stderr
    assert "Traceback" not in done.stderr


def _tpvqa(folder: Path, *words: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "tpvqa", *map(str, words)],
        cwd=folder,
        capture_output=True,
        text=True,
    )
