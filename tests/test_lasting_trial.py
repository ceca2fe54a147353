"""Trials in which actions last: what is asked when, what fails meanwhile, and how it is mended."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.doubles import configured
from tests.resumed import resumed, story, unbroken
from tpvqa.assembly import Trial
from tpvqa.bench.cell import Cell
from tpvqa.bench.own_task import OwnTask
from tpvqa.bench.stage import stage
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.errors import TpvqaError
from tpvqa.events import Event
from tpvqa.events.events import Acted, Acting, Asked, Decided, Ended, PlanMade, Waited
from tpvqa.planning import Planner
from tpvqa.planning.remembering import remembering
from tpvqa.planning.unified_engine import UnifiedEngine
from tpvqa.tasks import TaskFiles

pytest.importorskip("up_aries")

LABORATORY = Path(__file__).parents[1] / "examples/timed/laboratory"
CONFIG = configured(
    domain=str(LABORATORY / "domain.pddl"),
    problem=str(LABORATORY / "problem.pddl"),
    questions=str(LABORATORY / "questions.yaml"),
    world_file=str(LABORATORY / "world.yaml"),
    planner="up:aries",
    monitor="tpvqa",
    vlm="oracle:1.0",
    failure=0.0,
)


@pytest.fixture(scope="module")
def planner() -> Iterator[Planner]:
    planner = remembering(UnifiedEngine("aries"))
    yield planner
    planner.close()


def run(config: TrialConfig, planner: Planner) -> list[Event]:
    writer = MemoryWriter()
    with Trial(config, planner=planner) as trial:
        trial.run(writer)
    return writer.events


def interrupted(monitor: str) -> TrialConfig:
    """The tray slips while it is fetched; the autoclave runs meanwhile."""
    return CONFIG.but(monitor=monitor, seed=7)


def ended(events: list[Event]) -> Ended:
    last = events[-1]
    assert isinstance(last, Ended)
    return last


def asked_at(events: list[Event]) -> list[tuple[str, str, set[str]]]:
    """Before or after which step which facts were asked about."""
    plan: PlanMade | None = None
    found, index, when = [], 0, "before"
    for event in events:
        match event:
            case PlanMade():
                plan, index, when = event, 0, "before"
            case Acted():
                when = "after"
            case Decided():
                index, when = event.onward, "before" if event.when == "after" else when
            case Asked() if plan is not None:
                facts = {each.atom or "" for each in event.questions}
                found.append((plan.plan[index].pddl(), when, facts))
    return found


def test_every_condition_and_effect_is_asked_at_its_moment(planner: Planner) -> None:
    events = run(CONFIG.but(simulation={"interruption": 0.0}), planner)
    assert ended(events).completed
    asked = asked_at(events)
    load, cycle = "load scalpel bench boiler", "sterilise scalpel boiler"
    assert (f"(start-{load})", "before", {"(at scalpel bench)"}) in asked
    taken = {"(at scalpel bench)", "(held scalpel)"}
    assert (f"(start-{load})", "after", taken) in asked
    needed = {"(held scalpel)", "(opened boiler)"}
    assert asked.count((f"(while-{load})", "before", needed)) == 3
    assert (f"(end-{load})", "before", needed) in asked
    assert (f"(end-{load})", "after", {"(held scalpel)", "(at scalpel boiler)"}) in asked
    needed = {"(at scalpel boiler)", "(shut boiler)"}
    assert asked.count((f"(while-{cycle})", "before", needed)) == 3
    assert (f"(end-{cycle})", "after", {"(sterilised scalpel)"}) in asked
    assert not any("running" in fact for *_, facts in asked for fact in facts)


def test_actions_overlap_and_come_at_their_times(planner: Planner) -> None:
    events = run(CONFIG.but(simulation={"interruption": 0.0}), planner)
    plan = next(event for event in events if isinstance(event, PlanMade))
    assert plan.times is not None
    names, began = [step.name for step in plan.plan], dict[str, float]()
    clock, order = 0.0, list[str]()
    for event in events:
        match event:
            case Waited():
                clock = event.clock
            case Acting():
                order.append(event.action.name)
                began[event.action.name] = clock
    assert order == names
    assert began == pytest.approx(dict(zip(names, plan.times, strict=True)))
    assert began["end-sterilise"] - began["start-sterilise"] == pytest.approx(30, abs=1e-3)
    assert (
        order.index("start-sterilise") < order.index("start-fetch") < order.index("end-sterilise")
    )


def test_what_fails_while_it_runs_is_mended_by_looking(planner: Planner) -> None:
    blind, seeing = run(interrupted("none"), planner), run(interrupted("tpvqa"), planner)
    assert any(isinstance(each, Waited) and each.truth is not None for each in seeing)
    assert ended(blind).believed_goal
    assert not ended(blind).goal_holds
    assert ended(seeing).completed
    anew = [each for each in seeing if isinstance(each, PlanMade)][1]
    names = [step.name for step in anew.plan]
    assert names[0] == "cancel-fetch"
    assert not {"start-sterilise", "cancel-sterilise"} & {*names}
    assert anew.times is not None
    assert 0 < anew.times[names.index("end-sterilise")] < 30  # what runs goes on to its end


def test_killed_after_any_event_it_is_gone_on_with_to_the_same_end(
    tmp_path: Path, planner: Planner
) -> None:
    whole = unbroken(tmp_path / "whole", interrupted("tpvqa"), planner)
    for cut in range(1, len(whole), max(1, len(whole) // 25)):
        assert story(resumed(tmp_path / "whole", cut, planner)) == story(whole), cut


def test_looks_come_once_in_every_period(planner: Planner) -> None:
    config = CONFIG.but(monitor={"watch": 7.0}, simulation={"interruption": 0.0})
    plan = next(each for each in run(config, planner) if isinstance(each, PlanMade))
    assert plan.times is not None
    steps = list(zip(plan.times, (step.name for step in plan.plan), strict=True))
    (start,) = (at for at, name in steps if name == "start-sterilise")
    looks = [at - start for at, name in steps if name == "while-sterilise"]
    assert looks == pytest.approx([7, 14, 21, 28])


def test_an_end_without_its_effects_is_planned_anew(planner: Planner) -> None:
    """Of seeds the first is taken at which the end of an action fails by chance."""
    for seed in range(20):
        simulation = {"failure": 0.3, "disturbance": 0.0, "interruption": 0.0}
        events = run(CONFIG.but(seed=seed, simulation=simulation), planner)
        ends = [
            number
            for number, each in enumerate(events)
            if isinstance(each, Decided)
            and (each.when, each.decision) == ("after", "replan")
            and each.action.startswith("(end-")
        ]
        if ends:
            later = next(each for each in events[ends[0] :] if isinstance(each, PlanMade))
            assert later.plan[0].name.startswith("cancel-")
            assert ended(events).completed
            return
    pytest.fail("no action failed at its end")


def test_a_bench_runs_trials_of_what_lasts() -> None:
    pddl = LABORATORY / "domain.pddl", LABORATORY / "problem.pddl"
    files = TaskFiles("lab", *pddl, LABORATORY / "questions.yaml", LABORATORY / "world.yaml")
    here = stage("laboratory", OwnTask.read(files))
    cell = Cell("laboratory", "tpvqa", "oracle", "symbolic", "planner=up:aries")
    row, again = (here.run(cell, TrialConfig(seed=2), 0) for _ in range(2))
    assert not row.error
    assert row.completed
    assert (row.actions, row.decisions) == (again.actions, again.decisions)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"planner": "fast-downward"}, "As --planner take up:tamer .*, or up:aries"),
        ({"monitor": "belief"}, "Write --monitor tpvqa"),
    ],
)
def test_what_knows_no_time_is_refused_before_anything_moves(
    change: dict[str, str], says: str
) -> None:
    with pytest.raises(TpvqaError, match=says):
        Trial(CONFIG.but(**change))
