"""The worker processes: killed, hung, orphaned, many at once, and what they leave behind."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from tests.pddl.feature_domains import SAMPLES
from tpvqa.errors import PlannerError
from tpvqa.pddl import Action, Task, load_task, processes, task_from_text, validate
from tpvqa.planning import Crashed, Plan, TimedOut, fast_downward
from tpvqa.planning.fast_downward import FastDownward

pytestmark = pytest.mark.slow

# Solvable, but neither quickly (a permutation of many tiles) nor in little memory.
_TILES = 24
HARD_DOMAIN = """(define (domain tiles) (:requirements :strips)
  (:predicates (at ?t ?p) (hole ?p) (next ?a ?b))
  (:action slide :parameters (?t ?a ?b)
    :precondition (and (at ?t ?a) (hole ?b) (next ?a ?b))
    :effect (and (at ?t ?b) (not (at ?t ?a)) (hole ?a) (not (hole ?b)))))"""


def hard_problem() -> str:
    side = 5
    places = [f"p{n}" for n in range(side * side)]
    pairs = [
        (a, b)
        for a in range(side * side)
        for b in range(side * side)
        if abs(a // side - b // side) + abs(a % side - b % side) == 1
    ]
    near = " ".join(f"(next p{a} p{b})" for a, b in pairs)
    start = " ".join(f"(at t{n} p{(n * 7 + 3) % 24})" for n in range(_TILES))
    goal = " ".join(f"(at t{n} p{n})" for n in range(_TILES))
    tiles = " ".join(f"t{n}" for n in range(_TILES))
    return f"""(define (problem mixed) (:domain tiles) (:objects {tiles} {" ".join(places)})
      (:init (hole p24) {near} {start}) (:goal (and {goal})))"""


@pytest.fixture(scope="module")
def hard() -> Task:
    """A task whose optimal search goes on for longer than any test."""
    return task_from_text(HARD_DOMAIN, hard_problem())


@pytest.fixture(autouse=True)
def _fresh_workers() -> Iterator[None]:
    processes.WORKERS.end()
    yield
    processes.WORKERS.end()


def children(of: int) -> list[int]:
    """The living child processes of a process."""
    found = []
    for entry in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, parent = entry.read_text().rsplit(")", 1)[1].split()[:2]
        except OSError:
            continue
        if int(parent) == of and state != "Z":
            found.append(int(entry.parent.name))
    return found


def alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def eventually(condition: object, seconds: float = 120.0) -> bool:
    assert callable(condition)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.02)
    return False


def workers() -> list[int]:
    """The worker processes of this process."""
    return [
        pid
        for pid in children(os.getpid())
        if b"tpvqa.pddl.worker" in Path(f"/proc/{pid}/cmdline").read_bytes()
    ]


def busy_searches() -> list[int]:
    """Searches that use the processor, not those that wait for a task."""

    def ticks(pid: int) -> int:
        try:
            return int(Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[11])
        except OSError:
            return 0

    return [pid for worker in workers() for pid in children(worker) if ticks(pid) > 5]


def test_a_killed_worker_is_replaced_and_the_call_succeeds() -> None:
    task = load_task("eat_apple")
    planner = FastDownward()
    first = planner.plan(task)
    assert isinstance(first, Plan)
    for pid in workers():
        os.kill(pid, signal.SIGKILL)
    again = planner.plan(task)
    assert isinstance(again, Plan)
    assert again.actions == first.actions


def test_a_worker_killed_in_the_middle_of_a_call_is_retried_once(hard: Task) -> None:
    planner = FastDownward(search="optimal", timeout=60)
    results: list[object] = []
    thread = threading.Thread(target=lambda: results.append(planner.plan(hard)))
    thread.start()
    for _ in range(2):
        assert eventually(busy_searches)
        (worker,) = workers()
        searches = children(worker)
        os.kill(worker, signal.SIGKILL)
        assert eventually(lambda pids=tuple(searches): not any(map(alive, pids)))
    thread.join(120)
    (result,) = results
    assert isinstance(result, Crashed)
    assert "failed twice" in result.reason
    assert workers() == []


def test_a_hung_worker_is_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    task = load_task("eat_apple")
    planner = FastDownward()
    assert isinstance(planner.plan(task), Plan)
    (hung,) = workers()
    os.kill(hung, signal.SIGSTOP)
    monkeypatch.setattr(processes, "SILENCE", 1.5)
    assert isinstance(planner.plan(task), Plan)
    assert not alive(hung)


def test_a_busy_worker_does_not_count_as_hung(hard: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(processes, "SILENCE", 3.0)
    result = FastDownward(search="optimal", memory=None).plan(hard, timeout=6.0)
    assert isinstance(result, TimedOut)
    assert result.seconds >= 6.0
    assert eventually(lambda: not busy_searches())


def test_a_crashing_search_is_retried_once(hard: Task) -> None:
    planner = FastDownward(search="optimal", timeout=60)
    results: list[object] = []
    thread = threading.Thread(target=lambda: results.append(planner.plan(hard)))
    thread.start()
    for _ in range(2):
        assert eventually(busy_searches)
        (search,) = busy_searches()
        os.kill(search, signal.SIGSEGV)
        assert eventually(lambda pid=search: not alive(pid))
    thread.join(120)
    (result,) = results
    assert isinstance(result, Crashed)
    assert "signal 11" in result.reason


def test_grounding_out_of_memory_is_said_and_the_next_task_is_grounded() -> None:
    names = " ".join(f"o{number}" for number in range(24))
    facts = " ".join(f"(p {name})" for name in names.split())
    domain = (
        "(define (domain big) (:predicates (p ?a) (q ?a ?b ?c ?d)) (:action go :parameters (?a ?b "
        "?c ?d) :precondition (and (p ?a) (p ?b) (p ?c) (p ?d)) :effect (q ?a ?b ?c ?d)))"
    )
    fours = [" ".join(f"o{first + more}" for more in range(4)) for first in range(0, 24, 4)]
    goal = f"(and {' '.join(f'(q {four})' for four in fours)})"  # so that no object is left out
    problem = (
        f"(define (problem all) (:domain big) (:objects {names}) (:init {facts}) (:goal {goal}))"
    )
    with pytest.raises(PlannerError, match=r"more memory than 0.195 GB; make the problem smaller"):
        task_from_text(domain, problem, memory=200)
    few = {names: fours[0], facts: "(p o0)", goal: f"(q {fours[0]})"}
    for written, instead in few.items():
        problem = problem.replace(written, instead)
    assert task_from_text(domain, problem)


def test_running_out_of_memory_is_said(hard: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    hungriest = {"simple": "astar(blind())", "other": "astar(blind())"}
    monkeypatch.setattr(fast_downward, "_searches", lambda *_: hungriest)
    result = FastDownward(timeout=60, memory=64).plan(hard)
    assert isinstance(result, Crashed)
    assert "ran out of memory (its limit is 64 MiB)" in result.reason


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_nothing_outlives_the_process(how: signal.Signals, tmp_path: Path) -> None:
    script = tmp_path / "plan.py"
    (tmp_path / "domain.pddl").write_text(HARD_DOMAIN)
    (tmp_path / "problem.pddl").write_text(hard_problem())
    script.write_text(
        "from tpvqa.pddl import load_task\n"
        "from tpvqa.planning.fast_downward import FastDownward\n"
        "task = load_task('domain.pddl', 'problem.pddl')\n"
        "FastDownward(search='optimal', memory=None).plan(task)\n"
    )
    folder = tmp_path / "empty"
    folder.mkdir()
    before = set(os.listdir(tmp_path))
    process = subprocess.Popen([sys.executable, script], cwd=tmp_path, stderr=subprocess.DEVNULL)
    try:
        assert eventually(lambda: any(children(child) for child in children(process.pid)))
        (worker,) = children(process.pid)
        searches = children(worker)
        process.send_signal(how)
        process.wait(120)
        assert eventually(lambda: not any(map(alive, [worker, *searches])))
    finally:
        process.kill()
        process.wait()
    assert set(os.listdir(tmp_path)) == before


def test_a_stopped_worker_ends_with_its_parent(tmp_path: Path) -> None:
    script = (
        "import os, signal, sys, time\n"
        "from tpvqa.pddl import load_task\n"
        "load_task('eat_apple')\n"
        "print('ready', flush=True)\n"
        "time.sleep(60)\n"
    )
    process = subprocess.Popen([sys.executable, "-c", script], cwd=tmp_path, stdout=subprocess.PIPE)
    assert process.stdout is not None
    assert process.stdout.readline() == b"ready\n"
    (worker,) = children(process.pid)
    os.kill(worker, signal.SIGSTOP)
    process.kill()
    process.wait()
    process.stdout.close()
    assert eventually(lambda: not alive(worker))


def test_eight_threads_with_planners_of_every_kind_get_their_own_plans() -> None:
    solvable = [sample for sample in SAMPLES if sample.cost][:7]
    tasks = [task_from_text(sample.domain, sample.problem) for sample in solvable]
    tasks.append(load_task("serve_breakfast"))
    specs = (None, *fast_downward.SEARCHES)
    alone = [{spec: FastDownward(search=spec).plan(task) for spec in specs} for task in tasks]

    def replan(task: Task) -> list[tuple[str | None, tuple[Action, ...]]]:
        planners = {spec: FastDownward(search=spec) for spec in specs}
        plans = []
        for spec in specs * 5:
            plan = planners[spec].plan(task)
            assert isinstance(plan, Plan)
            assert validate(task, plan.actions).valid
            plans.append((spec, plan.actions))
        return plans

    with ThreadPoolExecutor(8) as threads:
        for first, plans in zip(alone, threads.map(replan, tasks), strict=True):
            for spec, actions in plans:
                found = first[spec]
                assert isinstance(found, Plan)
                assert actions == found.actions
    assert len(workers()) <= 8


def test_a_worker_outlives_the_thread_that_started_it() -> None:
    task_thread = threading.Thread(target=lambda: load_task("eat_apple"))
    task_thread.start()
    task_thread.join()
    (pid,) = workers()
    time.sleep(0.3)
    assert alive(pid)
    assert isinstance(FastDownward().plan(load_task("eat_apple")), Plan)
    assert workers() == [pid]


def test_a_forked_child_starts_its_own_workers() -> None:
    task = load_task("eat_apple")
    planner = FastDownward()
    assert isinstance(planner.plan(task), Plan)
    pid = os.fork()
    if pid == 0:
        ok = isinstance(planner.plan(task), Plan)
        processes.WORKERS.end()
        os._exit(0 if ok else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 0
    assert isinstance(planner.plan(task), Plan)


def test_closing_twice_and_planning_again() -> None:
    task = load_task("eat_apple")
    planner = FastDownward()
    assert isinstance(planner.plan(task), Plan)
    planner.close()
    planner.close()
    assert workers() == []
    assert isinstance(planner.plan(task), Plan)


def test_the_translator_is_never_imported_here() -> None:
    script = (
        "import sys\n"
        "from tpvqa.pddl import load_task\n"
        "from tpvqa.planning.fast_downward import FastDownward\n"
        "FastDownward().plan(load_task('eat_apple'))\n"
        "loaded = [n for n in sys.modules if n.split('.')[0] in "
        "('fast_downward', 'up_fast_downward', 'unified_planning')]\n"
        "sys.exit(str(loaded) if loaded else 0)\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
