"""Folders that `tpvqa train embedded` did not write, or that were damaged since."""

import hashlib
import io
import json
import pickle
import shutil
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpvqa.errors import AnswerError
from tpvqa_household.embedded import EmbeddedVLM
from tpvqa_household.embedded.taught.arrays import packed, unpacked
from tpvqa_household.embedded.taught.vlm import TaughtVLM

Arrays = dict[str, Any]


def rewritten(folder: Path, data: bytes) -> None:
    """Other heads, of which the description says that they are its own."""
    (folder / "heads.npz").write_bytes(data)
    told = json.loads((folder / "taught.json").read_text())
    told["sha256"]["heads.npz"] = hashlib.sha256(data).hexdigest()
    (folder / "taught.json").write_text(json.dumps(told))


def changed(change: Callable[[Arrays], object]) -> Callable[[Path], None]:
    def apply(folder: Path) -> None:
        arrays: Arrays = unpacked((folder / "heads.npz").read_bytes())
        change(arrays)
        rewritten(folder, packed(arrays))

    return apply


def described(change: Callable[[dict[str, Any]], object]) -> Callable[[Path], None]:
    def apply(folder: Path) -> None:
        told = json.loads((folder / "taught.json").read_text())
        change(told)
        (folder / "taught.json").write_text(json.dumps(told))

    return apply


class _Runs:
    def __reduce__(self) -> Any:
        return (exec, ("raise SystemExit('code of a stranger was run')",))


def with_a_pickle(folder: Path) -> None:
    file = io.BytesIO()
    np.savez(file, weights=np.array([_Runs()], object))
    rewritten(folder, file.getvalue())


def compressed(folder: Path) -> None:
    file = io.BytesIO()
    np.savez_compressed(file, weights=np.zeros((3000, 3000), np.float32))
    rewritten(folder, file.getvalue())


def larger_than_it_is(folder: Path) -> None:
    header = io.BytesIO()
    shape = {"descr": "<f4", "fortran_order": False, "shape": (2**20, 2**20)}
    np.lib.format.write_array_header_1_0(header, shape)
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("weights.npy", header.getvalue() + b"0000")
    rewritten(folder, file.getvalue())


def linked(folder: Path) -> None:
    shutil.move(folder / "heads.npz", folder / "elsewhere.npz")
    (folder / "heads.npz").symlink_to(folder / "elsewhere.npz")


BROKEN: dict[str, Callable[[Path], object]] = {
    "no folder": lambda folder: shutil.rmtree(folder),
    "no heads": lambda folder: (folder / "heads.npz").unlink(),
    "a link": linked,
    "torn": lambda folder: (folder / "heads.npz").write_bytes(b"PK\3\4 torn"),
    "torn, and so described": lambda folder: rewritten(folder, b"PK\3\4 torn"),
    "a pickle": with_a_pickle,
    "a pickle alone": lambda folder: rewritten(folder, pickle.dumps(_Runs())),
    "compressed": compressed,
    "larger than it is": larger_than_it_is,
    "no number": changed(lambda a: a["bias"].__class__ and a.update(bias=a["bias"] * np.nan)),
    "other shapes": changed(lambda a: a.update(weights=a["weights"][:, 1:])),
    "an edge at nothing": changed(lambda a: a.update({"known.edge": np.zeros((), np.float32)})),
    "too few heads": described(lambda told: told["questions"].append("is cat there")),
    "no questions": described(lambda told: told.update(questions=[])),
    "questions of another kind": described(lambda told: told.update(questions=[1, 2])),
    "another schema": described(lambda told: told.update(schema=9)),
    "another network": described(lambda told: told["sha256"].update({"frozen.onnx": "0" * 64})),
    "no JSON": lambda folder: (folder / "taught.json").write_text("{"),
    "a list": lambda folder: (folder / "taught.json").write_text("[]"),
    "deep JSON": lambda folder: (folder / "taught.json").write_text("[" * 100_000),
}


@pytest.mark.parametrize("name", BROKEN)
def test_it_is_refused_in_a_sentence(name: str, taught: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(taught, tmp_path / "lamps"))
    BROKEN[name](folder)
    vlm = EmbeddedVLM.from_spec(str(folder))
    assert isinstance(vlm, TaughtVLM)
    with pytest.raises(AnswerError, match="tpvqa train embedded"):
        vlm.check()


@settings(max_examples=50, deadline=None)
@given(st.data())
def test_whatever_bytes_are_changed_nothing_else_is_raised(data: st.DataObject) -> None:
    whole = packed({"a": np.arange(6, dtype=np.float32).reshape(2, 3), "b": np.ones(2, np.float32)})
    spoilt = bytearray(whole)
    for place in data.draw(st.lists(st.integers(0, len(whole) - 1), min_size=1, max_size=6)):
        spoilt[place] = data.draw(st.integers(0, 255))
    try:
        found = unpacked(bytes(spoilt[: data.draw(st.integers(0, len(whole)))]))
    except ValueError:
        return
    assert all(np.isfinite(each).all() for each in found.values())


def test_a_description_that_is_no_json_is_told_in_words(taught: Path, tmp_path: Path) -> None:
    folder = shutil.copytree(taught, tmp_path / "torn")
    (folder / "taught.json").write_text('{\n "schema": ')
    with pytest.raises(AnswerError, match="is no JSON: line 2, expecting value") as told:
        TaughtVLM(folder).check()
    assert "JSONDecodeError" not in str(told.value)
