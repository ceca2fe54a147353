"""What lies already where a set is to be made: nothing that was not made there is lost."""

import os
import re
from collections.abc import Callable
from pathlib import Path

from tpvqa.errors import PictureError, PictureSetError, shown
from tpvqa.pictures import read_file
from tpvqa.worlds.pictures import MANIFEST, digest
from tpvqa.worlds.pictures.manifest import read_manifest
from tpvqa_household.images.manifest import BROKEN, Manifest, Origin, Picture

_ELSEWHERE = "Name another folder"
_BUILT = re.compile(r"[0-9a-f]{8}-[0-9]+-([0-9a-f]{8})\.jpg")
_COMPOSED = re.compile(
    r"[a-z0-9_]+-[a-z0-9_]+-(success|failure)-(photo|variation|generated)-[0-9a-f]{12}\.jpg"
)


def existing(folder: Path, made: Callable[[Picture], bool], command: str) -> tuple[Picture, ...]:
    """The pictures that the manifest of a folder lists; none where it has none.

    Args:
        folder: Where a set is to be made.
        made: Whether the command can have made a picture that is listed.
        command: Which makes the set, for messages.

    Raises:
        PictureSetError: The manifest cannot be read, or is of a set that the command did not make.
    """
    if not os.path.lexists(folder / MANIFEST):
        return ()
    broken = f"{_ELSEWHERE} if it is not of `{command}`. {BROKEN}"
    manifest = read_manifest(folder, Manifest, missing=_ELSEWHERE, broken=broken)
    other = next((one for one in manifest.pictures if not made(one)), None)
    if manifest.domain != "household" or other is not None:
        what = "" if other is None else f" ({shown(other.file)} is none of its pictures)"
        raise PictureSetError(
            f"{folder}: holds a set that `{command}` did not make{what}, and that would be lost. "
            f"{_ELSEWHERE}"
        )
    return manifest.pictures


def see_own(folder: Path, listed: set[str], command: str) -> None:
    """See that of the pictures in a folder each is listed, or named as the commands name theirs.

    A picture that was written in the moment of a kill is not listed.

    Raises:
        PictureSetError: One is neither.
    """
    for path in sorted(folder.glob("*.jpg")):
        if path.name not in listed and not left_behind(path) and not _COMPOSED.fullmatch(path.name):
            raise PictureSetError(
                f"{folder}: holds {shown(path.name)}, which `{command}` did not make. Move it "
                "away, or name another folder"
            )


def left_behind(path: Path) -> bool:
    """Whether a picture is one that was built: its name tells what it holds."""
    name = _BUILT.fullmatch(path.name)
    try:
        return name is not None and digest(read_file(path)).startswith(name[1])
    except PictureError:
        return False


def was_built(picture: Picture) -> bool:
    """Whether a picture that a manifest lists can have been built."""
    name = _BUILT.fullmatch(picture.file)
    return picture.origin == Origin() and name is not None and picture.sha256.startswith(name[1])


def was_composed(picture: Picture) -> bool:
    """Whether a picture that a manifest lists can have been composed."""
    if picture.origin == Origin():
        return False
    if picture.origin.kind == "rendered":
        return picture.file == picture.origin.source
    return _COMPOSED.fullmatch(picture.file) is not None
