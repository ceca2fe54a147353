"""Files that others made, or that something happened to: a clear error, and nothing is run."""

import os
import shutil
import sqlite3
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.vlm.kept.coin import FRIDGE, PLATE, Coin, keeping, seen
from tpvqa.errors import CacheError, TpvqaError
from tpvqa.vlm.kept import AnswerFile, Use
from tpvqa.vlm.kept.upkeep import exported, stats


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("good") / "answers.db"
    vlm = keeping(path, Use.RECORD, Coin())
    for look in range(40):
        vlm.ask(seen(look, look), [FRIDGE, PLATE])
    vlm.close()
    return path


def changed(*statements: str) -> Callable[[Path], None]:
    def change(path: Path) -> None:
        with sqlite3.connect(path) as connection:
            connection.execute("PRAGMA writable_schema = ON")
            for statement in statements:
                connection.execute(statement)
        connection.close()

    return change


def text(path: Path) -> None:
    path.write_text("no answers at all\n" * 100)


def truncated(path: Path) -> None:
    os.truncate(path, path.stat().st_size // 2)


def folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def gone(path: Path) -> None:
    path.unlink()


def foreign(path: Path) -> None:
    path.unlink()
    changed("CREATE TABLE mine (x)", "PRAGMA user_version = 3")(path)


STRANGE = {
    "no database": (text, "no file of recorded answers"),
    "another program's": (foreign, "no file of recorded answers"),
    "another version's": (changed("PRAGMA user_version = 99"), "schema 99; this one reads 1"),
    "truncated": (truncated, "damaged"),
    "a folder": (folder, "plain file"),
    "a pipe": (pipe, "plain file"),
    "not there": (gone, "no answers were recorded here"),
    "a view": (
        changed("DROP TABLE answers", "CREATE VIEW answers AS SELECT 1 AS id"),
        "other tables",
    ),
    "a trigger": (
        changed(
            "CREATE TRIGGER t AFTER INSERT ON answers BEGIN DELETE FROM models; END",
        ),
        "other tables",
    ),
    "one table more": (changed("CREATE TABLE more (x)"), "other tables"),
    "another column": (changed("ALTER TABLE answers ADD COLUMN more TEXT"), "other tables"),
    "an index that computes": (
        changed("CREATE INDEX i ON answers (abs(draw))"),
        "other tables",
    ),
    "another reply": (changed("UPDATE answers SET reply = 'perhaps'"), "damaged"),
    "another number": (changed("UPDATE answers SET p_yes = 7"), "damaged"),
    "endless seconds": (changed("UPDATE answers SET seconds = 9e999"), "damaged"),
    "huge text": (
        changed("UPDATE answers SET text = CAST(zeroblob(5000000) AS TEXT)"),
        "damaged",
    ),
    "no parameters": (changed("UPDATE models SET parameters = '[1]'"), "damaged"),
    "no UTF-8": (changed("UPDATE answers SET text = CAST(x'ff' AS TEXT)"), "damaged"),
}


@pytest.mark.parametrize("name", STRANGE)
def test_it_is_refused_in_a_sentence(name: str, good: Path, tmp_path: Path) -> None:
    change, why = STRANGE[name]
    path = tmp_path / "answers.db"
    shutil.copy(good, path)
    change(path)
    with pytest.raises(TpvqaError, match=why):
        keeping(path, Use.REPLAY, None).ask(seen(1, 1), [FRIDGE])


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE models SET parameters = 'x'",
        "UPDATE models SET parameters = '[1]'",
        f"UPDATE models SET parameters = '{'[' * 100_000}'",
        "UPDATE answers SET at = 9223372036854775807",
        "UPDATE answers SET at = -1",
        "UPDATE answers SET seconds = 1e308",
    ],
)
def test_counting_refuses_it_in_a_sentence(statement: str, good: Path, tmp_path: Path) -> None:
    path = tmp_path / "answers.db"
    shutil.copy(good, path)
    changed(statement)(path)
    with pytest.raises(CacheError, match="damaged"):
        stats(path)
    if "models" in statement:
        with pytest.raises(CacheError, match="damaged"):
            list(exported(path))


@pytest.mark.parametrize(
    "statement",
    ["p_yes = 9e999", "p_yes = 2", "leftover = -1", "reply = 'YES'", "seconds = 9e999"],
)
def test_what_is_no_answer_is_neither_counted_nor_exported(
    statement: str, good: Path, tmp_path: Path
) -> None:
    path = tmp_path / "answers.db"
    given: list[object] = []
    shutil.copy(good, path)
    changed(f"UPDATE answers SET {statement} WHERE id = 40")(path)
    with pytest.raises(CacheError, match="damaged"):
        given.extend(exported(path))
    assert not given
    with pytest.raises(CacheError, match="damaged"):
        stats(path)


@pytest.mark.parametrize("name", ["no database", "another program's", "a trigger", "a folder"])
def test_what_is_not_ours_is_not_written_to(name: str, good: Path, tmp_path: Path) -> None:
    change, why = STRANGE[name]
    path = tmp_path / "answers.db"
    shutil.copy(good, path)
    change(path)
    before = path.read_bytes() if path.is_file() else b""
    with pytest.raises(TpvqaError, match=why):
        AnswerFile(path, writing=True)
    assert (path.read_bytes() if path.is_file() else b"") == before


@settings(max_examples=60)
@given(st.data())
def test_whatever_bytes_are_changed_it_is_read_or_refused(good: Path, data: st.DataObject) -> None:
    path = good.with_name("mutant.db")
    content = bytearray(good.read_bytes())
    for _ in range(data.draw(st.integers(1, 30))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(content)
    try:
        stats(path)
        list(exported(path))
        vlm = keeping(path, Use.REPLAY, None)
        for look in range(40):
            vlm.ask(seen(look, look), [FRIDGE, PLATE])
    except (CacheError, IndexError):  # the VLM may be gone from the file
        pass


def test_replaying_leaves_nothing_beside_the_file(good: Path, tmp_path: Path) -> None:
    path = tmp_path / "answers.db"
    shutil.copy(good, path)
    tmp_path.chmod(0o555)
    try:
        keeping(path, Use.REPLAY, None).ask(seen(1, 1), [FRIDGE])
        assert [each.name for each in tmp_path.iterdir()] == ["answers.db"]
    finally:
        tmp_path.chmod(0o755)


def test_a_file_that_a_kill_left_empty_is_begun(tmp_path: Path) -> None:
    path = tmp_path / "answers.db"
    path.touch()
    keeping(path, Use.RECORD, Coin()).ask(seen(1), [FRIDGE])
    assert stats(path).answers == 1


def test_a_link_to_nothing_is_refused_and_nothing_made(tmp_path: Path) -> None:
    path, elsewhere = tmp_path / "answers.db", tmp_path / "elsewhere.db"
    path.symlink_to(elsewhere)
    with pytest.raises(CacheError, match="a link to a file that is not there"):
        keeping(path, Use.CACHE, Coin())
    assert not elsewhere.exists()
    elsewhere.touch()
    keeping(path, Use.CACHE, Coin()).ask(seen(1), [FRIDGE])
    assert stats(elsewhere).answers == 1


def test_a_name_with_signs_of_addresses_is_a_name(tmp_path: Path) -> None:
    path = tmp_path / "an?swers#1 %41.db"
    keeping(path, Use.RECORD, Coin()).ask(seen(1), [FRIDGE])
    assert path.exists()
    keeping(path, Use.REPLAY, None).ask(seen(1), [FRIDGE])
