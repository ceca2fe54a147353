"""What recorded episodes tell of faults: losses after a success, too."""

from pathlib import Path

from tests.cli.conftest import Run
from tpvqa.bench.recorded_faults import experience_from

QUIET = ("--world", "symbolic", "--vlm", "oracle", "--monitor", "tpvqa", "--failure", 0)


def test_what_worked_loose_in_recorded_episodes_is_counted(tpvqa: Run, tmp_path: Path) -> None:
    for name, rate in (("firm", 0), ("loose", 0.5)):
        for seed in (1, 2):
            out = f"{name}{seed}"
            tpvqa("run", "eat_apple", *QUIET, "--spontaneous", rate, "--seed", seed, "--out", out)
    told = {
        name: experience_from([tmp_path / f"{name}{seed}" for seed in (1, 2)]).chances().rates
        for name in ("firm", "loose")
    }
    assert told["firm"].spontaneous < 0.01 < 0.1 < told["loose"].spontaneous
