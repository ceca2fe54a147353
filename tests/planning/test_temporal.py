"""Plans of what lasts, beside unified-planning's own reader of PDDL and its own validator."""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tpvqa.pddl import Action, State, Task, load_task, task_from_text
from tpvqa.pddl.lasting import Phase, Running
from tpvqa.planning import Crashed, Plan, Unsolvable
from tpvqa.planning.engines.temporal_solving import scale_of
from tpvqa.planning.temporal import flaw
from tpvqa.planning.unified_engine import UnifiedEngine
from tpvqa.planning.watching import Watching

pytest.importorskip("up_aries")

LABORATORY = Path(__file__).parents[2] / "examples/timed/laboratory"
FACTS = tuple(f"f{n}" for n in range(4))
SPACE = 0.1
"""Between what was done and what is planned from there."""


@pytest.fixture(scope="module")
def engine() -> Iterator[UnifiedEngine]:
    planner = UnifiedEngine("aries")
    yield planner
    planner.close()


@st.composite
def domains(draw: st.DrawFn) -> str:
    """A few actions over a few facts; some begin at once what others need meanwhile."""
    literals = st.sampled_from([*(f"({f})" for f in FACTS), *(f"(not ({f}))" for f in FACTS)])

    facts = st.sampled_from([f"({f})" for f in FACTS])

    def timed(words: Sequence[str], count: int) -> str:
        parts = [(draw(st.sampled_from(words)), draw(facts | literals)) for _ in range(count)]
        return " ".join(f"({when} {literal})" for when, literal in parts)

    actions = []
    for number in range(draw(st.integers(3, 5))):
        least = draw(st.integers(1, 8))
        most = least + draw(st.integers(0, 2))
        lasts = f"(and (>= ?duration {least / 2}) (<= ?duration {most / 2}))"
        needs = timed(("at start", "over all", "at end"), draw(st.integers(0, 2)))
        does = timed(("at start", "at end"), draw(st.integers(2, 4)))
        actions.append(
            f"(:durative-action d{number} :parameters () :duration {lasts}\n"
            f" :condition (and {needs}) :effect (and {does}))"
        )
    actions.append(
        f"(:action i0 :parameters () :precondition (and {draw(literals)})\n"
        f" :effect (and {draw(literals)}))"
    )
    return (
        "(define (domain random)\n(:requirements :strips :negative-preconditions "
        ":durative-actions :duration-inequalities)\n"
        f"(:predicates {' '.join(f'({f})' for f in FACTS)})\n" + "\n".join(actions) + ")"
    )


PROBLEM = "(define (problem p) (:domain random) (:init {init}) (:goal (and {goal})))"


@st.composite
def tasks(draw: st.DrawFn) -> tuple[str, str]:
    init = draw(st.sets(st.sampled_from(FACTS), max_size=1))
    rest = [fact for fact in FACTS if fact not in init]
    goal = draw(st.sets(st.sampled_from(rest), min_size=2, max_size=3))
    facts = (" ".join(f"({f})" for f in sorted(part)) for part in (init, goal))
    return draw(domains()), PROBLEM.format(**dict(zip(("init", "goal"), facts, strict=True)))


Step = tuple[float, Action]


def valid(texts: tuple[str, str], task: Task, steps: Sequence[Step]) -> bool:
    """Whether unified-planning finds a plan right for the problem as it reads it itself."""
    from unified_planning.engines.plan_validator import TimeTriggeredPlanValidator
    from unified_planning.environment import get_environment
    from unified_planning.io import PDDLReader
    from unified_planning.plans import ActionInstance, TimeTriggeredPlan

    get_environment().credits_stream = None
    problem = PDDLReader().parse_problem_string(*texts)
    problem.clear_quality_metrics()
    lasting, timed = task.lasting, []
    said = problem.environment.expression_manager.ObjectExp
    assert lasting is not None
    for place, (at, action) in enumerate(steps):
        phase, name = lasting.phase_of(action.name), lasting.name_of(action.name) or action.name
        if phase in (Phase.END, Phase.WHILE):
            continue
        objects = [problem.object(word) for word in action.arguments]
        instance = ActionInstance(problem.action(name), tuple(map(said, objects)))
        lasts = None
        if phase is Phase.START:
            end = lasting.part(task, action, Phase.END)
            lasts = _exact(next(t for t, a in steps[place:] if a == end) - at)
        timed.append((_exact(at), instance, lasts))
    validator = TimeTriggeredPlanValidator()
    validator.skip_checks = True
    return bool(validator.validate(problem, TimeTriggeredPlan(timed, problem.environment)))


def _exact(number: float) -> Fraction:
    return Fraction(number).limit_denominator(10_000)


@settings(max_examples=12, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(texts=tasks(), cut=st.floats(0, 1))
def test_plans_are_right_also_from_the_midst_of_what_runs(
    engine: UnifiedEngine, texts: tuple[str, str], cut: float
) -> None:
    task = task_from_text(*texts)
    plan = engine.plan(task, timeout=1)
    if not isinstance(plan, Plan):
        return
    steps = list(zip(plan.times, plan.actions, strict=True))
    assert flaw(task, plan.actions, task.init) is None
    assert valid(texts, task, steps)
    if not steps:
        return
    done = steps[: round(cut * len(steps))]
    state: State = task.init
    for _, action in done:
        state = task.apply(state, action)
    now = done[-1][0] + SPACE if done else 0.0
    assert task.lasting is not None
    running = []
    for begun in task.lasting.under_way(task, state):
        end = task.lasting.part(task, begun, Phase.END)
        left = next(at for at, action in steps[len(done) :] if action == end) - now
        if left <= SPACE:
            return
        running.append(Running(begun, left))
    rest = engine.plan_meanwhile(task, state, running, timeout=1)
    if isinstance(rest, Plan):
        later = [(now + at, a) for at, a in zip(rest.times, rest.actions, strict=True)]
        assert valid(texts, task, done + later)


def test_a_shipped_domain_is_planned_with_what_overlaps(engine: UnifiedEngine) -> None:
    files = LABORATORY / "domain.pddl", LABORATORY / "problem.pddl"
    task, texts = load_task(*files), tuple(file.read_text(encoding="utf-8") for file in files)
    plan = engine.plan(task)
    assert isinstance(plan, Plan), plan
    steps = list(zip(plan.times, plan.actions, strict=True))
    assert valid((texts[0], texts[1]), task, steps)
    looking = Watching(engine).plan(task)
    assert isinstance(looking, Plan)
    assert flaw(task, looking.actions, task.init) is None
    assert [*looking.times] == sorted(looking.times)
    names = [action.name for action in looking.actions]
    assert names.count("while-sterilise") == names.count("while-load") == 3


def test_what_is_left_may_be_any_number(engine: UnifiedEngine) -> None:
    """By a robot's clock; engines want whole numbers, and take long over great ones."""
    yard = LABORATORY.parent / "yard"
    task = load_task(yard / "domain.pddl", yard / "problem.pddl")
    begun = [
        task.action("start-carry", words)
        for words in (("c1", "a", "s1", "t1"), ("c2", "b", "s2", "t2"))
    ]
    state: State = task.init
    for action in begun:
        state = task.apply(state, action)
    left = (1.23456, 3.14159)
    plan = engine.plan_meanwhile(task, state, [*map(Running, begun, left)], timeout=20)
    assert isinstance(plan, Plan), plan
    ends = [
        at for at, each in zip(plan.times, plan.actions, strict=True) if each.name == "end-carry"
    ]
    assert ends == pytest.approx(left, abs=1e-3)


@pytest.mark.parametrize("lasts", [0.0001, 0.1234567, 1 / 3, 7.0, 1e6])
def test_no_duration_is_rounded_away(lasts: float) -> None:
    scale = scale_of({"lasting": [[0, 1, 2, lasts, lasts], [0, 1, 2, 1 / 997, 1]], "running": []})
    assert abs(round(lasts * scale) / scale - lasts) <= max(1e-3 * lasts, 5e-4 * (lasts > 0.01))
    assert round(scale / 997) > 0


ROOMS = """(define (domain rooms) (:requirements :typing :durative-actions :fluents)
 (:types room) (:predicates (in ?r - room)) (:functions (way ?a ?b - room))
 (:durative-action go :parameters (?a ?b - room) :duration (= ?duration (way ?a ?b))
  :condition (at start (in ?a)) :effect (and (at start (not (in ?a))) (at end (in ?b)))))"""
WAYS = """(define (problem p) (:domain rooms) (:objects a b c - room)
 (:init (in a) (= (way a b) 2) (= (way b b) 0) (= (way b c) 3)) (:goal (in {goal})))"""


def test_a_way_from_a_place_to_itself_takes_no_time_and_is_not_gone(engine: UnifiedEngine) -> None:
    """Competitions' problems are full of such: of nothing or without any value."""
    plan = engine.plan(task_from_text(ROOMS, WAYS.format(goal="c")), timeout=20)
    assert isinstance(plan, Plan), plan
    assert plan.times[-1] == pytest.approx(5, abs=1)
    back = WAYS.format(goal="a").replace("(in a) (=", "(in b) (=", 1)
    none = engine.plan(task_from_text(ROOMS, back), timeout=20)
    assert isinstance(none, Crashed)
    assert "without what has no duration: the duration of go(b, a) is" in none.reason
    nowhere = engine.plan(task_from_text(ROOMS, back), frozenset(), timeout=20)
    assert isinstance(nowhere, Unsolvable), nowhere  # no such way would help
