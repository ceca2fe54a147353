"""The planner at its seam: the paper's plans, every PDDL feature, every way a call can end."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.pddl.feature_domains import DERIVED, EMPTY, EXHAUSTED, SAMPLES, UNREACHABLE, Sample
from tpvqa.errors import PDDLError, PlannerError, PluginError
from tpvqa.pddl import Action, Atom, State, Task, load_task, task_from_text, validate
from tpvqa.pddl.processes import WORKERS
from tpvqa.planning import Crashed, Plan, Planner, TimedOut, Unsolvable
from tpvqa.planning.fast_downward import SEARCHES, FastDownward
from tpvqa.plugins import Kind, make

PAPER: dict[str, list[tuple[str, ...]]] = {
    "clean_dishes": [
        ("find", "plate"),
        ("pick_up", "plate"),
        ("find", "sink"),
        ("wash", "plate"),
    ],
    "serve_breakfast": [
        ("find", "bread"),
        ("pick_up", "bread"),
        ("find", "plate"),
        ("place", "bread", "plate"),
        ("find", "tv"),
        ("turn_on", "tv"),
    ],
    "eat_apple": [
        ("find", "fridge"),
        ("open", "fridge"),
        ("find", "apple"),
        ("pick_up", "apple"),
        ("find", "knife"),
        ("pick_up", "knife"),
        ("cut_in_half", "apple"),
    ],
}


@pytest.mark.parametrize("name", PAPER)
@pytest.mark.parametrize("again", range(2))
def test_the_plans_are_those_of_the_papers_table(name: str, again: int) -> None:
    plan = FastDownward().plan(load_task(name))
    assert isinstance(plan, Plan)
    short = [(a.name, *a.arguments[: len(w) - 1]) for a, w in zip(plan.actions, PAPER[name])]  # noqa: B905
    assert short == PAPER[name]
    assert len(plan.actions) == len(PAPER[name])
    assert plan.cost == len(plan.actions)


def test_the_apple_is_cut_with_both_hands() -> None:
    plan = FastDownward().plan(load_task("eat_apple"))
    assert isinstance(plan, Plan)
    _, knife, left, right = plan.actions[-1].arguments
    assert knife == "knife"
    assert {left, right} == {"left", "right"}


@pytest.mark.parametrize("sample", SAMPLES, ids=lambda sample: sample.name)
def test_every_feature_is_planned_with(sample: Sample) -> None:
    task = task_from_text(sample.domain, sample.problem)
    for search in (None, *SEARCHES):
        plan = FastDownward(search=search).plan(task)
        if sample.cost is None:
            assert isinstance(plan, Unsolvable)
            continue
        assert isinstance(plan, Plan)
        assert plan.cost == sample.cost if search == "optimal" else plan.cost >= sample.cost
        assert validate(task, plan.actions).valid
        assert plan.cost == sum(action.cost for action in plan.actions)


def changed(task: Task, *, gone: str = "", come: str = "") -> State:
    def split(text: str) -> set[Atom]:
        return {Atom.parse(part) for part in text.split(";") if part.strip()}

    assert split(gone) <= task.init
    return (task.init - split(gone)) | split(come)


@pytest.mark.parametrize(
    ("gone", "come", "length"),
    [
        ("near tv", "near apple", 4),  # beside it though the fridge is shut
        ("on apple fridge", "on apple floor", 5),
        ("on apple fridge", "on apple tv", 5),  # where no action can put it
        ("on apple fridge; free left", "in_hand apple left", 3),
        ("", "on apple table", 7),  # two places at once; shut in by the one that is the fridge
        ("", "opened fridge", 5),
    ],
)
def test_replanning_from_states_nothing_leads_to(gone: str, come: str, length: int) -> None:
    task = load_task("eat_apple")
    state = changed(task, gone=gone, come=come)
    plan = FastDownward().plan(task, state)
    assert isinstance(plan, Plan)
    assert validate(task, plan.actions, state).valid
    assert len(plan.actions) == length


def test_an_object_that_is_nowhere_makes_it_unsolvable() -> None:
    task = load_task("eat_apple")
    result = FastDownward().plan(task, changed(task, gone="on apple fridge"))
    assert isinstance(result, Unsolvable)
    assert result.reason
    assert result.planner == "fast-downward"


@pytest.mark.parametrize("sample", [UNREACHABLE, EXHAUSTED])
def test_unsolvable_from_here_but_not_from_there(sample: Sample) -> None:
    task = task_from_text(sample.domain, sample.problem)
    planner = FastDownward()
    assert isinstance(planner.plan(task), Unsolvable)
    state = task.init | ({Atom("fresh", ("c",))} if sample is EXHAUSTED else {Atom("lamp", ("a",))})
    plan = planner.plan(task, state)
    assert isinstance(plan, Plan)
    assert validate(task, plan.actions, state).valid
    assert isinstance(planner.plan(task), Unsolvable)


def test_static_facts_may_differ_from_the_problems() -> None:
    task = task_from_text(DERIVED.domain, DERIVED.problem)
    planner = FastDownward()
    assert isinstance(planner.plan(task), Plan)
    without_block = task.init - {Atom("block", ("c",))}
    assert isinstance(planner.plan(task, without_block), Unsolvable)
    assert isinstance(planner.plan(task), Plan)


def test_a_state_may_hold_derived_atoms_which_are_ignored() -> None:
    task = task_from_text(DERIVED.domain, DERIVED.problem)
    wrong = task.init | {Atom("above", ("c", "a"))}
    plan = FastDownward().plan(task, wrong)
    assert isinstance(plan, Plan)
    assert plan.actions


def test_the_time_limit_is_a_result_of_its_own() -> None:
    result = FastDownward().plan(load_task("eat_apple"), timeout=0.0)
    assert isinstance(result, TimedOut)
    assert result.limit == 0.0


def test_a_state_of_another_task_is_refused() -> None:
    with pytest.raises(PDDLError, match="no predicate 'done'"):
        FastDownward().plan(load_task("eat_apple"), frozenset({Atom("done")}))


def test_a_plan_that_does_not_work_is_not_handed_on(monkeypatch: pytest.MonkeyPatch) -> None:
    import tpvqa.planning.fast_downward as module

    reply = {"outcome": {"kind": "plan", "steps": [["finish"]]}}
    monkeypatch.setattr(module, "ask_worker", lambda *_, **__: reply)
    result = FastDownward().plan(task_from_text(EMPTY.domain, EMPTY.problem))
    assert isinstance(result, Crashed)
    assert "does not work: step 1, finish(), needs ready()" in result.reason


@pytest.mark.parametrize("spec", ["fast-downward", *(f"fast-downward:{s}" for s in SEARCHES)])
def test_it_is_a_planner_named_by_its_specification(spec: str) -> None:
    planner = make(Kind.PLANNER, spec)
    assert isinstance(planner, Planner)
    assert planner.name == spec
    plan = planner.plan(load_task("clean_dishes"))
    assert isinstance(plan, Plan)
    assert plan.planner == spec


@given(st.text().map(str.strip).filter(lambda text: text not in ("", *SEARCHES)))
def test_other_searches_are_refused_with_those_there_are(search: str) -> None:
    with pytest.raises(PluginError, match="fast-downward:optimal or fast-downward:lama"):
        make(Kind.PLANNER, f"fast-downward:{search}")


def test_the_nearest_search_is_suggested() -> None:
    with pytest.raises(PluginError, match="Did you mean 'optimal'"):
        make(Kind.PLANNER, "fast-downward:optimum")


def test_grounding_is_kept() -> None:
    """The same states again cost no grounding: only a surprise does, and only once."""
    task = load_task("eat_apple")
    surprise = changed(task, gone="on apple fridge", come="on apple tv")
    moved = changed(task, gone="near tv", come="near sink")

    def groundings(state: State) -> int:
        from tpvqa.pddl.description import to_lists
        from tpvqa.pddl.processes import ask_worker

        request = {
            "do": "plan",
            "state": to_lists(state),
            "searches": {"simple": "astar(blind())", "other": "astar(blind())"},
            "seconds": 30,
            "memory": None,
        }
        reply = ask_worker(
            request, key=task.key, domain=task.domain_text, problem=task.problem_text, seconds=30
        )
        assert reply["outcome"]["kind"] == "plan"
        return int(reply["groundings"])

    WORKERS.close()
    counts = [groundings(s) for s in (task.init, moved, surprise, task.init, surprise, moved)]
    assert counts == [1, 1, 2, 2, 2, 2]


def test_actions_come_from_the_task() -> None:
    task = load_task("clean_dishes")
    plan = FastDownward().plan(task)
    assert isinstance(plan, Plan)
    assert all(isinstance(action, Action) for action in plan.actions)
    assert plan.actions[0] is task.action("find", plan.actions[0].arguments)


def test_an_infinite_time_limit_is_none_and_no_number_is_refused() -> None:
    task = load_task("clean_dishes", timeout=math.inf)
    planner = FastDownward(timeout=math.inf)
    assert isinstance(planner.plan(task), Plan)
    assert isinstance(planner.plan(task, timeout=math.inf), Plan)
    for wrong in (math.nan, -1.0, -math.inf):
        with pytest.raises(PlannerError, match="no time limit"):
            planner.plan(task, timeout=wrong)
        with pytest.raises(PlannerError, match="no time limit"):
            load_task("clean_dishes", timeout=wrong)
