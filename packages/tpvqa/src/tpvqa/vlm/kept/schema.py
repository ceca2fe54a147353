"""The form of a file of recorded answers, and opening one, which may be a stranger's.

Whatever is not exactly of this form is refused before anything in it is used: other tables, views,
triggers and indices run code of the file's when it is read.
"""

import os
import sqlite3
from pathlib import Path
from urllib.parse import quote

from tpvqa.errors import CacheError, WriteError
from tpvqa.files import open_plain

SCHEMA = 1
"""Of these tables; `PRAGMA user_version`."""
APPLICATION = 0x74707661
"""What the file says it is, "tpva"; `PRAGMA application_id`."""
PATIENCE = 60.0
"""Seconds to wait for other processes that write."""
LONGEST = 2**20
"""Bytes of one value."""
REMEDY = "Make room, or name another file"
_MAGIC = b"SQLite format 3\0"
_TABLES = (
    "CREATE TABLE models (id INTEGER PRIMARY KEY, spec TEXT NOT NULL, parameters TEXT NOT NULL, "
    "UNIQUE (spec, parameters)) STRICT",
    "CREATE TABLE questions (id INTEGER PRIMARY KEY, text TEXT NOT NULL UNIQUE, "
    "way TEXT NOT NULL, subject TEXT NOT NULL) STRICT",
    "CREATE TABLE answers (id INTEGER PRIMARY KEY, "
    "model INTEGER NOT NULL REFERENCES models (id), picture BLOB NOT NULL, "
    "question INTEGER NOT NULL REFERENCES questions (id), trial BLOB NOT NULL, "
    "draw INTEGER NOT NULL, reply TEXT NOT NULL, p_yes REAL, source TEXT NOT NULL, "
    "text TEXT NOT NULL, p_cannot_see REAL, leftover REAL, seconds REAL NOT NULL, "
    "at INTEGER NOT NULL, UNIQUE (model, picture, question, trial, draw)) STRICT",
)


def opened(path: Path, *, writing: bool) -> sqlite3.Connection:
    """Open a file of answers; one that is not there is made where it is to be written.

    Raises:
        CacheError: It is not there, is no such file, is damaged, or of another version.
        WriteError: It cannot be written.
    """
    there = _is_there(path, writing=writing)
    if not writing and not there:
        raise CacheError(
            f"{path}: no answers were recorded here. Record some first, with --record or --cache"
        )
    try:
        connection = _connected(path, writing=writing)
    except sqlite3.Error as error:
        raise wrong(path, error) from error
    try:
        _check(path, connection, writing=writing)
    except (sqlite3.Error, UnicodeDecodeError) as error:
        connection.close()
        raise wrong(path, error) from error
    except BaseException:
        connection.close()
        raise
    return connection


def _is_there(path: Path, *, writing: bool) -> bool:
    """Whether there is a file with something in it, which calls itself one of answers."""
    try:
        descriptor = open_plain(path, os.O_RDONLY, follow=True)
    except FileNotFoundError:
        if path.is_symlink():  # SQLite would make what it leads to
            raise CacheError(
                f"{path}: this is a link to a file that is not there. Remove it, or name another"
            ) from None
        if writing and not path.parent.is_dir():
            raise CacheError(f"{path}: there is no folder {path.parent}. Make it first") from None
        return False
    except OSError as error:
        raise CacheError(f"{path}: cannot be read ({error.strerror}). Name another file") from error
    try:
        head = os.read(descriptor, 100)
    finally:
        os.close(descriptor)
    if not head or (len(head) == 100 and head.startswith(_MAGIC) and not any(head[60:72])):
        return False  # nothing was written yet: a kill, or `touch`
    if not head.startswith(_MAGIC) or head[68:72] != APPLICATION.to_bytes(4, "big"):
        raise CacheError(
            f"{path}: this is no file of recorded answers, and is left as it is. Name another"
        )
    found = int.from_bytes(head[60:64], "big")
    if found != SCHEMA:
        raise CacheError(
            f"{path}: these answers were recorded by another version of tpvqa (schema {found}; "
            f"this one reads {SCHEMA}). Record them anew in another file"
        )
    return True


def _connected(path: Path, *, writing: bool) -> sqlite3.Connection:
    how = "mode=rwc" if writing else "mode=ro"
    log = Path(f"{path}-wal")
    if not writing and not (log.exists() and log.stat().st_size):
        how += (
            "&immutable=1"  # nobody writes: nothing is put beside it, on a read-only disk neither
        )
    connection = sqlite3.connect(
        f"file:{quote(str(path.absolute()))}?{how}",
        uri=True,
        timeout=PATIENCE,
        isolation_level=None,
        check_same_thread=False,
    )
    connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, 2 * LONGEST)
    connection.setlimit(sqlite3.SQLITE_LIMIT_ATTACHED, int(writing))  # VACUUM needs one
    for pragma in ("trusted_schema = OFF", "cell_size_check = ON", "mmap_size = 0"):
        connection.execute(f"PRAGMA {pragma}")
    if not writing:
        connection.execute("PRAGMA query_only = ON")
    return connection


def _check(path: Path, connection: sqlite3.Connection, *, writing: bool) -> None:
    """See that it holds these tables and nothing else; make them where there is nothing."""
    if writing and not _schema(connection):
        connection.execute("BEGIN EXCLUSIVE")
        try:
            if not _schema(connection):  # nobody else was quicker
                connection.execute(f"PRAGMA application_id = {APPLICATION}")
                connection.execute(f"PRAGMA user_version = {SCHEMA}")
                for table in _TABLES:
                    connection.execute(table)
            connection.execute("COMMIT")
        except BaseException:
            if connection.in_transaction:
                connection.execute("ROLLBACK")
            raise
    if _schema(connection) != sorted(_TABLES):
        raise CacheError(
            f"{path}: it holds other tables than recorded answers do, and is not used. Name another"
        )
    if writing:
        connection.execute("PRAGMA journal_mode = WAL")
        connection.execute("PRAGMA synchronous = NORMAL")


def _schema(connection: sqlite3.Connection) -> list[str]:
    """All that is declared in it; what SQLite makes by itself has no text."""
    rows = connection.execute("SELECT name, sql FROM sqlite_schema LIMIT 50").fetchall()
    made = {f"sqlite_autoindex_{name}_1" for name in ("models", "questions", "answers")}
    return sorted(str(sql) for name, sql in rows if sql is not None or name not in made)


def wrong(path: Path, error: sqlite3.Error | UnicodeDecodeError) -> CacheError | WriteError:
    """What to say where SQLite cannot go on."""
    said, code = str(error), getattr(error, "sqlite_errorcode", 0) & 0xFF
    if code in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
        return CacheError(f"{path}: another process has kept it for {PATIENCE:g} s; wait for it")
    if code in (sqlite3.SQLITE_FULL, sqlite3.SQLITE_READONLY, sqlite3.SQLITE_IOERR):
        return WriteError(f"{path}: cannot be written ({said}). {REMEDY}")
    if code == sqlite3.SQLITE_CANTOPEN:
        return WriteError(f"{path}: cannot be opened ({said}). {REMEDY}")
    return CacheError(f"{path}: the file is damaged ({said}). Remove it, or name another")
