"""Writing a set of pictures so that it is whole at any moment, however the process ends."""

import fcntl
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tpvqa.errors import PictureSetError, WriteError
from tpvqa.files import clear_parts, make_folder, write_whole
from tpvqa.worlds.pictures import MANIFEST
from tpvqa_household.images.manifest import Manifest, Origin

_REMEDY = "Make room, or mend permissions; the same command goes on with what is there"


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Make a folder where it is not there, and let no other build into it; the lock ends with this
    process, however it ends.

    Raises:
        PictureSetError: Another build is at work there.
        WriteError: The folder cannot be made, or cannot be written to.
    """
    try:
        make_folder(folder)
        lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise PictureSetError(
                    f"{folder}: another build is at work there. Wait for it, or name another folder"
                ) from None
            clear_parts(lock)
            yield
        finally:
            os.close(lock)
    except OSError as error:
        raise WriteError.of(error.filename or folder, error, _REMEDY) from error


def replace(path: Path, data: bytes) -> None:
    """Write a file that is either the old one or the whole new one.

    Raises:
        WriteError: It cannot be written.
    """
    write_whole(path, data, remedy=_REMEDY, durable=True)


def write_manifest(folder: Path, manifest: Manifest) -> None:
    """Write the manifest, one line a picture. Rendered pictures need no word about their origin."""
    document = manifest.model_dump(mode="json")
    for picture, entry in zip(manifest.pictures, document["pictures"], strict=True):
        entry["seen"].sort()
        if picture.origin == Origin():
            del entry["origin"]
    lines = ",\n  ".join(json.dumps(entry) for entry in document.pop("pictures"))
    head = json.dumps(document)[:-1]
    replace(folder / MANIFEST, f'{head}, "pictures": [\n  {lines}\n]}}\n'.encode())
