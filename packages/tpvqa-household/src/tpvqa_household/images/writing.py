"""Writing a set of pictures so that it is whole at any moment, however the process ends."""

import fcntl
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tpvqa.errors import PictureSetError
from tpvqa.worlds.pictures import MANIFEST
from tpvqa_household.images.manifest import Manifest, Origin


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Let no other build into a folder; the lock ends with this process, however it ends.

    Raises:
        PictureSetError: Another build is at work there.
    """
    lock = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    except BlockingIOError:
        raise PictureSetError(
            f"{folder}: another build is at work there. Wait for it, or name another folder"
        ) from None
    finally:
        os.close(lock)


def replace(path: Path, data: bytes) -> None:
    """Write a file that is either the old one or the whole new one."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with temporary.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


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
