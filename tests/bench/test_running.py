"""Episodes of a bench: common random numbers, any number of workers, kills, errors."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from tpvqa.bench import dask_workers
from tpvqa.bench.cell import Cell
from tpvqa.bench.ledger import ROWS, Ledger
from tpvqa.bench.schedule import run_all
from tpvqa.bench.stage import stage
from tpvqa.config import TrialConfig
from tpvqa.errors import BenchError
from tpvqa_experiments.paper import PLAIN, STRICT, PaperBench

TPVQA = [sys.executable, "-c", "from tpvqa.cli import main; main()"]
CELLS = [Cell("clean_dishes", m, "oracle:0.8", "symbolic") for m in ("tpvqa", "tp", "palmevqa")]


def rows_of(folder: Path) -> dict[tuple[str, str, str, int], dict[str, Any]]:
    """All whole rows, without how long they took; a kill may have torn the last one."""
    found = {}
    for line in (folder / ROWS).read_text(encoding="utf-8").splitlines(keepends=True):
        if not line.endswith("\n"):
            continue
        values = json.loads(line)
        values.pop("seconds")
        key = (values["task"], values["monitor"], values["vlm"], values["episode"])
        assert key not in found, f"{key} was run twice"
        found[key] = values
    return found


def run(folder: Path, episodes: int, *, workers: int) -> None:
    ledger = Ledger(folder, {})
    run_all(ledger, dict.fromkeys(CELLS, episodes), TrialConfig(seed=3), workers=workers)
    ledger.close()


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("alone")
    run(folder, 60, workers=1)
    return folder


@pytest.mark.slow
def test_the_figures_do_not_depend_on_the_workers(alone: Path, tmp_path: Path) -> None:
    run(tmp_path, 60, workers=2)
    assert rows_of(tmp_path) == rows_of(alone)


@pytest.mark.slow
def test_a_worker_killed_in_the_middle_changes_nothing(alone: Path, tmp_path: Path) -> None:
    killed: list[int] = []

    def kill_one(_: int) -> None:
        if not killed:
            workers = subprocess.run(
                ["pgrep", "-P", str(os.getpid()), "-f", "spawn_main"],
                capture_output=True,
                text=True,
                check=False,
            ).stdout.split()
            killed.append(int(workers[0]))
            os.kill(killed[0], signal.SIGKILL)

    ledger = Ledger(tmp_path, {})
    run_all(ledger, dict.fromkeys(CELLS, 60), TrialConfig(seed=3), workers=2, done=kill_one)
    ledger.close()
    assert killed
    assert rows_of(tmp_path) == rows_of(alone)


@pytest.mark.slow
def test_a_scheduler_by_its_address(alone: Path, tmp_path: Path) -> None:
    from distributed import LocalCluster

    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
        ledger = Ledger(tmp_path, {})
        run_all(
            ledger,
            dict.fromkeys(CELLS, 60),
            TrialConfig(seed=3),
            scheduler=cluster.scheduler_address,
        )
        ledger.close()
    assert rows_of(tmp_path) == rows_of(alone)


def test_a_scheduler_that_is_not_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dask_workers, "REACH", 1.0)
    ledger = Ledger(tmp_path, {})
    with pytest.raises(BenchError, match="cannot be reached"):
        run_all(ledger, {CELLS[0]: 1}, TrialConfig(), scheduler="tcp://127.0.0.1:9")
    ledger.close()


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (["--monitors", "tpvq"], "Did you mean 'tpvqa'"),
        (["--tasks", "clean_dish"], "Did you mean 'clean_dishes'"),
        (["--vlm", "oracel:0.8"], "Did you mean 'oracle'"),
    ],
)
def test_what_is_not_there_is_said_before_anything_runs(
    option: list[str], message: str, tmp_path: Path
) -> None:
    command = [*TPVQA, "bench", "paper", *option, "--out", str(tmp_path / "b")]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 2
    assert message in result.stderr
    assert "Traceback" not in result.stderr
    assert not (tmp_path / "b").exists()


@pytest.mark.slow
def test_the_command_killed_in_the_middle_goes_on(tmp_path: Path) -> None:
    settings = ["bench", "paper", "--tasks", "clean_dishes", "--vlm", "oracle:0.8", "--json"]
    settings += ["--episodes", "60", "--curve", "0", "--workers", "1"]
    settings += ["--monitors", "tpvqa,effectvqa,tp,palmevqa,successvqa"]
    folder = tmp_path / "killed"
    process = subprocess.Popen(
        [*TPVQA, *settings, "--out", folder], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    while process.poll() is None and not (
        (folder / ROWS).exists() and (folder / ROWS).stat().st_size > 10_000
    ):
        time.sleep(0.005)
    process.kill()
    process.wait()
    before = rows_of(folder)
    result = subprocess.run(
        [*TPVQA, *settings, "--out", folder], capture_output=True, text=True, check=True
    )
    after = rows_of(folder)
    assert before.items() <= after.items()
    table = json.loads(result.stdout)
    assert [each["episodes"] for each in table] == [60] * 5
    wanted = "task monitor vlm episodes completed completion_rate ci_low ci_high questions looks"
    wanted += " actions repeats replans ended_before_first_action errors"
    assert set(wanted.split()) <= set(table[0])
    for name in ("summary", "episodes", "answers", "decisions", "limits"):
        for ending in ("csv", "parquet"):
            assert (folder / f"{name}.{ending}").stat().st_size > 200
    assert (folder / "report.html").stat().st_size > 500


def test_every_monitor_meets_the_same_faults() -> None:
    here = stage("clean_dishes")
    common = TrialConfig(seed=5)
    perfect = "oracle"
    for episode in range(20):
        tp = here.run(Cell("clean_dishes", "tp", perfect, "symbolic"), common, episode)
        tpvqa = here.run(Cell("clean_dishes", "tpvqa", perfect, "symbolic"), common, episode)
        if not tp.failures:  # nothing went wrong, so there was nothing to notice
            assert tp.completed
            assert (tpvqa.completed, tpvqa.failures, tpvqa.repeats) == (True, 0, 0)
        else:
            assert tpvqa.failures


def test_answers_and_decisions_are_judged_beside_the_truth() -> None:
    cell = Cell("eat_apple", "tpvqa", "oracle", "symbolic")
    rows = [stage("eat_apple").run(cell, TrialConfig(), episode) for episode in range(30)]
    for row in rows:
        for key in row.answers:
            _, _, truth, reply, p_yes = key.split("|")
            assert (reply == "yes") == (truth == "1")
            assert float(p_yes) == (truth == "1")
        assert sum(row.answers.values()) == row.questions
        after = {k: n for k, n in row.decisions.items() if k.startswith("after")}
        assert set(after) <= {"after|1|1", "after|0|0"}
        assert row.wasted == 0
    assert any(row.failures for row in rows)


def test_one_broken_episode_is_recorded_and_the_rest_go_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from tpvqa.vlm.oracle import Oracle

    asked = Oracle.ask

    def break_in_episode_2(self: Oracle, *arguments: Any) -> Any:
        if self._episode == 2:
            raise RuntimeError("the VLM fell over")
        return asked(self, *arguments)

    monkeypatch.setattr(Oracle, "ask", break_in_episode_2)
    here = stage("clean_dishes")
    rows = [here.run(CELLS[0], TrialConfig(), episode) for episode in range(4)]
    assert [bool(row.error) for row in rows] == [False, False, True, False]
    assert "the VLM fell over" in rows[2].error
    assert (rows[2].completed, rows[2].ending) == (False, "error")


def test_an_episode_that_no_row_can_tell_is_an_error_and_the_rest_go_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told = iter([7.0, None])
    monkeypatch.setattr("tpvqa.bench.stage.goal_probability_of", lambda monitor: next(told))
    here = stage("clean_dishes")
    broken, whole = (here.run(CELLS[1], TrialConfig(seed=3), number) for number in range(2))
    assert "goal" in broken.error
    assert not whole.error


def test_cells_that_a_recording_cannot_fill_stay_empty() -> None:
    bench = PaperBench(tasks=["clean_dishes"], vlms=["recorded:internvl3-8b", "paper-table"])
    cells = [(cell.vlm, cell.monitor) for cell in bench.cells() if not cell.condition]
    assert [monitor for vlm, monitor in cells if vlm.startswith("recorded")] == [
        "tpvqa",
        "effectvqa",
        "tp",
        *STRICT,
        *PLAIN,
    ]
    assert len([vlm for vlm, _ in cells if vlm == "paper-table"]) == 9


def test_an_interrupt_ends_the_bench_and_costs_the_one_episode(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from tpvqa.vlm.oracle import Oracle

    asked = Oracle.ask

    def interrupt_episode_150(self: Oracle, *arguments: Any) -> Any:
        if self._episode == 150:
            raise KeyboardInterrupt
        return asked(self, *arguments)

    monkeypatch.setattr(Oracle, "ask", interrupt_episode_150)
    ledger = Ledger(tmp_path, {})
    with pytest.raises(KeyboardInterrupt):
        run_all(ledger, {CELLS[0]: 300}, TrialConfig())
    ledger.close()
    rows = [values for _, values in sorted(rows_of(tmp_path).items())]
    assert [values["episode"] for values in rows] == list(range(150))
    assert not any(values["because"] == "cancelled" for values in rows)


def test_a_cell_may_ask_in_the_papers_wording() -> None:
    asked = {}
    for condition in ("", "wording=paper"):
        cell = Cell("clean_dishes", "successvqa", "oracle", "symbolic", condition)
        with stage(cell.task).trial(cell.config(TrialConfig(), 0)) as trial:
            wash = trial.task.action("wash", ("plate", "sink", "left"))
            asked[condition] = trial.book.successful(wash).text
    assert asked == {
        "": "Was wash the plate successful?",
        "wording=paper": "Was wash plate successful?",
    }
