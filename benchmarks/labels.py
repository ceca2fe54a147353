"""What 60 labels are worth: `python benchmarks/labels.py [--trials N] [--out FOLDER]`.

Trials of a household task in a simulated world, with the noise model oracle:0.8 and an uncalibrated
belief, are written as a robot would write them: without the truth. A calibration is learnt

- from so many labels, given by the truth in the order in which `tpvqa label` asks for them;
- from no label, by what came before and after (`labelling.inferring`);
- from the truth about every answer;
- from nothing (the default).

With each of them other trials are run, all with the same faults. Printed are completion, questions
and actions of a trial, with the difference of completion to that by the truth.
"""

import argparse
import json
import tempfile
from collections.abc import Iterator
from pathlib import Path
from statistics import fmean

from tpvqa.belief import Calibration
from tpvqa.bench.cell import Cell
from tpvqa.bench.labelled_episodes import label_episodes
from tpvqa.bench.stage import stage
from tpvqa.bench.statistics import paired, wilson
from tpvqa.config import TrialConfig
from tpvqa.episodes import EpisodeWriter
from tpvqa.episodes.log import LOG
from tpvqa.labelling import Session

OTHER_SEEDS = 10_000
Truths = dict[tuple[str, int, str], bool]


def record(cell: Cell, common: TrialConfig, count: int, folder: Path) -> list[Path]:
    """Write so many episodes."""
    here, folders = stage(cell.task), []
    for episode in range(count):
        folders.append(folder / f"{episode:03}")
        with here.trial(cell.config(common, episode)) as trial:
            writer = EpisodeWriter(folders[-1], durable=False)
            trial.run(writer)
            writer.close()
    return folders


def as_a_robot(folder: Path) -> None:
    """Take out of a log what a robot does not know."""
    events = [json.loads(line) for line in (folder / LOG).read_text().splitlines()]
    for event in events:
        for name in ("truth", "goal_holds", "completed", "snapshot"):
            event.pop(name, None)
    (folder / LOG).write_text("".join(json.dumps(event) + "\n" for event in events))


def label(folders: list[Path], truths: Truths, count: int) -> Iterator[str]:
    """Answer what `tpvqa label` asks, as often as is wanted; tells how it goes."""
    with Session(folders) as session:
        for number in range(count):
            if session.now is None:
                return
            asking = session.now
            look = asking.of_vlm[0].look
            session.say("yes" if truths[str(asking.episode), look, asking.text] else "no")
            if (number + 1) % 20 == 0:
                standing = session.progress.standing
                yield f"{number + 1:4} labels: ±{standing.error:.3f}, enough: {standing.enough}"


def run(cell: Cell, common: TrialConfig, known: Calibration | None, trials: int):  # type: ignore[no-untyped-def]
    """Run the trials that are compared."""
    here = stage(cell.task)
    rows = [
        here.run_learning(cell, common, episode, calibration=known)[0] for episode in range(trials)
    ]
    broken = [row.error for row in rows if row.error]
    assert not broken, broken[0]
    return rows


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--task", default="serve_breakfast")
    parser.add_argument("--vlm", default="oracle:0.8")
    parser.add_argument("--episodes", type=int, default=12, help="that are recorded")
    parser.add_argument("--labels", type=int, default=60)
    parser.add_argument("--trials", type=int, default=60, help="with each calibration")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, help="folder to keep episodes and calibrations in")
    given = parser.parse_args()
    cell = Cell(given.task, "belief", given.vlm, "symbolic")
    common = TrialConfig(seed=given.seed)
    found: dict[str, Calibration | None] = {"nothing (default)": None}
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.out or Path(temporary)
        away = common.but(seed=given.seed + OTHER_SEEDS)
        folders = record(cell, away, given.episodes, folder)
        true = label_episodes(folders)
        found["the truth"] = true.fit()
        truths = {(row.trial, row.look, row.text): row.truth for row in true.rows}
        for each in folders:
            as_a_robot(each)
        found["no label"] = label_episodes(folders).fit()
        for line in label(folders, truths, given.labels):
            print(line)
        found[f"{given.labels} labels"] = label_episodes(folders).fit()
        if given.out is not None:
            for name, calibration in found.items():
                if calibration is not None:
                    calibration.save(given.out / f"{name}.json".replace(" ", "-"))
    print(f"\n{'learnt from':20}{'answers':>8}{'yes if true':>13}{'yes if false':>14}", end="")
    print(f"{'completed':>11}{'95%':>13}{'− truth':>9}{'questions':>11}{'actions':>9}")
    results = {name: run(cell, common, known, given.trials) for name, known in found.items()}
    best = [row.completed for row in results["the truth"]]
    for name, rows in results.items():
        known = found[name] or Calibration.default()
        rates, done = known.whole.rates, [row.completed for row in rows]
        interval = wilson(sum(done), len(done))
        print(
            f"{name:20}{known.rows:8}{rates.yes_if_true:13.3f}{rates.yes_if_false:14.3f}"
            f"{interval.rate:11.3f}  {interval.low:.3f}–{interval.high:.3f}"
            f"{paired(done, best).difference:+9.3f}"
            f"{fmean(row.questions for row in rows):11.1f}{fmean(row.actions for row in rows):9.1f}"
        )


if __name__ == "__main__":
    main()
