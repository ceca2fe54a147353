"""Plans of what lasts, beside unified-planning's own reader of PDDL and its own validator."""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tpvqa.pddl import Action, State, Task, load_task, task_from_text
from tpvqa.pddl.lasting import Phase, Running
from tpvqa.planning import Plan
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
