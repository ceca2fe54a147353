"""Finished episodes on disk: never run again, never lost, never mixed with others."""

import json
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.bench.test_statistics import row
from tpvqa.bench.cell import Cell
from tpvqa.bench.ledger import ROWS, SETTINGS, Ledger
from tpvqa.errors import BenchError

CELL = Cell("t", "m", "v", "w")


def test_a_killed_bench_knows_what_is_finished(tmp_path: Path) -> None:
    ledger = Ledger(tmp_path, {"seed": 0})
    ledger.add([row(episode=0, completed=True), row(episode=2), row(episode=3, error="broke")])
    ledger.close()
    with (tmp_path / ROWS).open("ab") as file:
        file.write(b'{"task": "t", "mon')
    again = Ledger(tmp_path, {"seed": 0})
    assert again.missing(CELL, 5) == [1, 3, 4]
    again.add([row(episode=1), row(episode=3, completed=True)])
    again.close()
    last = Ledger(tmp_path, {"seed": 0})
    assert [each.episode for each in last.of(CELL, 4)] == [0, 1, 2, 3]
    assert [each.completed for each in last.of(CELL, 4)] == [True, False, False, True]


def test_two_rows_of_an_episode_that_contradict_each_other_are_named(tmp_path: Path) -> None:
    ledger = Ledger(tmp_path, {})
    twice = [row(episode=1, completed=True), row(episode=1, completed=True, seconds=9.0)]
    ledger.add([row(episode=0, error="broke"), row(episode=0, completed=True), *twice])
    ledger.close()
    Ledger(tmp_path, {}).close()
    said = row(episode=1, completed=False).model_dump_json()
    with (tmp_path / ROWS).open("a") as file:
        file.write(f"{said}\n")
    with pytest.raises(BenchError, match=r"episodes\.jsonl:5: says something else than line 3"):
        Ledger(tmp_path, {})


def test_a_row_of_another_seed_is_named(tmp_path: Path) -> None:
    ledger = Ledger(tmp_path, {"seed": 7})
    ledger.add([row(episode=0, seed=7), row(episode=1, seed=8)])
    ledger.close()
    with pytest.raises(BenchError, match=r"episodes\.jsonl:2: is of the seed 8"):
        Ledger(tmp_path, {"seed": 7})


def test_a_bench_with_other_settings_is_not_mixed_in(tmp_path: Path) -> None:
    Ledger(tmp_path, {"seed": 0, "failure": 0.25}).close()
    with pytest.raises(BenchError, match=r"seed 0 there, 1 here"):
        Ledger(tmp_path, {"seed": 1, "failure": 0.25})


@pytest.mark.parametrize("text", ["", "[]", '"x"', "[" * 200_000, '{"seed": 0, "seed": 0}'])
def test_settings_that_are_none_are_named(tmp_path: Path, text: str) -> None:
    (tmp_path / SETTINGS).write_text(text)
    with pytest.raises(BenchError, match=r"bench\.json: damaged .*Remove the folder"):
        Ledger(tmp_path, {"seed": 0})


@pytest.mark.parametrize("make", [Path.mkdir, os.mkfifo, lambda path: path.symlink_to("other")])
def test_settings_that_are_no_plain_file_are_named(
    tmp_path: Path, make: Callable[[Path], None]
) -> None:
    (tmp_path / "other").write_text('{"seed": 0}')
    make(tmp_path / SETTINGS)
    with pytest.raises(BenchError, match=r"bench\.json: damaged .*plain file is expected"):
        Ledger(tmp_path, {"seed": 0})


def test_two_benches_never_write_one_folder(tmp_path: Path) -> None:
    first = Ledger(tmp_path, {})
    with pytest.raises(BenchError, match="another bench is at work"):
        Ledger(tmp_path, {})
    first.close()


def test_a_damaged_row_is_named(tmp_path: Path) -> None:
    ledger = Ledger(tmp_path, {})
    ledger.add([row(episode=0)])
    ledger.close()
    with (tmp_path / ROWS).open("ab") as file:
        file.write(b'{"nonsense": 1}\n')
    with pytest.raises(BenchError, match=r"episodes\.jsonl:2"):
        Ledger(tmp_path, {})


@pytest.mark.parametrize(
    ("name", "value"),
    [("actions", "-7"), ("seconds", "-1.5"), ("named", "-1"), ("answers", '{"a": -1}')],
)
def test_a_row_of_impossible_numbers_is_named(tmp_path: Path, name: str, value: str) -> None:
    ledger = Ledger(tmp_path, {})
    ledger.add([row(episode=0)])
    ledger.close()
    told = json.loads((tmp_path / ROWS).read_text()) | {name: json.loads(value)}
    with (tmp_path / ROWS).open("a") as file:
        file.write(f"{json.dumps(told)}\n")
    with pytest.raises(BenchError, match=rf"episodes\.jsonl:2: .*{name}.*greater than or equal"):
        Ledger(tmp_path, {})


@pytest.mark.parametrize(
    "told",
    [
        {"questions": 2**63},
        {"prompt_tokens": 10**40},
        {"answers": {"effect|on|1|yes|0.90": 3 * 10**9}},
        {"answers": {"effect|on|1|perhaps|0.90": 1}},
        {"answers": {"effect|on|1|yes|nan": 1}},
        {"answers": {"effect|on|2|yes|0.90": 1}},
        {"answers": {"garbage": 1}},
        {"decisions": {"before|1|1": 10**25}},
        {"decisions": {"before|1": 1}},
        {"goal": 7.0},
        {"goal": float("nan")},
        {"trust": float("inf")},
        {"completed": True, "believed_goal": False},
        {"completed": False, "believed_goal": True, "reached": True},
    ],
)
def test_a_row_of_what_cannot_be_is_named(tmp_path: Path, told: dict[str, object]) -> None:
    Ledger(tmp_path, {}).close()
    line = json.dumps(json.loads(row(episode=0).model_dump_json()) | told)
    (tmp_path / ROWS).write_text(f"{line}\n")
    with pytest.raises(BenchError, match=r"episodes\.jsonl:1: not a row of this version"):
        Ledger(tmp_path, {})
