"""Episodes as a robot writes them: of a simulated world, with what was true taken out."""

import json
from dataclasses import replace
from pathlib import Path

from tests.doubles import configured
from tpvqa.bench.labelled_episodes import label_episodes
from tpvqa.bench.own_task import own_tasks
from tpvqa.bench.stage import Stage, stage
from tpvqa.episodes import EpisodeWriter
from tpvqa.episodes.log import LOG
from tpvqa.labelling import LABELS, Labels, read_recorded
from tpvqa.labelling.labels import Said

WARD = Path(__file__).parents[1] / "fixtures" / "ward"
Truths = dict[tuple[str, int, str], bool]
"""By episode, look and question."""


def ward() -> Stage:
    """The ward, read once."""
    (name, task), *_ = own_tasks([WARD / "problem.pddl"]).items()
    return stage(name, task)


def record(folder: Path, count: int, *, monitor: str = "belief", vlm: str = "oracle:0.8") -> Truths:
    """Write episodes into a folder; what was true is in none of them."""
    here = ward()
    for episode in range(count):
        writer = EpisodeWriter(folder / str(episode), durable=False)
        config = configured(monitor=monitor, world="symbolic", vlm=vlm).but(episode=episode)
        with here.trial(config) as trial:
            trial.run(writer)
        writer.close()
    folders = [folder / str(episode) for episode in range(count)]
    rows = label_episodes(folders).rows
    for each in folders:
        forget_truth(each)
    return {(row.trial, row.look, row.text): row.truth for row in rows}


def forget_truth(folder: Path) -> None:
    """Take out of a log what a robot does not know."""
    events = [json.loads(line) for line in (folder / LOG).read_text().splitlines()]
    for event in events:
        for name in ("truth", "goal_holds", "completed", "snapshot"):
            event.pop(name, None)
    (folder / LOG).write_text("".join(json.dumps(event) + "\n" for event in events))


def label_nothing(folder: Path, said: Said | None) -> None:
    """A file of labels that is empty, says that nothing is seen, or answers what nobody asked."""
    episode = read_recorded(folder)
    (folder / LABELS).touch()
    labels, asked = Labels(episode), episode.askings[0]
    if said is not None:
        labels.append(replace(asked, text="What?") if said == "yes" else asked, said)
    labels.close()
