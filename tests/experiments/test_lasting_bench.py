"""The belief bench where errors last: its cells, who is compared with whom, what it concludes."""

import json
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.bench.cell import Cell
from tpvqa.bench.ledger import ROWS
from tpvqa.bench.row import EpisodeRow
from tpvqa.errors import BenchError, UnknownNameError
from tpvqa_experiments.belief import BeliefBench, BeliefResults, Part, run_belief_bench
from tpvqa_experiments.belief.best_rival import best_rival
from tpvqa_experiments.belief.bounded import bounded
from tpvqa_experiments.belief.calibrations import Source, calibrations, source_of
from tpvqa_experiments.belief.check import Check
from tpvqa_experiments.belief.lasting import (
    AFTER,
    KNOWS,
    NOISES,
    draws,
    experienced,
    recorded_noise,
)
from tpvqa_experiments.belief.lasting_tables import (
    lasting_markdown,
    lasting_rows,
    lasting_targets_markdown,
)
from tpvqa_experiments.belief.lasting_targets import lasting_targets
from tpvqa_experiments.belief.parts import BELIEF, BLIND, FIELD, Extent
from tpvqa_experiments.belief.under_noise import over_robots
from tpvqa_experiments.paper import PAPER

TASK = "clean_dishes"
EXTENT = Extent(tasks=(TASK,), models=("gemma-3-12b",), lasting=100)
BY_VLM = {noise.vlm: noise for noise in NOISES}
MISREAD, USELESS = BY_VLM["flawed:misread:0.1:0.95"], BY_VLM["flawed:useless:0.8"]
GEMMA = recorded_noise("gemma-3-12b")


def rows(
    cell: Cell, completed: Sequence[bool], questions: int = 10, lied: int = 0
) -> list[EpisodeRow]:
    """Made-up episodes of a cell; of those that are not completed so many ended in *done*."""
    found = []
    for number, done in enumerate(completed):
        believed = done or lied > 0
        lied -= believed and not done
        found.append(
            EpisodeRow(
                task=cell.task,
                monitor=cell.monitor,
                vlm=cell.vlm,
                world=cell.world,
                condition=cell.condition,
                seed=0,
                episode=number,
                completed=done,
                believed_goal=believed,
                reached=done,
                because="goal",
                questions=questions,
                actions=5,
            )
        )
    return found


def share(cell: Cell, completed: int, of: int = 100, **more: int) -> list[EpisodeRow]:
    """Episodes of which so many are completed, spread evenly."""
    return rows(
        cell,
        [number * completed // of != (number + 1) * completed // of for number in range(of)],
        **more,
    )


def found(*own: Sequence[EpisodeRow]) -> BeliefResults:
    return BeliefResults({}, {each[0].cell: each for each in own})


def checks(results: BeliefResults, what: str, redo: str = "free") -> list[Check]:
    return [
        check
        for check in lasting_targets(results, EXTENT)
        if check.what.startswith(what) and check.condition.endswith(redo)
    ]


class TestCells:
    def test_every_noise_has_ours_and_every_rival_free_and_risky(self) -> None:
        cells = dict(EXTENT.cells(Part.LASTING))
        for noise in (*NOISES, GEMMA):
            for redo in ("free", "risky"):
                for monitor in (BELIEF, *FIELD, *BLIND):
                    assert cells[noise.cell(TASK, monitor, redo)] == 100
        assert {cell.vlm for cell in cells if cell.monitor in BLIND} == {"oracle:0.8"}

    def test_recorded_models_stay_on_the_tasks_of_their_environments(self) -> None:
        tasks = {
            cell.task
            for cell, _ in Extent().cells(Part.LASTING)
            if cell.vlm == "recorded:gemma-3-12b:1:lasting"
        }
        assert tasks == {"build_tower", "clean_dishes", "serve_breakfast", "eat_apple"}

    def test_what_is_wrongly_believed_is_calibrated_so_and_all_else_on_itself(self) -> None:
        told = {
            noise.vlm: source_of(noise.cell(TASK, BELIEF, "free")).vlm for noise in (*NOISES, GEMMA)
        }
        assert told.pop("flawed:useless:0.8") == "oracle:0.8"
        assert told.pop("flawed:biased:on:0.9:0.5:0.8") == "oracle:0.8"
        assert told.pop("recorded:gemma-3-12b:1:lasting") == "recorded:gemma-3-12b:0:lasting"
        assert all(told[vlm] == vlm for vlm in told)

    def test_who_knows_how_answers_err_is_calibrated_on_the_very_same(self) -> None:
        cells = dict(EXTENT.cells(Part.LASTING))
        for noise in (USELESS, GEMMA):
            for redo in ("free", "risky"):
                cell = noise.cell(TASK, KNOWS[redo], redo)
                assert cells[cell] == 100
                assert source_of(cell).vlm == noise.vlm == cell.vlm
        assert MISREAD.cell(TASK, KNOWS["free"], "free") not in cells

    def test_who_gathers_experience_is_not_told_which_questions_are_misread(self) -> None:
        cell = experienced(TASK, "risky", 3)
        assert cell.vlm.endswith(":same:3")
        assert source_of(cell).vlm == "flawed:misread:0.1:0.95"
        robots = {cell.vlm for cell, _ in EXTENT.cells(Part.LASTING) if ":same:" in cell.vlm}
        assert len(robots) == len(draws(100)) == 4


@pytest.mark.parametrize(("half", "least"), [("0:lasting", 0.3), ("0:fresh", 0.0)])
def test_a_calibration_of_recorded_answers_says_how_errors_last(
    half: str, least: float, tmp_path: Path
) -> None:
    source = Source(TASK, f"recorded:qwen2.5-vl-7b:{half}", "symbolic")
    learnt = calibrations(tmp_path, [source], PAPER, 12)[source]
    assert (learnt.lasting_share > 0.3) is (least > 0)


def test_who_knows_how_answers_err_stands_beside_ours_as_a_limit_not_as_a_rival() -> None:
    own, knowing = (GEMMA.cell(TASK, monitor, "free") for monitor in (BELIEF, KNOWS["free"]))
    rival = GEMMA.cell(TASK, "tpvqa", "free")
    results = found(share(own, 60, lied=20), share(knowing, 90, lied=10), share(rival, 50))
    told = lasting_markdown(results, EXTENT, list(lasting_targets(results, EXTENT)))
    section = told.partition("## Ours beside who knows how its answers err")[2]
    line = next(line for line in section.splitlines() if line.startswith("| gemma-3-12b"))
    assert "0.60" in line
    assert "0.90" in line
    (limit,) = checks(results, "of who knows how answers err: wrong done")
    assert limit.reached is None
    assert limit.note == f"not in: gemma-3-12b {TASK} 0.1"
    best = {row["monitor"]: row["best_rival"] for row in lasting_rows(results, EXTENT)}
    assert best == {"tpvqa": True, BELIEF: False, "knowing": False}


class TestBestRival:
    cell = MISREAD.cell(TASK, "lead:2", "free")

    @given(st.lists(st.lists(st.booleans(), min_size=6, max_size=30), min_size=1, max_size=5))
    def test_no_trial_is_judged_by_who_was_chosen_with_it(
        self, completed: list[list[bool]]
    ) -> None:
        rivals = {str(n): rows(self.cell, own) for n, own in enumerate(completed)}
        best = best_rival(rivals)
        assert best is not None
        for parity in (0, 1):
            judged = [row for row in best.rows if row.episode % 2 == parity]
            turned = {
                name: [
                    row.model_copy(update={"completed": not row.completed})
                    if row.episode % 2 == parity
                    else row
                    for row in own
                ]
                for name, own in rivals.items()
            }
            other = best_rival(turned)
            assert other is not None
            again = [row for row in other.rows if row.episode % 2 == parity]
            assert [row.episode for row in again] == [row.episode for row in judged]
            assert all(a.completed != b.completed for a, b in zip(judged, again, strict=True))

    def test_a_few_lucky_trials_do_not_choose(self) -> None:
        many, few = share(self.cell, 90), share(self.cell, 6, of=6)
        best = best_rival({"lead:2": many, "lead:6": few})
        assert best is not None
        assert best.names == ("lead:2",)
        assert best.rows == tuple(many)

    def test_who_is_as_good_with_fewer_questions_is_chosen(self) -> None:
        dear, cheap = share(self.cell, 50, questions=90), share(self.cell, 50, questions=9)
        best = best_rival({"lead:6": dear, "lead:2": cheap})
        assert best is not None
        assert best.names == ("lead:2",)

    def test_none_was_run(self) -> None:
        assert best_rival({}) is None
        assert best_rival({"lead:2": rows(self.cell, [True])}) is None


class TestTargets:
    def test_a_rate_is_reached_by_the_upper_end_and_a_number_by_the_lower(self) -> None:
        cell = MISREAD.cell(TASK, BELIEF, "free")
        (near,) = checks(found(share(cell, 86)), "completion, ")
        assert (near.reached, near.target) == (True, "≥ 0.9")
        (far,) = checks(found(share(cell, 70)), "completion, ")
        assert far.reached is False
        useless = USELESS.cell(TASK, BELIEF, "risky")
        (asked,) = checks(found(share(useless, 9, questions=51)), "questions", "risky")
        assert (asked.reached, asked.target) == (False, "≤ 50")

    def test_a_useless_vlm_is_measured_by_the_best_blind(self) -> None:
        own = share(USELESS.cell(TASK, BELIEF, "free"), 60)
        blind = share(USELESS.cell(TASK, "blind:5", "free"), 80)
        lead = share(USELESS.cell(TASK, "lead:2", "free"), 100)
        (behind,) = checks(found(own, blind, lead), "completion less the best blind's")
        assert behind.reached is False
        assert behind.note == "blind:5"
        (beside,) = checks(found(own, blind, lead), "completion less the best rival's")
        assert (beside.reached, beside.note) == (None, "worse than lead:2")

    def test_recorded_cells_are_counted_and_the_lost_ones_named(self) -> None:
        own = share(GEMMA.cell(TASK, BELIEF, "free"), 60, questions=400, lied=20)
        lead = share(GEMMA.cell(TASK, "lead:2", "free"), 90)
        results = found(own, lead)
        (lost,) = checks(results, "not worse than the best rival")
        assert (lost.reached, lost.target) == (False, "1")
        assert lost.note == "not in: gemma-3-12b clean_dishes -0.300"
        (lied,) = checks(results, "wrong done")
        assert lied.note == "not in: gemma-3-12b clean_dishes 0.2"
        assert not any(check.reached for check in lasting_targets(results, EXTENT))
        well = found(share(own[0].cell, 99, questions=40), lead)
        judged = [each for each in lasting_targets(well, EXTENT) if each.target != "–"]
        assert all(check.reached for check in judged)
        assert (
            checks(results, "the goal holds")[0].note == "not in: gemma-3-12b clean_dishes -0.300"
        )

    def test_only_trials_after_the_experience_count(self) -> None:
        late = [number >= AFTER for number in range(25)]
        cells = [experienced(TASK, "free", draw) for draw in draws(100)]
        (check,) = checks(found(*(rows(cell, late) for cell in cells)), "completion, ")
        assert check.measured is not None
        assert check.measured.value == 1.0
        early = found(*(rows(cell, [not each for each in late]) for cell in cells))
        (check,) = checks(early, "completion, ")
        assert check.measured is not None
        assert check.measured.value == 0.0
        assert check.reached is False

    def test_a_robot_counts_once_however_many_trials_it_has(self) -> None:
        cell = experienced(TASK, "free", 0)
        few, many = (over_robots([share(cell, n, of=n), rows(cell, [False] * n)]) for n in (2, 50))
        assert few == many
        assert few.value == 0.5
        assert over_robots([rows(cell, [True])] * 4).low < 0.7

    def test_a_risk_is_learnt_on_one_half_of_the_trials_and_judged_on_the_other(self) -> None:
        cell = MISREAD.cell(TASK, BELIEF, "free")
        own = share(cell, 90, of=99, lied=9)
        own = [row.model_copy(update={"reached": row.completed}) for row in own]
        sure = {False: 0.9, True: 0.99}
        told = [row.model_copy(update={"goal": sure[row.completed]}) for row in own]
        held = checks(found(told), "wrong done ≤ 0.02")
        assert [each.reached for each in held] == [True]
        ended = bounded(told, 0.02)
        assert len(ended) == len(own)
        assert sum(row.believed_goal for row in ended) == sum(row.completed for row in ended) == 90
        alike = [row.model_copy(update={"goal": 0.9}) for row in own]
        assert not any(row.believed_goal for row in bounded(alike, 0.02))
        assert bounded(told[:97], 0.02) == []

    def test_what_was_not_run_is_not_told(self) -> None:
        assert not list(lasting_targets(BeliefResults({}, {}), EXTENT))
        assert not lasting_markdown(BeliefResults({}, {}), EXTENT, [])


def test_the_tables_say_who_lost_to_whom() -> None:
    own = share(MISREAD.cell(TASK, BELIEF, "free"), 40, questions=200, lied=10)
    lead = share(MISREAD.cell(TASK, "lead:2", "free"), 75)
    results = found(own, lead)
    told = lasting_markdown(results, EXTENT, list(lasting_targets(results, EXTENT)))
    assert "| ≥ 0.9 | **0.40 (0.31–0.50)** | **no** |" in told
    assert "| lead:2 | 0.75 (0.66–0.82) of 100 | .000 | .750 | 10 | 5.0 | **-0.350 (" in told
    assert "| worse |" in told
    two = lasting_targets_markdown(list(lasting_targets(results, EXTENT)), (TASK, "eat_apple"))
    assert "| clean_dishes **0.40 (0.31–0.50)** |" in two
    ours = next(row for row in lasting_rows(results, EXTENT) if row["monitor"] == BELIEF)
    figures = ("completion_rate", "wrong_done", "goal_holds", "questions")
    assert [ours[name] for name in figures] == [0.4, 0.1, 0.4, 200.0]


def test_the_documentation_gets_its_table_from_the_bench(tmp_path: Path) -> None:
    script = Path(__file__).parents[2] / "experiments/tools/lasting_docs.py"
    results = found(share(MISREAD.cell(TASK, BELIEF, "free"), 40))
    told = lasting_markdown(results, EXTENT, list(lasting_targets(results, EXTENT)))
    (tmp_path / "belief-measured.md").write_text(
        "# Belief\n<!-- lasting -->\n\n<!-- end -->\nMore.\n"
    )
    command = [sys.executable, str(script), str(tmp_path), "--docs", str(tmp_path)]
    missing = subprocess.run(command, capture_output=True, text=True, check=False)
    assert missing.returncode == 1
    assert "tpvqa bench belief --parts lasting" in missing.stderr
    (tmp_path / "lasting.md").write_text(told)
    for _ in range(2):  # again, and it is the same
        subprocess.run(command, check=True)
        page = (tmp_path / "belief-measured.md").read_text()
        assert page.count("**0.40 (0.31–0.50)**") == 1
        assert page.startswith("# Belief\n<!-- lasting -->\n\n| condition |")
        assert page.endswith("<!-- end -->\nMore.\n")
    assert (tmp_path / "lasting-results.md").read_text() == told


class TestRunning:
    def bench(self, *monitors: str, vlms: Sequence[str] = ()) -> BeliefBench:
        extent = Extent(tasks=(TASK,), models=("gemma-3-12b",), lasting=2)
        return BeliefBench(
            parts=[Part.LASTING],
            extent=extent,
            calibration_episodes=2,
            monitors=monitors,
            vlms=vlms,
        )

    def test_ours_are_added_to_the_rivals_that_were_run_alone(self, tmp_path: Path) -> None:
        run_belief_bench(self.bench("blind:1", "tpvqa"), tmp_path)
        before = (tmp_path / ROWS).read_bytes()
        assert not (tmp_path / "calibrations").exists() or not list(
            (tmp_path / "calibrations").iterdir()
        )
        bench = self.bench("blind:1", "belief", vlms=["oracle:0.8"])
        results, _ = run_belief_bench(bench, tmp_path)
        after = (tmp_path / ROWS).read_bytes()
        assert after.startswith(before)
        assert after.count(b"\n") - before.count(b"\n") == 2 * 2  # free and risky
        assert {cell.monitor for cell in results.rows} == {"blind:1", "tpvqa", "belief"}
        told = json.loads((tmp_path / "lasting.json").read_text())
        assert {row["monitor"] for row in told} == {"blind:1", "tpvqa", "belief"}
        assert "| fresh, .8 | free |" in (tmp_path / "lasting.md").read_text()

    def test_rivals_of_an_earlier_version_are_taken_over_and_nobody_else(
        self, tmp_path: Path
    ) -> None:
        earlier, later = tmp_path / "earlier", tmp_path / "later"
        fresh = self.bench("blind:1", "belief", vlms=["oracle:0.8"])
        run_belief_bench(fresh, earlier)
        settings = json.loads((earlier / "bench.json").read_text())
        (earlier / "bench.json").write_text(json.dumps({**settings, "version": "0.0.1"}))
        with pytest.raises(BenchError, match=r"version '0\.0\.1' there"):
            run_belief_bench(fresh, earlier)
        results, _ = run_belief_bench(
            self.bench("blind:1"), later, only_tables=True, rivals_from=earlier
        )
        assert {cell.monitor for cell in results.rows} == {"blind:1"}
        run_belief_bench(fresh, later, rivals_from=earlier)
        rows = [json.loads(line) for line in (later / ROWS).read_text().splitlines()]
        assert sorted(row["monitor"] for row in rows) == ["belief"] * 4 + ["blind:1"] * 4
        assert "rivals of version 0.0.1" in (later / "lasting.md").read_text()

    def test_rivals_of_another_bench_are_not(self, tmp_path: Path) -> None:
        (tmp_path / "a").mkdir()
        with pytest.raises(BenchError, match="holds no bench"):
            run_belief_bench(self.bench("blind:1"), tmp_path / "b", rivals_from=tmp_path / "a")
        run_belief_bench(self.bench("blind:1"), tmp_path / "a")
        other = replace(self.bench("blind:1"), common=PAPER.but(seed=1))
        with pytest.raises(BenchError, match="seed 0 there, 1 here"):
            run_belief_bench(other, tmp_path / "b", rivals_from=tmp_path / "a")
        assert not (tmp_path / "b").exists()

    @pytest.mark.parametrize("name", ["bench.json", "taken_over.json", "speed.json"])
    @pytest.mark.parametrize("text", ["[]", "[" * 200_000])
    def test_a_damaged_file_is_named(self, tmp_path: Path, name: str, text: str) -> None:
        bench = self.bench("blind:1", vlms=["oracle:0.8"])
        run_belief_bench(bench, tmp_path / "a", only_tables=True)
        (tmp_path / "a" / name).write_text(text)
        rivals = tmp_path / "a" if name == "bench.json" else None
        folder = tmp_path / ("a" if rivals is None else "b")
        with pytest.raises(BenchError, match=rf"{name}: damaged"):
            run_belief_bench(bench, folder, only_tables=True, rivals_from=rivals)

    def test_a_monitor_that_no_part_has(self, tmp_path: Path) -> None:
        with pytest.raises(UnknownNameError, match="Did you mean 'lead:2'"):
            run_belief_bench(self.bench("laed:2"), tmp_path / "x")
        with pytest.raises(UnknownNameError, match="VLM of these parts"):
            run_belief_bench(self.bench(vlms=["oracle:0.7"]), tmp_path / "x")
        with pytest.raises(BenchError, match="one of these monitors and one of these VLMs"):
            run_belief_bench(self.bench("blind:1", vlms=["oracle:0.8:0:1"]), tmp_path / "x")
        assert not (tmp_path / "x").exists()
