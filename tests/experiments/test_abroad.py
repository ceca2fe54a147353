"""The bench abroad: domains that nobody here wrote, and the limit beside the monitors."""

import importlib.util
import json
import subprocess
import sys
import zipfile
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from types import ModuleType

import pytest

from tpvqa.bench.cell import Cell
from tpvqa.bench.stage import stage
from tpvqa.config import TrialConfig
from tpvqa.errors import BenchError
from tpvqa.pddl import load_task
from tpvqa_experiments.abroad import AbroadBench, Part, run_abroad_bench
from tpvqa_experiments.abroad.bench import blocks_in, sensed, tasks_in
from tpvqa_experiments.abroad.parts import REPEATING, SEEING, Extent
from tpvqa_experiments.abroad.seeing import seeing
from tpvqa_experiments.abroad.tables import lines
from tpvqa_experiments.belief.calibrations import Source, calibrations

ROOT = Path(__file__).parents[2]
DOMAIN = """(define (domain lift) (:requirements :typing) (:types block)
  (:predicates (down ?b - block) (up ?b - block) (raise ?b - block))
  ; (:actions raise)
  (:action raise :parameters (?b - block) :precondition (and (raise ?b) (down ?b))
    :effect (and (up ?b) (not (down ?b)))))"""
PROBLEM = """(define (problem some) (:domain lift) (:objects a b c d - block)
  (:goal (and (up a) (up b) (up c) (up d)))
  (:init (down a) (down b) (down c) (down d) (raise a)))"""


def _tool() -> ModuleType:
    path = ROOT / "experiments/tools/others_domains.py"
    spec = importlib.util.spec_from_file_location("others_domains", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_domains_of_others_lose_what_only_their_library_needs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    tool = _tool()
    wheel = tmp_path / "others.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.writestr("pddlgym/pddl/lift.pddl", DOMAIN)
        archive.writestr("pddlgym/pddl/lift/one.pddl", PROBLEM)
        archive.writestr("pddlgym/code.py", "raise SystemExit")
    monkeypatch.setattr(tool, "SHA256", sha256(wheel.read_bytes()).hexdigest())
    monkeypatch.setattr(tool, "KINDS", {"lifting": "lift"})
    out = tmp_path / "others"
    named = ["--wheel", str(wheel), "--out", str(out), "--kinds", "lifting"]
    monkeypatch.setattr("sys.argv", ["tool", *named])
    tool.main()
    task = load_task(out / "lifting/domain.pddl", out / "lifting/problem.pddl")
    assert "raise" not in task.predicates
    assert len(task.reachable_actions) == 4
    (told,) = json.loads((out / "others.json").read_text())
    assert (told["kind"], told["plan"], told["objects"]) == ("lifting", 4, 4)
    assert "1 domains" in capsys.readouterr().out
    assert list(tasks_in(out)) == ["lifting"]


def test_another_wheel_is_not_taken(tmp_path: Path) -> None:
    wheel = tmp_path / "others.whl"
    wheel.write_bytes(b"something else")
    with pytest.raises(SystemExit, match="is not pddlgym"):
        _tool().pddl_of(wheel)


def test_who_sees_all_needs_an_action_more_for_every_failure() -> None:
    cell = Cell("build_tower", "belief", "oracle:0.8", "symbolic", "limits=none,disturbance=0")
    for episode in range(8):
        row = seeing(stage("build_tower"), cell, TrialConfig(), episode)
        assert row.completed
        assert row.monitor == SEEING
        assert row.actions == row.first_plan + row.failures
        assert row.questions == 0


def test_a_bench_abroad_goes_on_where_it_was_stopped(tmp_path: Path) -> None:
    extent = Extent(tasks=("build_tower",), monitors=("tp", "blind:5"), episodes=3)
    bench = AbroadBench(parts=(Part.SHIPPED,), extent=extent)
    run_abroad_bench(bench, tmp_path)
    before = (tmp_path / "episodes.jsonl").read_text()
    found = run_abroad_bench(bench, tmp_path)[Part.SHIPPED]
    assert (tmp_path / "episodes.jsonl").read_text() == before
    told = {line.monitor: line for line in lines(found)}
    assert list(told) == ["tp", "blind:5", SEEING]
    assert told[SEEING].quotient == 1
    assert told[SEEING].completion.rate == 1
    blind = told["blind:5"].quotient
    assert blind is not None
    assert blind > 1
    assert "| build_tower |" in (tmp_path / "abroad.md").read_text()


def test_published_trials_of_the_bench_abroad_are_not_run_again(tmp_path: Path) -> None:
    own = tasks_in(ROOT / "examples")
    ward = {"medicine_round": own["medicine_round"]}
    extent = Extent(own=ward, monitors=("blind:2",), episodes=2)
    bench = AbroadBench(parts=(Part.OWN,), extent=extent, limit=False)
    once, again, data = (tmp_path / name for name in ("once", "again", "data"))
    before = run_abroad_bench(bench, once)[Part.OWN]
    script = ROOT / "experiments/tools/publish.py"
    told = [sys.executable, str(script), str(once), "--whole", "abroad", "--out", str(data)]
    said = subprocess.run(told, capture_output=True, text=True, check=True).stdout
    assert "2 rows" in said
    after = run_abroad_bench(bench, again, published=data)[Part.OWN]
    assert (again / "episodes.jsonl").read_text() == ""
    assert [replace(each, seconds=None) for each in lines(before)] == list(lines(after))
    # Rows of other files are not taken for those of these.
    changed = {"medicine_round": replace(own["medicine_round"], world="undo: []")}
    with pytest.raises(BenchError, match="say something else"):
        run_abroad_bench(
            replace(bench, extent=replace(extent, own=changed)), tmp_path / "new", published=data
        )


def test_repetition_costs_more_the_oftener_and_nothing_where_sensors_tell(tmp_path: Path) -> None:
    ward = {name: task for name, task in tasks_in(ROOT / "examples").items() if "medicine" in name}
    extent = Extent(own=ward, sensed=sensed(ward), monitors=("tp",), episodes=6)
    bench = AbroadBench(parts=(Part.OWN, Part.SENSED), extent=extent)
    found = run_abroad_bench(bench, tmp_path)
    hidden, told = (
        {line.monitor: line for line in lines(found[part])} for part in (Part.OWN, Part.SENSED)
    )
    assert list(hidden) == ["tp", *REPEATING, SEEING]
    quotients = {name: hidden[name].quotient or 0.0 for name in REPEATING}
    assert 1 < quotients["seeing:2"] < quotients["seeing:5"]
    assert hidden["seeing:5"].completion.rate == 1
    assert [told[name].quotient for name in REPEATING] == [1] * 5  # it sees as much as who sees all


def test_a_part_without_tasks_says_what_to_name(tmp_path: Path) -> None:
    with pytest.raises(BenchError, match="--others"):
        run_abroad_bench(AbroadBench(parts=(Part.OTHERS,)), tmp_path / "out")
    with pytest.raises(BenchError, match=r"world-sensed\.yaml"):
        run_abroad_bench(AbroadBench(parts=(Part.SENSED,)), tmp_path / "out")
    with pytest.raises(BenchError, match="holds no folder"):
        tasks_in(tmp_path)


def test_a_dead_skill_is_counted_and_has_no_limit_beside_it(tmp_path: Path) -> None:
    extent = Extent(tasks=("clean_dishes",), monitors=("blind:5", "belief"), episodes=2)
    found = run_abroad_bench(AbroadBench(parts=(Part.DEAD,), extent=extent), tmp_path)[Part.DEAD]
    told = {(line.condition, line.monitor): line for line in lines(found)}
    assert {monitor for _, monitor in told} == {"blind:5", "belief"}
    assert told["limits=none,dead=wash", "blind:5"].named == 0  # it never says so
    washing = [row for cell, own in found.items() for row in own if "wash" in cell.condition]
    assert all(row.named is None for row in washing if row.monitor == "blind:5")
    assert all(row.named for row in washing if row.monitor == "belief")
    assert not any(row.misnamed for row in washing)
    assert told["limits=none,dead=wash", "blind:5"].completion.rate == 0
    rows = [row for own in found.values() for row in own]
    assert {row.dead for row in rows if row.monitor == "blind:5"} == {5}
    assert "dead skill named within 8 tries" in (tmp_path / "abroad.md").read_text()


def test_who_sees_all_knows_where_things_are_at_first(tmp_path: Path) -> None:
    extent = Extent(tasks=("eat_apple",), monitors=("tp",), episodes=6)
    found = run_abroad_bench(AbroadBench(parts=(Part.ELSEWHERE,), extent=extent), tmp_path)
    told = {line.monitor: line for line in lines(found[Part.ELSEWHERE])}
    assert told[SEEING].completion.rate == 1
    assert told["tp"].completion.rate < 1


def test_every_part_has_its_cells() -> None:
    ours = tasks_in(ROOT / "examples")
    blocks = blocks_in(ROOT / "experiments/problems")
    extent = Extent(
        others=ours, own=ours, sensed=sensed(ours), blocks=blocks, monitors=("belief",), episodes=7
    )
    assert list(blocks) == ["blocks_5", "blocks_8"]
    told = {part: [cell for cell, _ in extent.cells(part)] for part in Part}
    assert {part: len(cells) for part, cells in told.items()} == {
        Part.OTHERS: 3,
        Part.OWN: 3,
        Part.SENSED: 3,
        Part.ELSEWHERE: 6,
        Part.NOTHING: 5,
        Part.DEAD: 8,
        Part.FAILURE: 8,
        Part.SHIPPED: 4,
    }
    assert all(
        cell.condition.startswith("limits=none") for cells in told.values() for cell in cells
    )
    assert {count for _, count in extent.cells(Part.OTHERS)} == {100}


def test_recorded_vlms_are_calibrated_on_ones_own_tasks(tmp_path: Path) -> None:
    (name, task), *_ = tasks_in(ROOT / "examples").items()
    source = Source(name, "recorded:gemma-3-12b:0:lasting", "symbolic")
    told = calibrations(tmp_path, [source], TrialConfig(), 2, own={name: task})[source]
    assert told.rows > 100


def test_only_others_domains_are_run_uncalibrated(tmp_path: Path) -> None:
    (name, task), *_ = tasks_in(ROOT / "examples").items()
    for extent, calibrated in (
        (Extent(others={name: task}, monitors=("belief",), others_episodes=1), 0),
        (Extent(own={name: task}, monitors=("belief",), episodes=1), 1),
    ):
        bench = AbroadBench(extent=extent, calibration_episodes=2, limit=False)
        cells = list(bench.extent.cells(Part.OTHERS)) + list(bench.extent.cells(Part.OWN))
        told = bench.declared(tmp_path, lambda done, total: None).calibrations(
            [cell for cell, _ in cells]
        )
        assert len(told) == calibrated


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--vlms", ""], "--vlms names none"),
        (["--tasks", "clean_dish"], "Did you mean 'clean_dishes'"),
        (["--more", "failure=2", "--only-tables"], "rates of faults from 0 to 1"),
        (["--seed", "99999999999999999999"], "--seed"),
    ],
)
def test_what_makes_no_sense_is_said_before_anything_is_made(
    words: list[str], says: str, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    program = [sys.executable, "-c", "from tpvqa.cli import main; main()", "bench", "abroad"]
    command = [*program, "--parts", "shipped", *words, "--out", str(out)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (result.returncode, "Traceback" in result.stderr) == (2, False)
    assert says in result.stderr.replace("\n", " ")
    assert not out.exists()
