"""Engines of unified-planning as planners: one that proves its plans shortest, one with numbers."""

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.pddl.feature_domains import CONDITIONAL, COSTS, DERIVED, DISJUNCTION, QUANTIFIERS, Sample
from tests.planning.random_states import random_states
from tests.planning.test_clingo import lamps
from tests.planning.test_unified import robot
from tpvqa.errors import MissingExtraError, PluginError
from tpvqa.pddl import load_task, task_from_text, validate
from tpvqa.pddl.outside import engines
from tpvqa.pddl.outside.asking import pool_of
from tpvqa.planning import Crashed, Plan, Planner, TimedOut, Unsolvable
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.making import make_planner
from tpvqa.planning.unified import sequential_plan, task_from_problem
from tpvqa.planning.unified_engine import UnifiedEngine

pytest.importorskip("up_pyperplan")
pytest.importorskip("up_aries")

TESTED = ("up:pyperplan-opt", "up:aries")
MODULE = "tpvqa.planning.engines.unified_solving"


@pytest.mark.parametrize("spec", TESTED)
def test_replanning_from_any_state(spec: str) -> None:
    task, planner = load_task("clean_dishes"), make_planner(spec)
    optimal = FastDownward(search="optimal")
    assert planner.name == spec
    for state in random_states(task, seed=4, count=3):
        ours, other = planner.plan(task, state, timeout=60), optimal.plan(task, state)
        assert type(ours) is type(other)
        if isinstance(ours, Plan) and isinstance(other, Plan):
            assert validate(task, ours.actions, state).valid
            assert ours.cost == other.cost if spec.endswith("-opt") else ours.cost >= other.cost


@pytest.mark.parametrize(
    "sample", [CONDITIONAL, COSTS, DISJUNCTION, QUANTIFIERS], ids=lambda s: s.name
)
@pytest.mark.parametrize("spec", TESTED)
def test_what_an_engine_does_not_know_is_compiled_away(spec: str, sample: Sample) -> None:
    result = make_planner(spec).plan(task_from_text(sample.domain, sample.problem), timeout=60)
    assert isinstance(result, Plan), result
    assert sample.cost is not None
    assert result.cost >= sample.cost


def test_derived_predicates_are_refused_with_who_knows_them() -> None:
    result = make_planner(TESTED[0]).plan(task_from_text(DERIVED.domain, DERIVED.problem))
    assert isinstance(result, Crashed)
    assert "fast-downward and clingo know them" in result.reason


def test_no_plan_is_unsolvable_only_where_it_is_proved() -> None:
    """pyperplan gives up after the whole search, and says no more; the relaxation is our proof."""
    planner = make_planner("up:pyperplan-opt")
    result = planner.plan(lamps(3), timeout=60)
    assert isinstance(result, Unsolvable | Crashed)
    assert "prove" in result.reason or "no proof" in result.reason
    out_of_reach = load_task("clean_dishes")
    stuck = frozenset(atom for atom in out_of_reach.init if atom.predicate != "free")
    assert isinstance(planner.plan(out_of_reach, stuck), Unsolvable)


def test_a_hang_is_a_time_out_and_the_next_call_works() -> None:
    planner = UnifiedEngine("pyperplan-opt")
    start = time.monotonic()
    assert isinstance(planner.plan(load_task("build_tower"), timeout=0.05), TimedOut)
    assert time.monotonic() - start < 5
    assert isinstance(planner.plan(load_task("clean_dishes"), timeout=60), Plan)


def test_memory_that_runs_away_ends_the_engine_alone() -> None:
    result = UnifiedEngine("pyperplan-opt", memory=30).plan(load_task("build_tower"), timeout=60)
    assert isinstance(result, Crashed)
    assert "its limit is 30 MiB" in result.reason


def test_an_engine_that_is_killed_twice_has_crashed() -> None:
    planner, found = UnifiedEngine("aries"), []
    call = threading.Thread(
        target=lambda: found.append(planner.plan(load_task("build_tower"), timeout=60))
    )
    call.start()
    killed: set[int] = set()
    end = time.monotonic() + 30
    while len(killed) < 2 and time.monotonic() < end:
        for worker in list(pool_of(MODULE)._lent):
            if worker.pid not in killed:
                time.sleep(0.2)
                os.kill(worker.pid, signal.SIGKILL)
                killed.add(worker.pid)
        time.sleep(0.02)
    call.join(30)
    assert isinstance(found[0], Crashed)
    assert "killed by signal 9" in found[0].reason


def test_nothing_is_left_of_an_engine_whose_caller_is_killed(tmp_path: Path) -> None:
    script = (
        "from tpvqa.pddl import load_task; from tpvqa.planning.making import make_planner\n"
        "make_planner('up:aries').plan(load_task('build_tower'), timeout=60)"
    )
    caller = subprocess.Popen([sys.executable, "-c", script])
    found: list[int] = []
    end = time.monotonic() + 40
    while not found and time.monotonic() < end:  # until the engine has started its own server
        found = [
            pid for pid, words in _running() if "up-aries" in words and _above(pid, caller.pid)
        ]
        time.sleep(0.1)
    caller.kill()
    caller.wait()
    assert found
    end = time.monotonic() + 10
    while any(map(_runs, found)) and time.monotonic() < end:
        time.sleep(0.1)
    assert not [pid for pid in found if _runs(pid)]


def _runs(pid: int) -> bool:
    """Whether a process is there, and not only its exit code."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def _running() -> Iterator[tuple[int, str]]:
    for folder in Path("/proc").iterdir():
        if folder.name.isdigit():
            with contextlib.suppress(OSError):
                yield int(folder.name), (folder / "cmdline").read_text().replace("\0", " ")


def _above(pid: int, ancestor: int) -> bool:
    while pid > 1:
        if pid == ancestor:
            return True
        try:
            pid = int(Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[1])
        except OSError:
            return False
    return False


def test_missing_engines_name_their_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tpvqa.planning.unified_engine.is_there", lambda engine: False)
    with pytest.raises(PluginError, match="pip install up-symk"):
        make_planner("up:symk-opt")
    monkeypatch.setattr("tpvqa.planning.unified_engine.find_spec", lambda name: None)
    with pytest.raises(MissingExtraError, match=r"tpvqa\[up\]"):
        make_planner("up:symk-opt")


def test_unknown_engines_are_refused_with_those_there_are() -> None:
    with pytest.raises(PluginError, match="Did you mean 'pyperplan'"):
        make_planner("up:pyperplans")
    with pytest.raises(PluginError, match="Write up:NAME"):
        make_planner("up")


def test_the_packages_are_those_that_unified_planning_names() -> None:
    factory = pytest.importorskip("unified_planning.engines.factory")
    for engine, package in engines.PACKAGES.items():
        module, _ = factory.DEFAULT_ENGINES[engine]
        assert module.partition(".")[0] == package.replace("-", "_")


def test_a_problem_goes_in_and_a_sequential_plan_comes_out() -> None:
    problem = robot()
    planner: Planner = make_planner("up:pyperplan-opt")
    plan = planner.plan(task_from_problem(problem))
    assert isinstance(plan, Plan)
    sequential = sequential_plan(problem, plan)
    assert [str(step) for step in sequential.actions] == [
        "move(home, shop)",
        "take(milk, shop)",
        "move(shop, home)",
    ]
    shortcuts = pytest.importorskip("unified_planning.shortcuts")
    with shortcuts.PlanValidator(name="sequential_plan_validator") as validator:
        assert validator.validate(problem, sequential)
