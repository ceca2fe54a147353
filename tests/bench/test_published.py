"""Rows for others: the same after reading, of the same bench only, and taken for finished."""

import json
import os
from pathlib import Path

import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyarrow import parquet

from tests.bench.test_statistics import row
from tpvqa.bench.cell import Cell
from tpvqa.bench.ledger import Ledger
from tpvqa.bench.published import (
    LEFT_OUT,
    read_published,
    tasks_of,
    version_of,
    write_published,
)
from tpvqa.bench.row import EpisodeRow
from tpvqa.errors import BenchError

SETTINGS = {"seed": 0, "failure": 0.25}
counts = st.integers(0, 100_000)


@st.composite
def _rows(draw: st.DrawFn) -> list[EpisodeRow]:
    return [
        EpisodeRow(
            task=draw(st.sampled_from(["a", "b"])),
            monitor=draw(st.sampled_from(["belief", "tpvqa:3"])),
            vlm="oracle:0.8",
            world="symbolic",
            condition=draw(st.sampled_from(["", "failure=0.1"])),
            seed=0,
            episode=number,
            completed=(completed := draw(st.booleans())),
            believed_goal=completed or draw(st.booleans()),
            because=draw(st.text(max_size=9)),
            questions=draw(counts),
            actions=draw(counts),
            trust=draw(st.none() | st.floats(0, 3)),
            answers={"effect|on|1|yes|": 3},
            seconds=0.5,
        )
        for number in range(draw(st.integers(0, 5)))
    ]


@given(rows=_rows())
def test_they_come_back_as_they_were(
    rows: list[EpisodeRow], tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.mktemp("rows") / "some.parquet"
    assert write_published(rows, SETTINGS, path) == len(rows)
    back = {each.episode: each for each in read_published(path, SETTINGS)}
    bare = {each.episode: EpisodeRow(**each.model_dump(exclude=set(LEFT_OUT))) for each in rows}
    assert back == bare


def test_a_bench_goes_on_from_them(tmp_path: Path) -> None:
    rows = [row(episode=0, completed=True), row(episode=1), row(episode=2, error="broke")]
    assert write_published(rows, SETTINGS, tmp_path / "data" / "part.parquet") == 2
    ledger = Ledger(tmp_path / "bench", SETTINGS, tmp_path / "data")
    cell = Cell("t", "m", "v", "w")
    assert ledger.missing(cell, 4) == [2, 3]
    ledger.add([row(episode=2)])
    ledger.close()
    assert [each.episode for each in Ledger(tmp_path / "bench", SETTINGS).of(cell, 4)] == [2]


def test_those_of_another_bench_are_not_taken(tmp_path: Path) -> None:
    write_published([row(episode=0)], SETTINGS, tmp_path / "part.parquet")
    with pytest.raises(BenchError, match=r"part\.parquet .*seed 0 there, 1 here"):
        Ledger(tmp_path / "bench", {**SETTINGS, "seed": 1}, tmp_path)
    assert not (tmp_path / "bench").exists()


@pytest.mark.parametrize("content", [b"", b"PAR1 and then nothing", b"a,b\n1,2\n"])
def test_what_is_no_such_file_is_named(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "part.parquet").write_bytes(content)
    with pytest.raises(BenchError, match=r"part\.parquet"):
        list(read_published(tmp_path, SETTINGS))
    with pytest.raises(BenchError, match=r"no \*\.parquet"):
        list(read_published(Path(__file__).parent, SETTINGS))


def test_another_table_is_named(tmp_path: Path) -> None:
    import pyarrow as pa
    from pyarrow import parquet

    parquet.write_table(pa.table({"a": [1]}), tmp_path / "a.parquet")
    with pytest.raises(BenchError, match="does not say which bench"):
        list(read_published(tmp_path / "a.parquet", SETTINGS))


def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.parquet")
    for path in (tmp_path, tmp_path / "a.parquet"):
        with pytest.raises(BenchError, match=r"a\.parquet: cannot be read .*a plain file"):
            list(read_published(path, SETTINGS))
        with pytest.raises(BenchError, match=r"a\.parquet: cannot be read"):
            version_of(path)


@pytest.mark.parametrize("name", [b"tpvqa.bench", b"tpvqa.tasks"])
@pytest.mark.parametrize("told", [b"{nope", b"[1, 2]", b"\xff\xfe{", b"[" * 100_000, b"zz"])
def test_what_it_says_of_itself_is_read_before_anything_is_made(
    tmp_path: Path, name: bytes, told: bytes
) -> None:
    from pyarrow import parquet

    path = tmp_path / "a.parquet"
    write_published([row(episode=0)], SETTINGS, path)
    table = parquet.read_table(path)
    changed = table.replace_schema_metadata({**table.schema.metadata, name: told})
    parquet.write_table(changed, path)
    for read in (version_of, tasks_of, lambda path: Ledger(tmp_path / "bench", SETTINGS, path)):
        with pytest.raises(BenchError, match=r"a\.parquet: damaged"):
            read(path)
    assert not (tmp_path / "bench").exists()


def test_a_few_bytes_do_not_fill_the_memory(tmp_path: Path) -> None:
    """One long text, once for every row: unpacked some 20 GB."""
    long = pa.DictionaryArray.from_arrays(
        pa.array([0] * 100_000, pa.int32()), pa.array(["a" * 200_000])
    )
    told = {b"tpvqa.bench": json.dumps(SETTINGS)}
    parquet.write_table(
        pa.table({"task": long}).replace_schema_metadata(told),
        tmp_path / "part.parquet",
        compression="zstd",
    )
    assert (tmp_path / "part.parquet").stat().st_size < 10_000
    with pytest.raises(BenchError, match=r"part\.parquet: cannot be read \(it has a text of more"):
        list(read_published(tmp_path, SETTINGS))


@pytest.mark.parametrize(
    "column", [pa.array([["a"], ["b"]]), pa.array([b"ab", b"cd"], pa.binary(2))], ids=str
)
def test_columns_that_unpack_without_bound_are_refused(tmp_path: Path, column: pa.Array) -> None:
    table = pa.table({"task": column})
    told = {b"tpvqa.bench": json.dumps(SETTINGS)}
    parquet.write_table(table.replace_schema_metadata(told), tmp_path / "part.parquet")
    with pytest.raises(BenchError, match=r"part\.parquet: cannot be read \(its column task"):
        list(read_published(tmp_path, SETTINGS))


def test_rows_that_contradict_each_other_are_named_before_anything_is_made(tmp_path: Path) -> None:
    data, cell = tmp_path / "data", Cell("t", "m", "v", "w")
    rows = [row(episode=k, actions=5) for k in range(3)]
    write_published(rows, SETTINGS, data / "a.parquet")
    write_published([rows[1]], SETTINGS, data / "b.parquet")  # says the same
    ledger = Ledger(tmp_path / "bench", SETTINGS, data)
    assert ledger.missing(cell, 3) == []
    ledger.add([row(episode=0, actions=5, seconds=2.0, answers={"effect|on|1|yes|": 3})])
    ledger.close()
    Ledger(tmp_path / "bench", SETTINGS, data).close()  # its own say more, and the same
    write_published([rows[0], row(episode=1, actions=6)], SETTINGS, data / "b.parquet")
    said = r"b\.parquet, row 2: says something else than .*a\.parquet, row 2 of the same episode"
    with pytest.raises(BenchError, match=said):
        Ledger(tmp_path / "other", SETTINGS, data)
    assert not (tmp_path / "other").exists()
    (data / "b.parquet").unlink()
    write_published([row(episode=0, actions=7)], SETTINGS, data / "a.parquet")
    with pytest.raises(BenchError, match=r"episodes\.jsonl:1: says .*a\.parquet, row 1 of"):
        Ledger(tmp_path / "bench", SETTINGS, data)


def test_rows_of_another_seed_than_they_say_are_named(tmp_path: Path) -> None:
    write_published([row(episode=0), row(episode=1, seed=9)], SETTINGS, tmp_path / "a.parquet")
    with pytest.raises(BenchError, match=r"a\.parquet, row 2: is of the seed 9, .* of 0"):
        Ledger(tmp_path / "bench", SETTINGS, tmp_path / "a.parquet")
    assert not (tmp_path / "bench").exists()


def test_texts_that_are_none_are_named(tmp_path: Path) -> None:
    import pyarrow as pa
    from pyarrow import parquet

    path = tmp_path / "a.parquet"
    write_published([row(episode=0)], SETTINGS, path)
    table = parquet.read_table(path)
    broken = pa.Array.from_buffers(pa.string(), 1, pa.array([b"\xff"]).buffers())
    place = table.schema.names.index("because")
    parquet.write_table(table.set_column(place, "because", broken), path)
    with pytest.raises(BenchError, match=r"a\.parquet: cannot be read"):
        list(read_published(path, SETTINGS))


def test_a_failure_hides_no_finished_episode(tmp_path: Path) -> None:
    write_published([row(episode=0, completed=True)], SETTINGS, tmp_path / "data" / "a.parquet")
    own = Ledger(tmp_path / "bench", SETTINGS)
    own.add([row(episode=0, error="broke"), row(episode=1, error="broke")])
    own.close()
    ledger = Ledger(tmp_path / "bench", SETTINGS, tmp_path / "data")
    cell = Cell("t", "m", "v", "w")
    assert ledger.missing(cell, 2) == [1]
    assert [each.completed for each in ledger.of(cell, 1)] == [True]
