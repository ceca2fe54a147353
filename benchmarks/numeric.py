"""How often tasks with numbers get there: monitors and answers side by side.

python -m benchmarks.numeric rover|aircraft [SEEDS [ENGINE]]

The rover has questions and world files of its own. For the aircraft nobody wrote any: it is tried
without, and with questions as `tpvqa questions --draft` makes them.
"""

import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from tpvqa.assembly import Trial
from tpvqa.config import TrialConfig
from tpvqa.drafting.draft import draft
from tpvqa.episodes import MemoryWriter
from tpvqa.events.events import Acted, Asked, Ended
from tpvqa.pddl import load_task
from tpvqa.planning import Planner
from tpvqa.planning.remembering import remembering
from tpvqa.planning.unified_engine import UnifiedEngine

TASKS = Path(__file__).parents[1] / "examples" / "numbers"
LIMIT = 5.0
"""Seconds for a plan."""
CELLS = {
    "rover": (
        ("none", "oracle:1.0"),
        ("tpvqa", "oracle:1.0"),
        ("tpvqa", "oracle:0.95"),
        ("tpvqa", "oracle:0.9"),
        ("tpvqa:3", "oracle:0.9"),
        ("tpvqa:5", "oracle:0.9"),
        ("tpvqa:any", "oracle:1.0"),
        ("tpvqa:5:any", "oracle:0.9"),
    ),
    "aircraft": (
        ("none", "oracle:1.0"),
        ("tpvqa", "oracle:1.0"),
        ("tpvqa", "oracle:0.9"),
        ("tpvqa", "oracle:0.9:0:0.74"),
        ("tpvqa", "flawed:late:0.9"),
        ("tpvqa:5", "oracle:0.9"),
        ("tpvqa:5", "oracle:0.9:0:0.74"),
        ("tpvqa:5", "flawed:late:0.9"),
        ("tpvqa:any", "oracle:1.0"),
        ("tpvqa:5:any", "oracle:0.9"),
        ("tpvqa:5:any", "oracle:0.9:0:0.74"),
    ),
}


def configurations(name: str, folder: Path) -> Iterator[tuple[str, dict[str, str]]]:
    """The files of a task, and what each choice of them is called."""
    files = {part: str(TASKS / name / f"{part}.pddl") for part in ("domain", "problem")}
    if name == "rover":
        questions = str(TASKS / name / "questions.yaml")
        for world in ("world.yaml", "world-sensed.yaml"):
            world_file = str(TASKS / name / world)
            yield world, {**files, "questions": questions, "world_file": world_file}
        return
    yield "no questions", files
    task = load_task(Path(files["domain"]), Path(files["problem"]))
    drafted = folder / "questions.yaml"
    drafted.write_text(draft(task))
    yield "drafted questions", {**files, "questions": str(drafted)}


def configuration(files: dict[str, str], monitor: str, vlm: str) -> TrialConfig:
    """What a cell's trials are made from."""
    planner = {"spec": "up:aries", "timeout": LIMIT}
    return TrialConfig.model_validate(
        {"task": files, "planner": planner, "monitor": {"spec": monitor}, "vlm": {"spec": vlm}}
    )


def main(name: str, seeds: int = 50, engine: str = "aries") -> None:
    """Print a line for each cell."""
    planner = remembering(UnifiedEngine(engine))
    with TemporaryDirectory() as folder:
        for called, files in configurations(name, Path(folder)):
            for monitor, vlm in CELLS[name]:
                print(f"{called:18} {monitor:11} {vlm:17} ", end="", flush=True)
                print(of_cell(configuration(files, monitor, vlm), planner, seeds), flush=True)
    planner.close()


def of_cell(config: TrialConfig, planner: Planner, seeds: int) -> str:
    """What the trials of one cell came to."""
    ends, asked, acted = Counter[str](), 0, 0
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
    return (
        f"reached {ends['reached'] / seeds:.2f}  {asked / seeds:.0f} questions  "
        f"{acted / seeds:.1f} actions  {dict(ends)}"
    )


if __name__ == "__main__":
    task, *rest = sys.argv[1:] or ["rover"]
    main(task, int(rest[0]) if rest else 50, rest[1] if rest[1:] else "aries")
