"""How long `import tpvqa` and `tpvqa --help` take, in fresh processes.

python benchmarks/startup.py
"""

import statistics
import subprocess
import sys
import time

RUNS = 15
TARGETS = {"import tpvqa": 0.3, "tpvqa --help": 0.5}
COMMANDS = {
    "python alone": [sys.executable, "-c", "pass"],
    "import tpvqa": [sys.executable, "-c", "import tpvqa"],
    "tpvqa --help": [sys.executable, "-m", "tpvqa", "--help"],
}


def seconds(command: list[str]) -> float:
    """Wall time of one run."""
    began = time.perf_counter()
    subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
    return time.perf_counter() - began


def main() -> None:
    """Print medians, side by side in one run."""
    taken: dict[str, list[float]] = {name: [] for name in COMMANDS}
    for _ in range(RUNS):
        for name, command in COMMANDS.items():
            taken[name].append(seconds(command))
    print(f"{'':14} {'median':>8} {'best':>8} {'target':>8}   ({RUNS} runs each)")
    for name, times in taken.items():
        target = f"{TARGETS[name]:.1f} s" if name in TARGETS else ""
        print(f"{name:14} {statistics.median(times):7.3f}s {min(times):7.3f}s {target:>8}")


if __name__ == "__main__":
    main()
