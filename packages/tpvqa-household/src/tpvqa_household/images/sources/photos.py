"""A folder of the user's photos: which action and outcome each of them shows."""

import csv
import re
from collections import Counter
from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass, field
from pathlib import Path

from tpvqa.errors import PhotosError, PictureError, WorldError, suggestion_or_list
from tpvqa.files import read_plain
from tpvqa.pddl import Atom, State
from tpvqa.pictures import read_file
from tpvqa.worlds.pictures import digest
from tpvqa.worlds.pictures.manifest import fact
from tpvqa_household.images.manifest import OUTCOMES
from tpvqa_household.images.recipe import FACTS
from tpvqa_household.images.sources.labels import Label, file_name
from tpvqa_household.images.sources.picture_file import read_picture
from tpvqa_household.images.visible import describe, visible_state

SUFFIXES = frozenset(
    (".jpg", ".jpeg", ".png", ".webp", ".bmp", ".gif", ".tif", ".tiff", ".heic", ".heif")
)
COLUMNS = ("file", "task", "action", "outcome", "facts")
_LARGEST = 16 * 2**20  # bytes of a table; a device has no end
SHOWN = 10
"""Faults that are listed; more are counted."""


@dataclass(frozen=True)
class Photo:
    """A photo and what it shows.

    Attributes:
        path: The file.
        name: The file below the folder of photos.
        label: The action and outcome.
        state: The facts that are true in it.
        sha256: Of the file.
    """

    path: Path
    name: str
    label: Label
    state: State = field(repr=False)
    sha256: str = field(repr=False)


@dataclass(frozen=True, slots=True)
class Shelf:
    """The photos of one action and outcome.

    Attributes:
        label: The action and outcome.
        photos: How many there are.
        wanted: How many the set has room for.
    """

    label: Label
    photos: int
    wanted: int

    @property
    def missing(self) -> int:
        """How many more are wanted."""
        return max(0, self.wanted - self.photos)


def stock(photos: Sequence[Photo], labels: Sequence[Label], *, wanted: int = 10) -> list[Shelf]:
    """How many photos there are and are missing, action by action and outcome by outcome."""
    counts = Counter(photo.label.shows for photo in photos)
    return [Shelf(label, counts[label.shows], wanted) for label in labels]


def read_photos(folder: Path, labels: Sequence[Label], *, table: Path | None = None) -> list[Photo]:
    """Read the photos of a folder, labelled by subfolders or by a table.

    Subfolders are `<action>/<outcome>`, or `<task>/<action>/<outcome>` where several tasks have
    the action; an action is written as in the manifest, `wash(plate, sink)`, or `wash_plate_sink`.
    What is true after a success is the plan's next state; after a failure, the state before the
    action. A table is CSV with the columns file, task, action, outcome and, where something else
    is true, facts: PDDL atoms that say all of the things that they name; of other things the
    plan's state holds.

    Args:
        folder: The photos.
        labels: The actions and outcomes that there are.
        table: The CSV file; its files are named as seen from the folder.

    Raises:
        PhotosError: A photo cannot be read, or its label is none; names the place.
    """
    if not folder.is_dir():
        raise PhotosError("there is no such folder of photos", file=folder)
    named = _by_folder(folder) if table is None else _by_table(table, folder)
    found: list[Photo] = []
    faults: list[PhotosError] = []
    known: dict[tuple[str, str], str] = {}
    for claim in named:
        try:
            photo = _photo(claim, labels)
            first = known.setdefault((str(photo.label), photo.sha256), photo.name)
            if first != photo.name:
                raise claim.wrong(f"the same photo as {first}, for the same label. Keep one")
            found.append(photo)
        except PhotosError as fault:
            faults.append(fault)
    if faults:
        first_fault = faults[0]
        more = "".join(f"\n{fault}" for fault in faults[1:SHOWN])
        if len(faults) > SHOWN:
            more += f"\nand {len(faults) - SHOWN} more"
        raise PhotosError(first_fault.message + more, file=first_fault.file, line=first_fault.line)
    return found


@dataclass(frozen=True, slots=True)
class _Claim:
    """What a folder or a line of the table says of a file."""

    folder: Path
    name: str
    task: str
    action: str
    outcome: str
    facts: str = ""
    table: Path | None = None
    line: int | None = None

    @property
    def path(self) -> Path:
        return self.folder / self.name

    def wrong(self, message: str) -> PhotosError:
        if self.table is None:
            return PhotosError(message, file=self.path)
        return PhotosError(message, file=self.table, line=self.line)


def _by_folder(folder: Path) -> Iterator[_Claim]:
    for path in sorted(folder.rglob("*")):
        below = path.relative_to(folder)
        hidden = any(part.startswith(".") for part in below.parts)
        if hidden or path.suffix.lower() not in SUFFIXES or path.is_dir():
            continue
        try:
            str(below).encode()  # as the manifest names it
        except UnicodeEncodeError:
            said = f"{ascii(str(below))[1:-1]}: the name is not UTF-8. Rename it"
            raise PhotosError(said, file=folder) from None
        parts = below.parts[:-1]
        if not 2 <= len(parts) <= 3:
            raise PhotosError(
                "lies in no folder that says what it shows. Put it into <action>/<outcome>/ or "
                "<task>/<action>/<outcome>/, e.g. wash_plate_sink/failure/, or name the labels "
                "in a table (--photo-labels)",
                file=path,
            )
        task = parts[0] if len(parts) == 3 else ""
        yield _Claim(folder, below.as_posix(), task, parts[-2], parts[-1].lower())


def _by_table(table: Path, folder: Path) -> Iterator[_Claim]:
    try:
        text = read_plain(table, most=_LARGEST).decode("utf-8-sig")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise PhotosError(f"cannot be read ({reason})", file=table) from error
    reader = csv.DictReader(text.splitlines())
    try:
        columns = [(name or "").strip().lower() for name in reader.fieldnames or ()]
    except csv.Error as error:
        raise PhotosError(f"is no CSV ({error})", file=table, line=1) from error
    absent = [name for name in ("file", "action", "outcome") if name not in columns]
    strange = [name for name in columns if name not in COLUMNS]
    if absent or strange:
        what = f"no column {absent[0]!r}" if absent else f"unknown column {strange[0]!r}"
        raise PhotosError(f"{what}; the columns are {', '.join(COLUMNS)}", file=table, line=1)
    twice = next((name for name in columns if columns.count(name) > 1), None)
    if twice is not None:
        raise PhotosError(f"the column {twice!r} is there twice; keep one", file=table, line=1)
    reader.fieldnames = columns
    for row in _rows(reader, table):
        if None in row:
            raise PhotosError(
                f"more cells than the {len(columns)} columns; put cells with commas in quotes",
                file=table,
                line=reader.line_num,
            )
        entry = {key: (row.get(key) or "").strip() for key in COLUMNS}
        if not any(entry.values()):
            continue
        yield _Claim(
            folder=folder,
            name=entry["file"],
            task=entry["task"],
            action=entry["action"],
            outcome=entry["outcome"].lower(),
            facts=entry["facts"],
            table=table,
            line=reader.line_num,
        )


def _rows(reader: "csv.DictReader[str]", table: Path) -> Iterator[dict[str, str]]:
    try:
        yield from reader
    except csv.Error as error:
        raise PhotosError(f"is no CSV ({error})", file=table, line=reader.line_num + 1) from error


def _photo(claim: _Claim, labels: Sequence[Label]) -> Photo:
    label = _label(claim, labels)
    state = _state(claim, label)
    try:
        data = read_file(claim.name, inside=claim.folder)
        read_picture(data)
    except PictureError as error:
        named = "" if claim.table else f"{claim.path}: "
        raise claim.wrong(str(error).removeprefix(named)) from error
    except ValueError as error:
        raise claim.wrong(f"{claim.name}: {error}") from error
    return Photo(claim.path, claim.name, label, state, digest(data))


def _label(claim: _Claim, labels: Sequence[Label]) -> Label:
    if claim.outcome not in OUTCOMES:
        raise claim.wrong(f"{claim.outcome!r} is no outcome; write success or failure")
    tasks = dict.fromkeys(label.shows.task for label in labels)
    if claim.task and claim.task not in tasks:
        raise claim.wrong(f"there is no task {claim.task!r}{suggestion_or_list(claim.task, tasks)}")
    of_task = [label for label in labels if claim.task in ("", label.shows.task)]
    wanted = file_name(claim.action)
    found = [
        label
        for label in of_task
        if file_name(label.shows.action) == wanted and label.shows.outcome == claim.outcome
    ]
    if not found:
        actions = dict.fromkeys(file_name(label.shows.action) for label in of_task)
        raise claim.wrong(
            f"no plan has the action {claim.action!r}{suggestion_or_list(wanted, actions)}"
        )
    if len(found) > 1:
        both = " and ".join(label.shows.task for label in found)
        raise claim.wrong(
            f"{claim.action} is an action of {both}, where other things are true. Say which: a "
            f"folder {found[0].shows.task}/{claim.action}/{claim.outcome}/, or the column task"
        )
    return found[0]


def _state(claim: _Claim, label: Label) -> State:
    if not claim.facts:
        return label.state
    atoms = _facts(claim)
    strange = [atom for atom in sorted(atoms) if atom not in FACTS]
    if strange:
        known = [atom.pddl() for atom in FACTS]
        raise claim.wrong(
            f"{strange[0].pddl()} is no fact{suggestion_or_list(strange[0].pddl(), known)}"
        )
    state = _changed(label.state, atoms)
    try:
        visible = visible_state(state)
    except WorldError as error:
        raise claim.wrong(f"the facts are no state of the kitchen: {error}") from error
    if visible not in label.possible:
        possible = sorted(describe(state) for state in label.possible)
        raise claim.wrong(
            f"the facts look like: {describe(visible)}, which is not seen after {claim.outcome} of "
            f"{label.shows.action}. Possible: {'; '.join(possible)}"
        )
    return state


def _facts(claim: _Claim) -> set[Atom]:
    """The facts of a cell, in parentheses or apart by semicolons."""
    parts = re.split(r"(?<=\))|;", claim.facts)
    try:
        return {Atom.parse(fact(part.strip())) for part in parts if part.strip()}
    except ValueError as error:
        raise claim.wrong(f"column facts: {error}") from error


def _changed(usual: State, facts: Set[Atom]) -> State:
    """A state in which the facts hold, and of other things what usually does."""
    moved = any(atom.predicate == "near" for atom in facts)
    things = {atom.arguments[0] for atom in facts if atom.predicate not in ("near", "free")}
    kept = {
        atom
        for atom in usual
        if (not moved if atom.predicate == "near" else atom.arguments[0] not in things)
    }
    state = {atom for atom in facts | kept if atom.predicate != "free"}
    full = {atom.arguments[1] for atom in state if atom.predicate == "in_hand"}
    free = {atom for atom in FACTS if atom.predicate == "free" and atom.arguments[0] not in full}
    return frozenset(state | free)
