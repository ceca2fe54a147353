"""What is wrong with what others wrote is said without listing all of it."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from pydantic import ConfigDict, ValidationError

from tpvqa.told import ToldModel, first_fault


class Inner(ToldModel):
    model_config = ConfigDict(extra="forbid")

    numbers: tuple[int, ...] = ()
    shares: dict[str, float] | None = None


class Outer(ToldModel):
    inner: list[Inner]
    last: int = 0


BAD = ["bad"] * 1000
WRONG: list[tuple[Any, tuple[str | int, ...], int]] = [
    ({"inner": BAD}, ("inner", 0), 1),
    ({"inner": [{"numbers": [1, *BAD]}] * 1000}, ("inner", 0, "numbers", 1), 1),
    ({"inner": [{"shares": dict.fromkeys(map(str, range(9)), "bad")}]}, ("inner", 0, "shares"), 1),
    ({"inner": BAD, "last": "bad"}, ("inner", 0), 2),
    ({"inner": [{f"n{number}": 0 for number in range(1000)}]}, ("inner", 0, "n0"), 1000),
    ({"inner": [{"n" * 10_000: 0}]}, ("inner", 0, "n" * 79 + "…"), 1),
]


@pytest.mark.parametrize(("value", "place", "count"), WRONG, ids=range(len(WRONG)))
def test_the_first_fault_is_said(value: Any, place: tuple[str | int, ...], count: int) -> None:
    with pytest.raises(ValidationError) as found:
        Outer.model_validate(value)
    fault = first_fault(found.value)
    assert fault["loc"][: len(place)] == place
    assert fault["msg"]
    assert found.value.error_count() == count


MEASURED = """
import os, resource, sys
from pathlib import Path

from tpvqa.belief import Calibration
from tpvqa.belief.learning.experience import Experience
from tpvqa.belief.calibrating.risk import RiskCalibration
from tpvqa.episodes import read_episode
from tpvqa.errors import TpvqaError
from tpvqa.serving.refusal import Refusal
from tpvqa.serving.wire import read_request
from tpvqa.vlm.chat_completions import read_completion
from tpvqa.worlds.pictures.manifest import Manifest, read_manifest

zeros = "[" + "0," * 300_000 + "0]"
FILES = {
    "calibration": '{"groups":%s}' % zeros,
    "experience": '{"biases":{"a":%s}}' % zeros,
    "risk": '{"wrong":%s}' % zeros.replace("0", "[]"),
    "manifest.json": '{"domain":"d","pictures":%s}' % zeros,
    "episode.jsonl": '{"kind":"plan made","state":%s}\\n' % zeros,
}
folder = Path(sys.argv[1])
for name, text in FILES.items():
    Path(folder, name).write_text(text)
message = '{"model":"m","messages":[{"role":"user","content":%s}]}'
parts = "[" + '{"type":"text","text":0},' * 100_000 + "0]"
READERS = {
    "request": lambda: read_request(b'{"model":"m","messages":%s}' % zeros.encode()),
    "parts": lambda: read_request((message % parts).encode()),
    "reply": lambda: read_completion('{"choices":%s}' % zeros),
    "calibration": lambda: Calibration.load(folder / "calibration"),
    "experience": lambda: Experience.load(folder / "experience"),
    "risk": lambda: RiskCalibration.load(folder / "risk"),
    "manifest": lambda: read_manifest(folder, Manifest, missing="", broken=""),
    "episode": lambda: read_episode(folder),
}
for name, read in READERS.items():
    if os.fork() == 0:
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        try:
            read()
        except (TpvqaError, Refusal) as error:
            assert len(str(error)) < 2000
        more = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
        print(name, more // 1024, flush=True)
        os._exit(0)
    assert os.wait()[1] == 0
"""


def test_no_reader_takes_a_hundred_megabytes_to_refuse_a_few(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", MEASURED, str(tmp_path)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    taken = dict(line.split() for line in done.stdout.splitlines())
    assert len(taken) == 8
    assert {name: size for name, size in taken.items() if int(size) >= 100} == {}
