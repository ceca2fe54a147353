"""Keeps what sixty trials come to: `python -m tests.proof.record`.

`test_same_as_before.py` compares with it. To be written again only where trials are meant to come
out otherwise; `git diff` then has to be explained by hand.
"""

import gzip
import json
import tempfile
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from tests.proof.projection import Entry
from tests.proof.running import outcome
from tests.proof.specs import SPECS

RECORD = Path(__file__).parent / "trials.json.gz"


def recorded() -> dict[str, list[Entry]]:
    """What each trial came to when it was recorded, by its name."""
    found: dict[str, list[Entry]] = json.loads(gzip.decompress(RECORD.read_bytes()))
    return found


def ending(entries: Sequence[Entry]) -> str:
    """How a trial ended."""
    _, because, completed, believed, *_ = next(each for each in entries if each[0] == "ended")
    return "believed done and was not" if believed and completed is False else str(because)


def write(outcomes: Mapping[str, Sequence[Entry]], path: Path = RECORD) -> None:
    """Write what trials came to; the same outcomes give the same bytes."""
    text = json.dumps(outcomes, ensure_ascii=False, separators=(",", ":"))
    path.write_bytes(gzip.compress(text.encode(), 9, mtime=0))


def _main() -> None:
    outcomes: dict[str, list[Entry]] = {}
    seconds: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        for spec in SPECS:
            began = time.perf_counter()
            outcomes[spec.name] = outcome(spec, Path(folder) / spec.name)
            seconds[spec.name] = time.perf_counter() - began
            print(f"{seconds[spec.name]:5.1f} s  {spec.name}: {ending(outcomes[spec.name])}")
    write(outcomes)
    endings: Counter[Any] = Counter(map(ending, outcomes.values()))
    monitors: Counter[Any] = Counter(spec.monitor.partition(":")[0] for spec in SPECS)
    for counted in (endings, monitors):
        print(", ".join(f"{name} {count}" for name, count in counted.most_common()))
    print(f"{len(SPECS)} trials, {sum(seconds.values()):.0f} s, {RECORD.stat().st_size:,} bytes")


if __name__ == "__main__":
    _main()
