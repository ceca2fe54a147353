"""How often the rover of examples/numbers gets there: monitors and answers side by side.

python -m benchmarks.numbers [SEEDS]
"""

import sys
from collections import Counter
from pathlib import Path

from tpvqa.assembly import Trial
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.events.events import Acted, Asked, Ended
from tpvqa.pddl import State, Task
from tpvqa.planning import PlanningResult
from tpvqa.planning.unified_engine import UnifiedEngine

ROVER = Path(__file__).parents[1] / "examples" / "numbers" / "rover"
LIMIT = 5.0
CELLS = (
    ("none", "1.0"),
    ("tpvqa", "1.0"),
    ("tpvqa", "0.95"),
    ("tpvqa", "0.9"),
    ("tpvqa:3", "0.9"),
    ("tpvqa:5", "0.9"),
)


class Known(UnifiedEngine):
    """Aries, which plans from no state twice and has five seconds for it."""

    def __init__(self) -> None:
        super().__init__("aries")
        self._known: dict[object, PlanningResult] = {}

    def plan(
        self, task: Task, state: State | None = None, *, timeout: float | None = None
    ) -> PlanningResult:
        """A plan, from memory where it was asked for before."""
        key = task.key, state
        if key not in self._known:
            self._known[key] = super().plan(task, state, timeout=LIMIT)
        return self._known[key]


def configuration(world: str, monitor: str, right: str) -> TrialConfig:
    """What a cell's trials are made from."""
    task = {
        "domain": str(ROVER / "domain.pddl"),
        "problem": str(ROVER / "problem.pddl"),
        "questions": str(ROVER / "questions.yaml"),
        "world_file": str(ROVER / world),
    }
    parts = {"planner": "up:aries", "monitor": monitor, "vlm": f"oracle:{right}"}
    return TrialConfig.model_validate(
        {"task": task, **{name: {"spec": spec} for name, spec in parts.items()}}
    )


def main(seeds: int) -> None:
    """Print a line for each cell."""
    planner = Known()
    for world in ("world.yaml", "world-sensed.yaml"):
        for monitor, right in CELLS:
            config, ends, asked, acted = configuration(world, monitor, right), Counter[str](), 0, 0
            for seed in range(1, seeds + 1):
                writer = MemoryWriter()
                with Trial(config.but(seed=seed), planner=planner) as trial:
                    trial.run(writer)
                end = writer.events[-1]
                assert isinstance(end, Ended)
                wrongly = "wrongly " if end.believed_goal and not end.completed else ""
                ends["reached" if end.completed else wrongly + end.because] += 1
                asked += sum(len(e.questions) for e in writer.events if isinstance(e, Asked))
                acted += sum(isinstance(e, Acted) for e in writer.events)
            print(
                f"{world:18} {monitor:8} {right:5} reached {ends['reached'] / seeds:.2f}  "
                f"{asked / seeds:.0f} questions  {acted / seeds:.1f} actions  {dict(ends)}",
                flush=True,
            )
    planner.close()


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 50)
