"""Several processes that write at once, and one that is killed in the middle."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from tests.vlm.kept.coin import FRIDGE, PLATE, Coin, keeping, said, seen
from tpvqa.vlm.kept import Use
from tpvqa.vlm.kept.upkeep import exported, stats

ROOT = Path(__file__).parents[3]
WRITER = """
import sys
from pathlib import Path
from tests.vlm.kept.coin import FRIDGE, PLATE, Coin, Use, keeping, seen
path, use, number, looks = Path(sys.argv[1]), Use(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4])
vlm = keeping(path, use, Coin(number), b"trial %d" % number)
print("ready", flush=True)
sys.stdin.readline()
for look in range(looks):
    answers = vlm.ask(seen(look, look), [FRIDGE, PLATE])
    print(look, *[answer.p_yes for answer in answers], flush=True)
"""


def writer(path: Path, use: Use, number: int, looks: int) -> "subprocess.Popen[str]":
    command = [sys.executable, "-c", WRITER, str(path), str(use), str(number), str(looks)]
    pipe = subprocess.PIPE
    process = subprocess.Popen(command, cwd=ROOT, stdin=pipe, stdout=pipe, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    return process


def start(*processes: "subprocess.Popen[str]") -> None:
    for process in processes:
        assert process.stdin is not None
        process.stdin.write("\n")
        process.stdin.flush()


def test_several_processes_write_at_once(tmp_path: Path) -> None:
    """Each is told what stands in the file, whoever was the first to ask."""
    path = tmp_path / "answers.db"
    writers = [writer(path, Use.CACHE, number, 400) for number in range(3)]
    start(*writers)
    told = [process.communicate(timeout=120)[0].splitlines() for process in writers]
    assert [process.returncode for process in writers] == [0, 0, 0]
    assert told[0] == told[1] == told[2]
    assert len(told[0]) == 400
    assert stats(path).answers == 800
    vlm = keeping(path, Use.REPLAY, None, b"anybody")
    again = [vlm.ask(seen(look, look), [FRIDGE, PLATE]) for look in range(400)]
    assert told[0] == [f"{look} {a.p_yes} {b.p_yes}" for look, (a, b) in enumerate(again)]


def test_what_was_told_before_a_kill_is_there(tmp_path: Path) -> None:
    """Of a look all answers are written or none, and whoever comes later reads and writes on."""
    path = tmp_path / "answers.db"
    process = writer(path, Use.RECORD, 1, 100_000)
    start(process)
    assert process.stdout is not None
    for _ in range(25):
        process.stdout.readline()
    time.sleep(0.05)
    os.kill(process.pid, signal.SIGKILL)
    told = process.stdout.read().splitlines()
    process.wait()
    last = int(told[-2].split()[0]) if len(told) > 1 else 24
    entries = list(exported(path))
    looks = {entry["picture"] for entry in entries}
    assert len(entries) == 2 * len(looks)
    assert len(looks) >= last + 1
    vlm = keeping(path, Use.REPLAY, None, b"trial 1")
    before = said(vlm.ask(seen(last, last), [FRIDGE, PLATE]))
    coin = Coin()
    going_on = keeping(path, Use.CACHE, coin, b"trial 1")
    assert said(going_on.ask(seen(last, last), [FRIDGE, PLATE])) == before
    assert not coin.asked
    going_on.ask(seen(200_000, 200_000), [FRIDGE])
    assert coin.asked == [FRIDGE.text]
