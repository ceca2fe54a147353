"""Arrays in a file that may come from a stranger: numbers alone, no more than it has room for."""

import io
import zipfile
from collections.abc import Mapping

import numpy as np

from tpvqa_household.embedded.likeness import Floats

MOST_BYTES = 256 * 2**20
_MOST_ARRAYS = 64


def packed(arrays: Mapping[str, Floats]) -> bytes:
    """Arrays as the bytes of an npz file, uncompressed."""
    file = io.BytesIO()
    np.savez(file, allow_pickle=False, **{k: np.asarray(v, np.float32) for k, v in arrays.items()})
    return file.getvalue()


def unpacked(data: bytes) -> dict[str, Floats]:
    """What `packed` gave.

    Nothing is unpickled, nothing decompressed, and no array is made that is larger than its part of
    the file.

    Raises:
        ValueError: It is something else.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            entries = archive.infolist()
            if len(entries) > _MOST_ARRAYS:
                raise ValueError(f"it holds more than {_MOST_ARRAYS} arrays")
            return {each.filename.removesuffix(".npy"): _array(archive, each) for each in entries}
    except (zipfile.BadZipFile, EOFError, NotImplementedError, RuntimeError) as error:
        raise ValueError(f"it is no npz file ({error})") from error


def _array(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> Floats:
    if entry.compress_type != zipfile.ZIP_STORED or entry.file_size > entry.compress_size:
        raise ValueError(f"{entry.filename!r} is compressed")
    file = io.BytesIO(archive.read(entry))
    version = np.lib.format.read_magic(file)
    if version != (1, 0):
        raise ValueError(f"{entry.filename!r} is no plain array")
    shape, by_columns, kind = np.lib.format.read_array_header_1_0(file)
    rest = file.read()
    count = 1
    for length in shape:
        count *= length
    if kind != np.dtype("<f4") or by_columns or min(shape, default=0) < 0:
        raise ValueError(f"{entry.filename!r} holds no 32-bit numbers by rows")
    if count * 4 != len(rest):
        raise ValueError(f"{entry.filename!r} is not as long as it says")
    found: Floats = np.frombuffer(rest, "<f4").reshape(shape)
    if not np.isfinite(found).all():
        raise ValueError(f"{entry.filename!r} holds what is no number")
    return found
