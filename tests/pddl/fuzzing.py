"""Reads mutants of PDDL as the worker does, in a process of its own; prints what broke.

Called with the first seed and the number of mutants; no translator comes into the tests' process.
"""

import sys
import traceback

from tests.mutants import mutant
from tests.pddl.feature_domains import SAMPLES
from tpvqa.pddl.worker.known_task import KnownTask
from tpvqa.pddl.worker.reading_error import ReadingError


def texts(seed: int) -> tuple[str, str]:
    """A domain and a problem, one of them with something wrong."""
    sample = SAMPLES[seed % len(SAMPLES)]
    if seed // len(SAMPLES) % 3:
        return mutant(sample.domain, seed), sample.problem
    return sample.domain, mutant(sample.problem, seed)


def main(first: int, count: int) -> None:
    """Read them all."""
    read = refused = 0
    for seed in range(first, first + count):
        try:
            KnownTask(*texts(seed))
            read += 1
        except ReadingError as error:
            refused += 1
            if len(error.message) > 2000 or "\n" in error.message or error.line is None:
                print(f"seed {seed}: {error.line}: {error.message[:300]!r}")
        except Exception:  # noqa: BLE001
            print(f"seed {seed}: {traceback.format_exc(limit=-3)}")
    print(f"{read} read, {refused} refused", file=sys.stderr)


if __name__ == "__main__":
    sys.setrecursionlimit(20_000)
    main(int(sys.argv[1]), int(sys.argv[2]))
