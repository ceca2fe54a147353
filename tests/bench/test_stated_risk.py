"""Cells that state a risk: learnt on trials of other seeds, and held on these."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from tpvqa.bench.cell import Cell
from tpvqa.bench.engine import Bench, run_bench
from tpvqa.bench.ledger import ROWS, SETTINGS, Ledger
from tpvqa.bench.own_task import OwnTask, own_tasks
from tpvqa.bench.stated_risk import FOLDER, OTHER_SEEDS, learnt
from tpvqa.config import TrialConfig
from tpvqa.errors import BenchError, PluginError, WriteError

DRAWER = Path(__file__).parents[1] / "fixtures" / "drawer"
HASTY = "belief:failure=3:question=0.4"
"""Asks little, and is often wrong."""
RISK = 0.05
SEED = 5
RISK_TRIALS, EPISODES = 19, 20


@pytest.fixture(scope="module")
def own() -> dict[str, OwnTask]:
    return own_tasks([DRAWER])


def cell_of(own: dict[str, OwnTask], monitor: str, condition: str = "") -> Cell:
    return Cell(next(iter(own)), monitor, "oracle:0.8", "symbolic", condition)


@pytest.fixture(scope="module")
def ran(own: dict[str, OwnTask], tmp_path_factory: pytest.TempPathFactory) -> tuple[Ledger, Bench]:
    cells = [cell_of(own, HASTY), cell_of(own, f"{HASTY}:risk={RISK}")]
    bench = Bench(
        wanted=dict.fromkeys(cells, EPISODES),
        common=TrialConfig(seed=SEED),
        own=own,
        risk_trials=RISK_TRIALS,
    )
    return run_bench(bench, tmp_path_factory.mktemp("bench")), bench


def test_the_risk_is_held_on_other_seeds(ran: tuple[Ledger, Bench]) -> None:
    ledger, bench = ran
    free, stated = (ledger.of(cell, EPISODES) for cell in bench.wanted)
    assert sum(row.believed_goal and not row.reached for row in free) > RISK * EPISODES
    assert sum(row.believed_goal and not row.reached for row in stated) <= RISK * EPISODES
    assert any(row.completed for row in stated)


def test_who_states_a_risk_does_the_same_until_it_ends(ran: tuple[Ledger, Bench]) -> None:
    ledger, bench = ran
    free, stated = (ledger.of(cell, EPISODES) for cell in bench.wanted)
    folder = ledger.folder / FOLDER
    told = Ledger(folder, json.loads((folder / SETTINGS).read_text()))
    away = told.of(free[0].cell, RISK_TRIALS)
    told.close()
    assert {row.seed for row in away} == {SEED + OTHER_SEEDS}
    bound = learnt(away).bound(RISK)
    assert bound.trials == RISK_TRIALS
    for without, row in zip(free, stated, strict=True):
        assert (row.goal, row.actions, row.reached) == (
            without.goal,
            without.actions,
            without.reached,
        )
        assert row.questions == without.questions
        says = without.believed_goal and bound.allows(without.goal or 0.0)
        assert row.believed_goal == says
        assert row.because == (without.because if says else "gave up")
    assert {row.believed_goal for row in stated} == {True, False}


def test_a_bench_goes_on_and_runs_nothing_twice(ran: tuple[Ledger, Bench]) -> None:
    ledger, bench = ran
    before = (ledger.folder / FOLDER / ROWS).read_text()
    more = replace(bench, wanted=dict.fromkeys(bench.wanted, EPISODES + 1))
    told: list[tuple[int, int]] = []
    run_bench(more, ledger.folder, progress=lambda done, total: told.append((done, total)))
    assert (ledger.folder / FOLDER / ROWS).read_text() == before
    assert told[0] == (RISK_TRIALS, RISK_TRIALS + 2 * EPISODES + 2)
    other = replace(more, risk_trials=RISK_TRIALS + 1)
    with pytest.raises(BenchError, match="trials of a risk 19 there, 20 here"):
        run_bench(other, ledger.folder)


@pytest.mark.parametrize(
    ("monitor", "condition", "trials", "said"),
    [
        ("belief:risk=.02", "", 48, "at least 49 trials.*--risk-trials 49"),
        ("belief:risk=.05", "carried=5", 19, "Leave out carried= or risk="),
    ],
)
def test_what_cannot_be_stated_is_told_before_anything_runs(
    own: dict[str, OwnTask], tmp_path: Path, monitor: str, condition: str, trials: int, said: str
) -> None:
    cell = cell_of(own, monitor, condition)
    bench = Bench(wanted={cell: 2}, own=own, risk_trials=trials)
    with pytest.raises(BenchError, match=said):
        run_bench(bench, tmp_path / "bench")
    assert not (tmp_path / "bench").exists()


def test_a_link_in_the_place_of_their_folder_is_not_followed(
    own: dict[str, OwnTask], tmp_path: Path
) -> None:
    folder, elsewhere = tmp_path / "bench", tmp_path / "elsewhere"
    folder.mkdir()
    elsewhere.mkdir()
    (folder / FOLDER).symlink_to(elsewhere)
    cells = {cell_of(own, "belief:risk=.05"): 1}
    with pytest.raises(WriteError, match="risk is a link"):
        run_bench(Bench(wanted=cells, own=own, risk_trials=RISK_TRIALS), folder)
    assert not any(elsewhere.iterdir())


@pytest.mark.parametrize("risk", ["2", "0", "much", ""])
def test_a_risk_that_is_none(own: dict[str, OwnTask], tmp_path: Path, risk: str) -> None:
    bench = Bench(wanted={cell_of(own, f"belief:risk={risk}"): 2}, own=own)
    with pytest.raises(PluginError, match=r"a risk lies between 0 and 1; write belief:risk=\.02"):
        run_bench(bench, tmp_path / "bench")
