"""A user's own record: a table of what a VLM answered, and what was true."""

import csv
import gzip
import re
import zlib
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from io import BytesIO, StringIO
from pathlib import Path

from tpvqa.errors import RecordError, UnknownNameError, cut, shown
from tpvqa.text_files import decoded, read_bytes
from tpvqa.vlm.recorded.answers import Recordings, Row, counted, half_of

LARGEST = 256 << 20
"""Bytes of a table, unpacked."""
NAMES: Mapping[str, tuple[str, ...]] = {
    "fact": ("fact", "predicate"),
    "answer": ("answer", "reply"),
    "truth": ("truth",),
    "model": ("model", "vlm"),
    "environment": ("environment",),
    "kind": ("kind", "way"),
    "p_yes": ("p_yes",),
    "problem": ("problem", "cluster"),
}
"""What the columns are called: in the tables of ViPlan, and in those that `tpvqa vlm compare`
writes. The first three there have to be."""
NEEDED = ("fact", "answer", "truth")
_TRUTHS = {"1": 1, "true": 1, "yes": 1, "0": 0, "false": 0, "no": 0}
_KINDS = {
    "precondition": ("precondition",),
    "alternative": ("precondition",),
    "effect": ("effect",),
    "": ("precondition", "effect"),
}
_PREDICATE = re.compile(r"\s*\(?\s*([^\s(),]+)")


def is_table(name: str) -> bool:
    """Whether something names a table of answers, and no recorded model."""
    return name.lower().endswith((".csv", ".csv.gz"))


def recordings_in(file: str, model: str, domain: str, half: int | None) -> Recordings:
    """The answers of a model that a table holds.

    Args:
        file: The table, with a first line that names the columns (`NAMES`); packed by gzip where
            its name ends so. Rows without a truth, or without a yes or a no, are left out.
        model: Whose answers; none where the table has those of one model alone.
        domain: The domain's name. Where the table tells environments apart, the one of that name
            counts, or else the only one of another name.
        half: Only problems of one half, 0 or 1; None for all.

    Raises:
        RecordError: It is no such table, or does not tell which answers are meant.
        UnknownNameError: It has no answers of that model.
    """
    rows, with_problems = _rows(file)
    known = sorted({row[0] for row in rows})
    if not model and len(known) > 1:
        raise RecordError(
            f"has answers of {len(known)} models: {_listed(known)}; say whose with "
            f"recorded:{file}:MODEL",
            file=file,
        )
    model = model or known[0]
    if model not in known:
        raise UnknownNameError(f"model of {file}", model, known)
    if half is not None and not with_problems:
        raise RecordError(
            f"has no column 'problem' by which answers are halved; leave out ':{half}'", file=file
        )
    places = sorted({row[1] for row in rows if row[0] == model})
    others = [place for place in places if place != "blocksworld"]
    if domain in places or len(places) == 1:
        place = domain if domain in places else places[0]
    elif len(others) == 1:
        place = others[0]
    else:
        raise RecordError(
            f"has answers of {len(places)} environments: {_listed(places)}, none of them "
            f"named as the domain {domain!r}; keep those of one",
            file=file,
        )
    return counted(model, place, (row for row in rows if row[:2] == (model, place)), half)


@cache
def _rows(file: str) -> tuple[tuple[Row, ...], bool]:
    """What a table says, and whether it tells problems apart."""
    reader = csv.reader(StringIO(_text(Path(file)), newline=""), strict=True)
    try:
        columns = _columns(next(reader, []), file)
        rows = tuple(
            row for cells in reader if cells for row in _read(cells, columns, file, reader.line_num)
        )
    except csv.Error as error:
        raise RecordError(f"is no table ({error})", file=file, line=reader.line_num) from error
    if not rows:
        raise RecordError("has no yes or no beside a truth", file=file)
    return rows, "problem" in columns


def _columns(header: Sequence[str], file: str) -> dict[str, int]:
    """Where each column stands."""
    said = [name.strip().lower() for name in header]
    found = {
        name: said.index(other)
        for name, others in NAMES.items()
        for other in others[::-1]
        if other in said
    }
    for name in NEEDED:
        if name not in found:
            called = " or ".join(map(repr, NAMES[name]))
            raise RecordError(
                f"no column is called {called}; the first line has to name the columns, of which "
                f"{', '.join(NEEDED)} have to be there: it says {shown(', '.join(header))}",
                file=file,
                line=1,
            )
    return found


def _read(cells: Sequence[str], columns: Mapping[str, int], file: str, line: int) -> Iterator[Row]:
    """The row of a line, of both kinds where it says none; nothing where an answer is missing."""

    def cell(name: str) -> str:
        place = columns.get(name)
        if place is None:
            return ""
        if place >= len(cells):
            raise RecordError(
                f"has {len(cells)} cells, too few for column {name!r}", file=file, line=line
            )
        return cells[place].strip()

    def wrong(name: str, expected: str) -> RecordError:
        return RecordError(
            f"{name} is {shown(cell(name))}; expected {expected}", file=file, line=line
        )

    reply, truth = cell("answer").lower(), cell("truth").lower()
    if reply not in ("yes", "no") or not truth:
        return
    if truth not in _TRUTHS:
        raise wrong("truth", "1 or 0")
    predicate = _PREDICATE.match(cell("fact"))
    if predicate is None:
        raise wrong("fact", "a predicate, with or without arguments")
    kinds = _KINDS.get(cell("kind").lower())
    if kinds is None:
        raise wrong("kind", "precondition or effect, or no such column")
    p_yes = None
    if cell("p_yes"):
        try:
            p_yes = float(cell("p_yes"))
        except ValueError:
            raise wrong("p_yes", "a number from 0 to 1, or nothing") from None
        if not 0 <= p_yes <= 1:
            raise wrong("p_yes", "a number from 0 to 1, or nothing")
    for kind in kinds:
        yield (
            cell("model"),
            cell("environment"),
            kind,
            predicate[1].lower(),
            _TRUTHS[truth],
            half_of(cell("problem")),
            reply,
            p_yes,
            1,
        )


def _text(path: Path) -> str:
    data = read_bytes(path, RecordError, what="table of answers", largest=LARGEST)
    if path.name.lower().endswith(".gz"):
        try:
            with gzip.open(BytesIO(data)) as packed:
                data = packed.read(LARGEST + 1)
        except (OSError, EOFError, zlib.error) as error:
            raise RecordError(f"cannot be unpacked ({error})", file=path) from error
        if len(data) > LARGEST:
            raise RecordError(f"is larger than {LARGEST >> 20} MB when unpacked", file=path)
    return decoded(data, RecordError, path)


def _listed(names: Sequence[str]) -> str:
    return cut(", ".join(name or "one without a name" for name in names))
