"""Makes a planned set in a folder, one picture after the other; goes on where it was stopped.

A picture is whole on disk, and in the manifest with its hash, before the next one is begun. Its
file's name tells everything that decides it, so that even one which was written in the moment of
a kill, before the manifest knew of it, is found again. Nothing is ever deleted: what is no longer
wanted is moved into the folder `unused`, and taken back from there when it is wanted again.
"""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from tpvqa.errors import GeneratorError, PictureError, PictureRefused, PictureSetError
from tpvqa.pictures import read_file
from tpvqa.worlds.pictures import MANIFEST, digest
from tpvqa_household.images.manifest import (
    Manifest,
    Origin,
    Picture,
    Shows,
)
from tpvqa_household.images.own_pictures import existing, see_own, was_composed
from tpvqa_household.images.reachable import Reachable
from tpvqa_household.images.recipe import FACTS
from tpvqa_household.images.sources.generator import Drawn, Original
from tpvqa_household.images.sources.picture_file import as_jpeg, read_picture
from tpvqa_household.images.sources.plan import Wanted
from tpvqa_household.images.verify import observations
from tpvqa_household.images.visible import VisibleState, describe
from tpvqa_household.images.writing import alone, replace, write_manifest

_COMMAND = "tpvqa dataset compose"
UNUSED = "unused"
"""Folder, in that of a set, of pictures that are no longer wanted."""
REJECTED = "rejected"
"""Folder of pictures that the user does not want: others are made instead."""


@dataclass
class Composed:
    """What came of composing a set.

    Attributes:
        manifest: The set; None where it has no picture.
        made: How many pictures were made or copied now; the others were there.
        asked: Pictures that servers made now.
        refused: Pictures that a generator would not make, with the reason.
    """

    manifest: Manifest | None = None
    made: int = 0
    asked: int = 0
    refused: list[str] = field(default_factory=list)


def rejected(folder: Path) -> frozenset[str]:
    """The files that the user moved into the folder `rejected` of a set."""
    return frozenset(path.name for path in (folder / REJECTED).glob("*.jpg"))


def pending(wanted: Sequence[Wanted], folder: Path) -> list[Wanted]:
    """The pictures that a composition would make, copy or ask for.

    Raises:
        PictureSetError: The folder holds pictures that were not composed.
    """
    known = _existing(wanted, folder)
    return [one for one in wanted if _there(one, folder, known) is None]


def compose(
    wanted: Sequence[Wanted],
    folder: Path,
    tasks: Sequence[Reachable],
    *,
    progress: Callable[[int, int], None] | None = None,
) -> Composed:
    """Make what is missing of a planned set.

    Args:
        wanted: The set, as `plan` gives it.
        folder: Where it lies or shall lie.
        tasks: Say which actions a picture is an observation of.
        progress: Told the number of pictures done and of all, after each.

    Raises:
        GeneratorError: A generator cannot be used; what was made stays.
        PictureSetError: The folder holds another set, or another build is at work there.
        WriteError: The folder cannot be written to; what was made stays.
    """
    with alone(folder):
        known = _existing(wanted, folder)
        return _Composer(known, folder, tasks).run(wanted, progress or (lambda done, total: None))


class _Composer:
    def __init__(self, known: Mapping[str, Picture], folder: Path, tasks: Sequence[Reachable]):
        self._existing, self._folder, self._tasks = known, folder, tasks
        self._shows: dict[VisibleState, tuple[Shows, ...]] = {}

    def run(self, wanted: Sequence[Wanted], progress: Callable[[int, int], None]) -> Composed:
        self._put_away({one.file for one in wanted})
        composed = Composed()
        done: dict[str, Picture] = {}
        for one in wanted:
            there = _there(one, self._folder, self._existing)
            if there is not None:
                done[one.file] = self._kept(one, there)
        self._write(wanted, done, composed)
        progress(len(done), len(wanted))
        for one in wanted:
            if one.file in done:
                continue
            try:
                drawn = _draw(one)
            except PictureRefused as refused:
                composed.refused.append(f"{one.file}: {refused}")
                continue
            except GeneratorError as error:
                raise GeneratorError(
                    f"{error}. {len(done)} of {len(wanted)} pictures are in {self._folder}; the "
                    "same command goes on from there"
                ) from error
            try:
                data = drawn.data
                if one.kind != "rendered" and drawn.renderer is None:
                    data = as_jpeg(read_picture(data))
            except ValueError as error:
                raise GeneratorError(f"{one.file}: what was made {error}") from error
            replace(self._folder / one.file, data)
            done[one.file] = self._entry(one, data, drawn)
            composed.made += 1
            composed.asked += one.generator is not None and one.generator.remote
            self._write(wanted, done, composed)
            progress(len(done), len(wanted))
        return composed

    def _put_away(self, names: set[str]) -> None:
        unused = self._folder / UNUSED
        away = [path for path in self._folder.glob("*.jpg") if path.name not in names]
        for path in away:
            there = unused / path.name
            if os.path.lexists(there) and not _same(path, there):
                raise PictureSetError(
                    f"{there}: is another picture than {path}, which is no longer wanted and would "
                    "take its place. Move one of them away"
                )
        for path in away:
            unused.mkdir(exist_ok=True)
            path.replace(unused / path.name)

    def _kept(self, one: Wanted, path: Path) -> Picture:
        data = read_file(path)
        known = self._existing.get(one.file)
        if path.parent != self._folder:
            replace(self._folder / one.file, data)
        if known is None:
            return self._entry(one, data, Drawn(data))
        drawn = Drawn(data, known.seen, known.renderer, known.look)
        made = self._entry(one, data, drawn)
        return made.model_copy(
            update={"origin": made.origin.model_copy(update={"cost": known.origin.cost})}
        )

    def _entry(self, one: Wanted, data: bytes, drawn: Drawn) -> Picture:
        width, height = read_picture(data).size
        of = None if one.source is None else one.source.picture
        rendered = of if one.kind == "rendered" or drawn.renderer is not None else None
        visible = one.visible
        if visible not in self._shows:
            self._shows[visible] = observations(visible, self._tasks)
        return Picture(
            file=one.file,
            sha256=digest(data),
            width=width,
            height=height,
            renderer=drawn.renderer or (None if rendered is None else rendered.renderer),
            meshes="held_out" if rendered is None else rendered.meshes,
            seed=None if rendered is None else rendered.seed,
            look=drawn.look if drawn.renderer or rendered is None else rendered.look,
            visible=describe(visible),
            number=one.number,
            state=tuple(atom.pddl() for atom in sorted(one.state)),
            seen=one.seen if drawn.seen is None else drawn.seen,
            shows=self._shows[visible],
            origin=_origin(one),
        )

    def _write(self, wanted: Sequence[Wanted], done: Mapping[str, Picture], to: Composed) -> None:
        if not done:
            (self._folder / MANIFEST).unlink(missing_ok=True)
            return
        to.manifest = Manifest(
            facts=tuple(atom.pddl() for atom in FACTS),
            pictures=tuple(done[one.file] for one in wanted if one.file in done),
        )
        write_manifest(self._folder, to.manifest)


def _existing(wanted: Sequence[Wanted], folder: Path) -> dict[str, Picture]:
    for own in (folder / UNUSED, folder / REJECTED):
        if os.path.lexists(own) and (own.is_symlink() or not own.is_dir()):
            raise PictureSetError(
                f"{own}: has to be a folder, and is a link or a file. Move it away; the same "
                "command then makes the folder where it needs one"
            )
    found = {picture.file: picture for picture in existing(folder, was_composed, _COMMAND)}
    see_own(folder, {*found, *(one.file for one in wanted)}, _COMMAND)
    return found


def _there(one: Wanted, folder: Path, existing: Mapping[str, Picture]) -> Path | None:
    """The whole file of a wanted picture, where there is one."""
    known = existing.get(one.file)
    for path in (folder / one.file, folder / UNUSED / one.file):
        try:
            data = read_file(path)
        except PictureError:
            continue
        if known is not None and digest(data) == known.sha256:
            return path
        if known is None and one.generator is not None and one.generator.remote and _whole(data):
            return path  # no manifest knows it: written in the moment of a kill, or put away
    return None


def _same(one: Path, other: Path) -> bool:
    try:
        return read_file(one) == read_file(other)
    except PictureError:
        return False


def _whole(data: bytes) -> bool:
    try:
        read_picture(data)
    except ValueError:
        return False
    return True


def _draw(one: Wanted) -> Drawn:
    """Make a picture, or read the one that is taken over."""
    if one.kind == "generated":
        assert one.generator is not None
        assert one.seed is not None
        return one.generator.generate(one.prompt, seed=one.seed)
    assert one.source is not None
    try:
        data = read_file(one.source.path)
    except PictureError as error:
        raise PictureSetError(str(error)) from error
    if digest(data) != one.source.sha256:
        raise PictureSetError(f"{one.source.path}: is not what it was when it was listed")
    if one.generator is None:
        return Drawn(data)
    assert one.seed is not None
    original = Original(data, one.prompt, one.source.picture)
    return one.generator.vary(original, seed=one.seed)


def _origin(one: Wanted) -> Origin:
    return Origin(
        kind=one.kind,
        got_for=None if one.label is None else one.label.shows,
        source="" if one.source is None else one.source.name,
        source_sha256="" if one.source is None else one.source.sha256,
        prompt=one.prompt,
        generator="" if one.generator is None else one.generator.name,
        seed=one.seed,
        cost=None if one.generator is None else one.generator.price,
    )
