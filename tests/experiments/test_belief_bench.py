"""The belief bench: what it runs and keeps, and what it concludes from made-up episodes."""

import json
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.bench.cell import Cell
from tpvqa.bench.labelled import gather
from tpvqa.bench.ledger import ROWS, Ledger
from tpvqa.bench.published import write_published
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.schedule import batches
from tpvqa.bench.stage import run_each
from tpvqa.config import SimulationConfig, TrialConfig
from tpvqa.errors import BenchError, CalibrationError, WriteError
from tpvqa.questions import Way
from tpvqa.vlm import Reply
from tpvqa_experiments.belief import BeliefBench, BeliefResults, Part, run_belief_bench
from tpvqa_experiments.belief.calibrations import (
    OTHER_SEEDS,
    Source,
    by_replies,
    calibrations,
    source_of,
)
from tpvqa_experiments.belief.check import Check
from tpvqa_experiments.belief.comparison import Lies, against, together
from tpvqa_experiments.belief.learning import BLOCK, after_learning, blocks, episodes_until_learned
from tpvqa_experiments.belief.markdown import results_markdown, targets_markdown
from tpvqa_experiments.belief.parts import (
    CHAIN,
    KNOWING,
    LEARNING,
    RIVALS,
    VOTES,
    WRONG_VLM,
    Extent,
)
from tpvqa_experiments.belief.resampling import difference, ratio
from tpvqa_experiments.belief.targets import targets
from tpvqa_experiments.paper import PAPER

CELL = Cell("clean_dishes", "belief", "oracle:0.8", "symbolic")
SMALL = Extent(
    tasks=("clean_dishes",), accuracies=(0.9,), rhos=(0.0,), prices=(10.0,), episodes=2, curve=2
)


def test_recorded_answers_count_once_however_often_trials_draw_them(tmp_path: Path) -> None:
    source = Source("clean_dishes", "recorded:gpt-4.1-nano:0", "symbolic")
    few, many = (
        calibrations(tmp_path / str(n), [source], TrialConfig(seed=0), n)[source] for n in (3, 12)
    )
    near = few.group_of(Way.EFFECT, "near")
    assert near.rows == 85 + 31  # what half 0 of the problems has of "reachable"
    assert near == many.group_of(Way.EFFECT, "near")
    assert few.rows == many.rows


def rows(
    completed: Sequence[bool], questions: int = 10, cell: Cell = CELL, actions: int = 5
) -> list[EpisodeRow]:
    """Made-up episodes of a cell."""
    return [
        EpisodeRow(
            task=cell.task,
            monitor=cell.monitor,
            vlm=cell.vlm,
            world=cell.world,
            condition=cell.condition,
            seed=0,
            episode=number,
            completed=done,
            believed_goal=done,
            because="goal" if done else "limit of actions",
            questions=questions,
            actions=actions,
        )
        for number, done in enumerate(completed)
    ]


def first(completed: int, count: int, **kwargs: Any) -> list[EpisodeRow]:
    """Episodes of which the first ones are completed."""
    return rows([number < completed for number in range(count)], **kwargs)


def lines_of(folder: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in (folder / ROWS).read_text().splitlines()]


def bench(episodes: int = 2, **kwargs: Any) -> BeliefBench:
    extent = replace(SMALL, episodes=episodes, rivals=episodes)
    return BeliefBench(parts=[Part.GRID], extent=extent, calibration_episodes=3, **kwargs)


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which two episodes of a cell were run, then a third one."""
    folder = tmp_path_factory.mktemp("bench")
    run_belief_bench(bench(), folder)
    (folder / "before.jsonl").write_bytes((folder / ROWS).read_bytes())
    learnt = {path: path.stat().st_mtime_ns for path in (folder / "calibrations").iterdir()}
    run_belief_bench(bench(3), folder)
    assert learnt == {p: p.stat().st_mtime_ns for p in (folder / "calibrations").iterdir()}
    return folder


def test_it_runs_every_monitor_and_goes_on_where_it_stopped(ran: Path) -> None:
    found = lines_of(ran)
    assert not [row["error"] for row in found if row["error"]]
    monitors = {row["monitor"] for row in found if row["episode"] == 2}
    assert monitors == {"belief", *RIVALS}  # the points of the curve have episodes enough
    assert {row["monitor"] for row in found} == {*monitors, "belief:question=10"}
    assert (ran / ROWS).read_bytes().startswith((ran / "before.jsonl").read_bytes())
    assert len(found) == 3 * 11 + 2
    assert [path.name for path in (ran / "calibrations").iterdir()] == [
        "oracle-0.9_clean_dishes_symbolic.json"
    ]


def test_it_writes_tables_figures_and_targets(ran: Path) -> None:
    told = {path.name for path in ran.iterdir()}
    assert {"summary.csv", "episodes.parquet", "targets.md", "targets.json", "belief.md"} <= told
    assert (ran / "figures" / "curves_rho_0.svg").stat().st_size > 10_000
    assert "| oracle:0.9 | clean_dishes |" in (ran / "belief.md").read_text()
    curve = next(
        each
        for each in json.loads((ran / "targets.json").read_text())
        if each["what"] == "curve on or above every vote, of 1 cells"
    )
    assert curve["measured"] in (0.0, 1.0)


def test_tables_can_be_written_without_running(ran: Path, tmp_path: Path) -> None:
    for name in (ROWS, "bench.json"):
        (tmp_path / name).write_bytes((ran / name).read_bytes())
    results, _ = run_belief_bench(bench(50), tmp_path, only_tables=True)
    assert len(lines_of(tmp_path)) == len(lines_of(ran))
    assert not (tmp_path / "calibrations").exists()
    assert {len(own) for own in results.rows.values()} == {2, 3}


def test_published_trials_make_the_same_tables_and_are_not_run_again(
    ran: Path, tmp_path: Path
) -> None:
    for name in (ROWS, "bench.json"):
        shutil.copy(ran / name, tmp_path / name)
    script = Path(__file__).parents[2] / "experiments/tools/publish.py"
    told = [sys.executable, str(script), str(tmp_path), "--out", str(tmp_path / "data")]
    said = subprocess.run(told, capture_output=True, text=True, check=True).stdout
    assert "35 rows" in said
    again = tmp_path / "again"
    run_belief_bench(bench(3), again, published=tmp_path / "data")
    assert (again / ROWS).read_bytes() == b""
    # What is published already stays where a folder that went on from it is packed.
    told[2] = str(again)
    assert "35 rows" in subprocess.run(told, capture_output=True, text=True, check=True).stdout
    told[2] = str(tmp_path / "nowhere")
    missing = subprocess.run(told, capture_output=True, text=True, check=False)
    assert (missing.returncode, missing.stdout) == (1, "")
    assert "holds no bench" in missing.stderr
    assert not (tmp_path / "nowhere").exists()
    for name in ("targets.md", "belief.md"):
        assert (again / name).read_text() == (ran / name).read_text()


def test_a_bench_goes_on_from_published_rows_with_the_calibrations_that_lie_beside_them(
    ran: Path, tmp_path: Path
) -> None:
    script = Path(__file__).parents[2] / "experiments/tools/publish.py"
    told = [sys.executable, str(script), str(ran), "--out", str(tmp_path / "data")]
    subprocess.run(told, capture_output=True, check=True)
    (kept,) = (tmp_path / "data" / "calibrations").iterdir()
    assert kept.read_bytes() == (ran / "calibrations" / kept.name).read_bytes()
    run_belief_bench(bench(4, monitors=("belief",)), tmp_path / "on", published=tmp_path / "data")
    assert [row["episode"] for row in lines_of(tmp_path / "on")] == [3]
    assert not (tmp_path / "on" / "calibrations").exists()
    changed = Calibration.load(kept).model_copy(update={"rows": 1})
    changed.save(kept)
    said = subprocess.run(told, capture_output=True, text=True, check=False)
    assert said.returncode == 1
    assert "says something else" in said.stderr
    assert Calibration.load(kept) == changed


def test_other_settings_need_another_folder(ran: Path) -> None:
    with pytest.raises(BenchError, match=r"other settings \(seed 0 there, 1 here\)"):
        run_belief_bench(bench(common=PAPER.but(seed=1)), ran)


def test_calibrations_are_learnt_under_another_seed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seeds = []

    def noted(cell: Cell, common: TrialConfig, episodes: Any, **more: Any) -> Any:
        seeds.append(common.seed)
        return gather(cell, common, episodes, **more)

    monkeypatch.setattr("tpvqa_experiments.belief.calibrations.gather", noted)
    source = Source("clean_dishes", "oracle:0.7", "symbolic")
    found = calibrations(tmp_path, [source], TrialConfig(seed=5), 3)
    assert seeds == [5 + OTHER_SEEDS]
    again = calibrations(tmp_path, [source], TrialConfig(seed=5), 3)
    assert seeds == [5 + OTHER_SEEDS]
    assert again == found
    (tmp_path / source.file).write_text("{}")
    with pytest.raises(CalibrationError, match=source.file):
        calibrations(tmp_path, [source], TrialConfig(seed=5), 3)


def test_workers_learn_the_same_calibrations(tmp_path: Path) -> None:
    sources = [Source("build_tower", vlm, "symbolic") for vlm in ("oracle:0.7", "oracle:0.9")]
    counts: list[tuple[int, int]] = []
    alone, together = (
        calibrations(
            tmp_path / str(workers),
            sources,
            TrialConfig(seed=5),
            2,
            workers=workers,
            done=lambda done, total: counts.append((done, total)),
        )
        for workers in (1, 2)
    )
    assert alone == together
    assert counts == [(0, 2), (1, 2), (2, 2)] * 2
    for source in sources:
        files = [tmp_path / str(workers) / source.file for workers in (1, 2)]
        assert files[0].read_bytes() == files[1].read_bytes()


def test_recorded_vlms_are_calibrated_on_the_other_half() -> None:
    cell = Cell("eat_apple", "belief", "recorded:gemma-3-12b:1:fresh", "symbolic")
    assert source_of(cell).vlm == "recorded:gemma-3-12b:0:fresh"
    seen = Cell("eat_apple", "belief", "embedded", "images")
    assert source_of(seen).world == "images"
    assert source_of(seen, "kitchen").world == "kitchen"
    extent = Extent()
    places = {
        (cell.task == "build_tower", cell.vlm.endswith(":1:fresh"))
        for cell, _ in extent.cells(Part.RECORDED)
    }
    assert places == {(True, True), (False, True)}


def test_a_condition_sets_the_true_rates_and_is_kept(tmp_path: Path) -> None:
    cell = replace(CELL, monitor="tp", condition="failure=1,spontaneous=0.05")
    config = cell.config(TrialConfig(), 7)
    assert config.simulation == SimulationConfig(failure=1.0, spontaneous=0.05)
    (row,) = run_each(cell, TrialConfig(), (0,))
    assert row.completed is False
    with_ledger = Ledger(tmp_path, {})
    with_ledger.add([row])
    with_ledger.close()
    ledger = Ledger(tmp_path, {})
    assert ledger.missing(cell, 1) == []
    assert ledger.missing(replace(cell, condition=""), 1) == [0]
    ledger.close()


@pytest.mark.parametrize("name", ["calibrations", "figures"])
def test_links_in_the_places_of_its_folders_are_not_followed(tmp_path: Path, name: str) -> None:
    folder, elsewhere = tmp_path / "bench", tmp_path / "elsewhere"
    folder.mkdir()
    elsewhere.mkdir()
    (folder / name).symlink_to(elsewhere)
    with pytest.raises(WriteError, match=f"{name} is a link"):
        run_belief_bench(bench(episodes=1), folder, only_tables=name == "figures")
    assert not any(elsewhere.iterdir())


def test_what_is_learned_is_carried_through_a_run_of_episodes_and_no_further() -> None:
    calibration = Calibration.default()
    common = TrialConfig()
    plain = replace(CELL, vlm="oracle:0.7")
    alone = [row.trust for row in run_each(plain, common, tuple(range(4)), calibration)]
    cell = replace(plain, condition="carried=2")
    carrying = run_each(cell, common, tuple(range(4)), calibration)
    carried = [row.trust for row in carrying]
    assert (carried[0], carried[2]) == (alone[0], alone[2])
    assert carried[1] != alone[1]
    assert carried[3] != alone[3]
    (row,) = run_each(replace(CELL, monitor="tpvqa"), common, (0,))
    assert row.trust is None


def test_a_run_of_episodes_is_one_batch_and_is_begun_anew(tmp_path: Path) -> None:
    cell = replace(CELL, condition="carried=3")
    ledger = Ledger(tmp_path, {})
    ledger.add(first(5, 5, cell=cell))
    (missing,) = batches(ledger, {cell: 6})
    assert missing.episodes == (3, 4, 5)
    ledger.close()


def test_what_is_wrongly_believed_is_another_vlms_calibration_without_how_sure_it_is() -> None:
    cell = replace(CELL, vlm="oracle:0.7", condition="believed=oracle:0.9,carried=30")
    assert source_of(cell).vlm == "oracle:0.9"
    default = Calibration.default()
    assert default.group_of(Way.EFFECT, "on").curve is not None
    blind = by_replies(default)
    assert blind.group_of(Way.EFFECT, "on").curve is None
    assert blind.whole.log_ratio(Reply.YES, 0.99) == blind.whole.log_ratio(Reply.YES, 0.51) > 1


@pytest.mark.parametrize("condition", ["failure=x", "failures=0.1", "failure", "failure=0.1,x"])
def test_a_condition_that_is_not_understood(condition: str) -> None:
    with pytest.raises(BenchError, match="is not understood"):
        replace(CELL, condition=condition).config(TrialConfig(), 0)


def test_a_number_of_episodes_that_is_not_understood() -> None:
    with pytest.raises(BenchError, match="carried=EPISODES"):
        list(run_each(replace(CELL, condition="carried=x"), TrialConfig(), (0,)))


def test_every_grid_cell_has_every_rival_and_the_curve() -> None:
    cells = [cell for cell, _ in Extent().cells(Part.GRID)]
    assert len(set(cells)) == len(cells) == 5 * 2 * 3 * (1 + 10 + 8)
    assert set(VOTES) < {cell.monitor for cell in cells}


def test_a_wrong_model_is_run_beside_the_right_one() -> None:
    found = {(cell.condition, cell.monitor) for cell, _ in Extent().cells(Part.WRONG_MODEL)}
    assert ("failure=0.4", "belief") in found
    assert ("failure=0.4", "belief:failure_rate=0.4") in found
    assert ("spontaneous=0.05", "belief:spontaneous_rate=0.05") in found


class TestDifferences:
    def test_the_same_episodes_differ_by_nothing(self) -> None:
        found = difference(first(500, 1000), first(500, 1000))
        assert found.value == 0
        assert -0.003 < found.low < 0 < found.high < 0.003

    def test_what_the_cells_have_in_common_cancels(self) -> None:
        own, other = first(520, 1000), first(500, 1000)
        assert difference(own, other).low > 0
        shuffled = rows([number >= 500 for number in range(1000)])
        assert difference(own, shuffled).low < 0

    def test_four_episodes_of_a_thousand_tell_nothing_forty_do(self) -> None:
        assert difference(first(996, 1000), first(1000, 1000)).high > 0
        assert difference(first(960, 1000), first(1000, 1000)).high < 0

    def test_only_common_episodes_are_compared(self) -> None:
        assert difference(first(100, 1000), first(100, 100)).value == 0

    def test_ratios(self) -> None:
        found = ratio(first(5, 10, questions=6), first(5, 10, questions=12), "questions")
        assert (found.value, found.low, found.high) == (0.5, 0.5, 0.5)
        assert ratio(first(5, 10), first(5, 10, questions=0), "questions").value == float("inf")


class TestCurve:
    curve = (first(900, 1000, questions=100), first(0, 300, questions=0))

    def test_it_is_linear_between_its_points(self) -> None:
        found = against(self.curve, first(450, 1000, questions=50))
        assert found.difference is not None
        assert found.difference.value == pytest.approx(0)
        assert found.lies is Lies.ON

    @pytest.mark.parametrize(
        ("completed", "lies"), [(300, Lies.ABOVE), (440, Lies.ON), (600, Lies.BELOW)]
    )
    def test_verdicts(self, completed: int, lies: Lies) -> None:
        assert against(self.curve, first(completed, 1000, questions=50)).lies is lies

    def test_it_is_flat_to_its_right(self) -> None:
        found = against(self.curve, first(800, 1000, questions=500))
        assert found.difference is not None
        assert found.difference.value == pytest.approx(0.1)
        assert found.lies is Lies.ABOVE

    def test_what_asks_less_than_all_of_it_is_not_reached(self) -> None:
        found = against(self.curve[:1], first(100, 1000, questions=50))
        assert (found.lies, found.difference) == (Lies.LEFT, None)

    def test_a_cell_is_as_good_as_its_worst_vote(self) -> None:
        above = against(self.curve, first(300, 1000, questions=50))
        on = against(self.curve, first(450, 1000, questions=50))
        below = against(self.curve, first(600, 1000, questions=50))
        assert together([above, above]) is Lies.ABOVE
        assert together([above, on]) is Lies.ON
        assert together([above, on, below]) is Lies.BELOW


def made_up(**completed: int) -> BeliefResults:
    """A thousand episodes of each monitor on clean_dishes, p = .8."""
    questions = {"belief": 40, "tpvqa": 50, "tpvqa:5": 80}
    cells = {replace(CELL, monitor=name.replace("_", ":")): n for name, n in completed.items()}
    return BeliefResults(
        {},
        {
            cell: first(n, 1000, questions=questions[cell.monitor], cell=cell)
            for cell, n in cells.items()
        },
        {"belief step, 500 facts": 25.0},
    )


CONDITIONS = ("p = 0.8, ρ = 0", "speed", "every cell of the grid")


def check(results: BeliefResults, what: str) -> Check:
    extent = replace(SMALL, accuracies=(0.8,), prices=())
    (found,) = (
        each
        for each in targets(results, extent)
        if each.what == what
        and each.condition in ("p = 0.8, ρ = 0", "speed", "every cell of the grid")
    )
    return found


def learned(*behind: int) -> BeliefResults:
    """Ten robots: in each block of five episodes so many of 50 fewer than of those who know."""

    def robots(condition: str, failed: Sequence[int]) -> tuple[Cell, list[EpisodeRow]]:
        cell = replace(CELL, vlm=WRONG_VLM, condition=condition)
        left = list(failed)
        done = []
        for number in range(CHAIN * 10):
            block = number % CHAIN // BLOCK
            done.append(left[block] <= 0)
            left[block] -= 1
        return cell, rows(done, cell=cell)

    return BeliefResults({}, dict([robots(LEARNING, behind), robots(KNOWING, [0] * 6)]))


class TestLearning:
    def test_blocks_of_episodes_of_all_robots(self) -> None:
        found = blocks(learned(20, 10, 0, 0, 0, 0), CELL.task)
        assert [block.first for block in found] == [0, 5, 10, 15, 20, 25]
        assert [block.learning for block in found] == [0.6, 0.8, 1.0, 1.0, 1.0, 1.0]
        assert {block.knowing for block in found} == {1.0}

    @pytest.mark.parametrize(
        ("behind", "episodes"),
        [
            ((0, 0, 0, 0, 0, 0), 0),
            ((20, 10, 1, 0, 0, 0), 10),  # one of fifty is less than may be lost
            ((20, 0, 10, 0, 0, 0), 15),
            ((0, 0, 0, 0, 0, 5), None),
        ],
    )
    def test_how_fast(self, behind: Sequence[int], episodes: int | None) -> None:
        assert episodes_until_learned(blocks(learned(*behind), CELL.task)) == episodes

    def test_it_counts_what_comes_after_twenty_episodes(self) -> None:
        good = after_learning(learned(50, 50, 50, 50, 0, 0), CELL.task)
        assert good is not None
        assert good.value == 0
        poor = after_learning(learned(0, 0, 0, 0, 20, 20), CELL.task)
        assert poor is not None
        assert poor.value == -0.4
        assert after_learning(BeliefResults({}, {}), CELL.task) is None


class TestTargets:
    @pytest.mark.parametrize(("completed", "reached"), [(1000, True), (950, True), (940, False)])
    def test_a_rate_is_reached_by_the_upper_end_of_its_interval(
        self, completed: int, reached: bool
    ) -> None:
        found = check(made_up(belief=completed), "completion, clean_dishes")
        assert found.measured is not None
        assert found.measured.value == completed / 1000
        assert found.measured.low < found.measured.value <= found.measured.high
        assert found.reached is reached

    def test_questions_and_actions_against_a_vote(self) -> None:
        found = made_up(belief=1000, tpvqa_5=900)
        assert check(found, "questions over tpvqa:5's, clean_dishes").reached is True
        assert check(found, "actions over tpvqa:5's, clean_dishes").reached is False  # the same

    def test_what_was_not_run_is_neither_reached_nor_missed(self) -> None:
        found = check(made_up(belief=1000), "questions over tpvqa:5's, clean_dishes")
        assert (found.measured, found.reached) == (None, None)
        assert check(made_up(), "completion, clean_dishes").reached is None

    def test_the_curve_over_the_votes_of_every_cell(self) -> None:
        clear = made_up(belief=990, tpvqa=800, tpvqa_5=900)
        above = "curve clearly above every vote, of 1 cells"
        assert check(clear, above).reached is True
        on = made_up(belief=990, tpvqa=800, tpvqa_5=990)
        assert check(on, above).reached is False
        assert check(on, "curve on or above every vote, of 1 cells").reached is True
        below = check(made_up(belief=800, tpvqa=950), "curve on or above every vote, of 1 cells")
        assert below.reached is False
        assert "clean_dishes oracle:0.8: below" in below.note

    def test_speed(self) -> None:
        assert check(made_up(), "belief step, 500 facts, ms").reached is False
        assert check(made_up(), "check of a plan, median, ms").reached is None

    def test_they_are_told_as_a_table(self) -> None:
        results = made_up(belief=940, tpvqa=800)
        extent = replace(SMALL, accuracies=(0.8,), prices=())
        told = targets_markdown(targets(results, extent))
        line = "| completion, clean_dishes | ≥ 0.96 | 0.940 (0.924 to 0.953) | **no** |"
        assert line in told
        cells = results_markdown(results, extent)
        assert "| .940 (.924–.953) @ 40 | .800 @ 50 |" in cells


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (["--parts", "gird"], "Did you mean 'grid'"),
        (["--accuracies", "0.8,x"], "write numbers from 0 to 1 with commas"),
        (["--accuracies", "1.5", "--only-tables"], "write numbers from 0 to 1 with commas"),
        (["--prices", "nan", "--only-tables"], "write numbers not below 0 with commas"),
        (["--rhos", ",", "--only-tables"], "write numbers from 0 to 1 with commas"),
        (["--models", "bogus", "--only-tables"], "no recorded VLM 'bogus'"),
        (["--seed", "99999999999999999999"], "--seed"),
        (["--tasks", "clean_dish"], "Did you mean 'clean_dishes'"),
    ],
)
def test_what_is_not_there_is_said_before_anything_runs(
    option: list[str], message: str, tmp_path: Path
) -> None:
    tpvqa = [sys.executable, "-c", "from tpvqa.cli import main; main()"]
    command = [*tpvqa, "bench", "belief", *option, "--out", str(tmp_path / "b")]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 2
    assert message in result.stderr
    assert "Traceback" not in result.stderr
    assert not (tmp_path / "b").exists()


def test_tables_are_made_of_rows_of_an_earlier_version_and_nothing_else_is(tmp_path: Path) -> None:
    path = tmp_path / "rows.parquet"
    write_published(first(2, 3), {**bench().settings(), "version": "0.1.0"}, path)
    out = tmp_path / "out"
    results, _ = run_belief_bench(bench(), out, only_tables=True, published=path)
    assert results.settings["version"] == "0.1.0"
    assert (out / "belief.md").read_text().count("version 0.1.0") == 1
    with pytest.raises(BenchError, match=r"version '0\.1\.0' there"):
        run_belief_bench(bench(), tmp_path / "other", published=path)
