"""How fast the belief monitor thinks: `python benchmarks/belief.py [--out FOLDER]`.

- annotation: what every step of a plan needs, from plans between reachable states.
- check: where in such a plan a state stands that was not met before.
- belief step: what comes of an action, one answer, and the decision (all that the monitor computes
  after an action, planner, world and VLM excluded; of several answers their mean).
- the nearest consistent state of 12,000 facts (all kinds of `benchmarks/nearest.py`).

Each in milliseconds of wall time, over the three tasks and a generated household of some 500 facts.
With --out FOLDER they are written to FOLDER/speed.json, for `tpvqa bench belief --out FOLDER`.
"""

import argparse
import json
import statistics
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import cast

from household_problems import household_problem  # type: ignore[import-not-found]
from nearest import seconds  # type: ignore[import-not-found]

from tpvqa.assembly import Trial
from tpvqa.belief.deciding.annotated import AnnotatedPlan
from tpvqa.config import TaskConfig, TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.monitors import Ask, Monitor, PlanFrom, Step, Verdict
from tpvqa.monitors.protocol import Check
from tpvqa.pddl import State, Task, load_task
from tpvqa.planning import Plan
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.regression import regress
from tpvqa.planning.remembering import Remembering
from tpvqa.tasks import find_task

TASKS = ("clean_dishes", "serve_breakfast", "eat_apple")
FACTS = 500
VLM = "oracle:0.9"
CONSISTENT = "nearest consistent state, 12,000 facts"


@dataclass
class Timed:
    """A monitor whose thinking after actions is timed.

    Attributes:
        inner: The monitor.
        steps: Seconds of each belief step.
        questions: Questions of each.
    """

    inner: Monitor
    steps: list[float] = field(default_factory=list)
    questions: list[int] = field(default_factory=list)

    @property
    def name(self) -> str:
        """As the monitor's."""
        return self.inner.name

    def before(self, step: Step) -> Check:
        """Not timed: what was believed after the last action is believed still."""
        return self.inner.before(step)

    def after(self, step: Step) -> Check:
        """Time what lies between the monitor's requests."""
        check, result = self.inner.after(step), None
        predicting, answering, answers = 0.0, 0.0, 0
        asked = planned = False
        while True:
            began = time.perf_counter()
            try:
                request = check.send(result)
            except StopIteration as end:
                request, verdict = None, cast(Verdict, end.value)
            taken = time.perf_counter() - began
            if asked:
                answering, answers = answering + taken, answers + 1
            elif not planned:  # what follows a plan is its annotation
                predicting += taken
            if request is None:
                self.steps.append(predicting + answering / max(answers, 1))
                self.questions.append(answers)
                return verdict
            asked, planned = isinstance(request, Ask), isinstance(request, PlanFrom)
            result = yield request


def belief_steps(config: TrialConfig, episodes: int) -> list[float]:
    """Seconds of every belief step of some episodes."""
    planner, found = Remembering(FastDownward()), list[float]()
    for episode in range(episodes):
        with Trial(config.but(episode=episode), planner=planner) as trial:
            timed = Timed(trial.monitor)
            trial.monitor = timed
            trial.run(MemoryWriter(resumable=False, keep=False))
            found += timed.steps
    planner.close()
    return found


def reachable(task: Task, count: int, seed: int = 0) -> Iterator[State]:
    """States on random walks, each once."""
    random, seen = Random(seed), set[State]()
    state = task.init
    for step in range(100 * count):
        if state not in seen:
            seen.add(state)
            yield state
            if len(seen) == count:
                return
        actions = [each for each in task.ground_actions() if task.applicable(state, each)]
        state = (
            task.init
            if not actions or step % 30 == 29
            else task.apply(state, random.choice(actions))
        )


def plans(task: Task, count: int) -> list[tuple[State, Plan]]:
    """Plans from states on random walks."""
    planner = FastDownward()
    found = [(state, planner.plan(task, state)) for state in reachable(task, count)]
    planner.close()
    return [(state, plan) for state, plan in found if isinstance(plan, Plan) and plan.actions]


def plan_times(task: Task, count: int) -> tuple[list[float], list[float]]:
    """Seconds of every annotation, and of every check of a new state."""
    annotating, checking = [], []
    states = list(reachable(task, count, seed=1))
    for state, plan in plans(task, max(count // 5, 3)):
        began = time.perf_counter()
        annotated = AnnotatedPlan(task, plan.actions, regress(task, plan.actions, state))
        annotating.append(time.perf_counter() - began)
        for other in states:
            began = time.perf_counter()
            annotated.place(other)
            checking.append(time.perf_counter() - began)
    return annotating, checking


def consistent() -> list[float]:
    """Seconds for 12,000 facts, of each kind of problem its median."""
    return [statistics.median(seconds(12_000, kind)) for kind in ("roomy", "full", "tied")]


def household(folder: Path) -> TrialConfig:
    """A trial in a household of at least `FACTS` facts."""
    shipped = find_task("clean_dishes")
    path = folder / "problem.pddl"
    items, facts = 10, 0
    while facts < FACTS:
        items += 2
        path.write_text(household_problem(items), encoding="utf-8")
        facts = len(load_task(shipped.domain, path).atoms())
    print(f"household: {items} things, {facts} facts")
    files = TaskConfig(
        domain=str(shipped.domain),
        problem=str(path),
        questions=str(shipped.questions),
        world_file=str(shipped.world),
    )
    return TrialConfig(task=files, monitor="belief", vlm=VLM, world="symbolic")


def told(name: str, seconds: Sequence[float]) -> float:
    """Print a line, and give the median in milliseconds."""
    ordered = sorted(1000 * each for each in seconds)
    median, late = statistics.median(ordered), ordered[int(0.95 * (len(ordered) - 1))]
    print(f"{name:44} {median:9.3f} {late:9.3f} {ordered[-1]:9.3f} {len(ordered):7}", flush=True)
    return round(median, 4)


def main() -> None:
    """Print medians, 95% quantiles and the worst."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--episodes", type=int, default=20, help="of every task")
    parser.add_argument("--out", type=Path, help="folder for speed.json")
    given = parser.parse_args()
    common = TrialConfig(monitor="belief", vlm=VLM, world="symbolic")
    found: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        big = household(Path(folder))
        print(f"{'ms':44} {'median':>9} {'95 %':>9} {'worst':>9} {'n':>7}")
        annotating, checking = [], []
        for name in TASKS:
            times = plan_times(load_task(name), 50)
            told(f"annotation of a plan, {name}", times[0])
            told(f"check of a plan, {name}", times[1])
            annotating.append(statistics.median(times[0]))
            checking.append(statistics.median(times[1]))
        found["annotation of a plan, median"] = round(1000 * max(annotating), 4)
        found["check of a plan, median"] = round(1000 * max(checking), 4)
        for name in TASKS:
            config = common.but(task=name)
            told(f"belief step, {name}", belief_steps(config, given.episodes))
        assert big.task.domain is not None
        assert big.task.problem is not None
        times = plan_times(load_task(Path(big.task.domain), Path(big.task.problem)), 15)
        told(f"annotation of a plan, {FACTS} facts", times[0])
        told(f"check of a plan, {FACTS} facts", times[1])
        found["belief step, 500 facts"] = told(
            f"belief step, {FACTS} facts", belief_steps(big, max(given.episodes // 4, 1))
        )
    found[CONSISTENT] = told(CONSISTENT, consistent())
    if given.out is not None:
        given.out.mkdir(parents=True, exist_ok=True)
        (given.out / "speed.json").write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
