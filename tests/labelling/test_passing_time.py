"""Labels of episodes in which actions last: what is true may change while nothing is begun."""

import json
from pathlib import Path

import pytest

from tests.labelling.robot import forget_truth
from tests.test_lasting_trial import CONFIG, planner
from tpvqa.assembly import Trial
from tpvqa.bench.labelled_episodes import label_episodes
from tpvqa.episodes import EpisodeWriter
from tpvqa.errors import CalibrationError
from tpvqa.labelling import LABELS, Labels, read_labels, read_recorded
from tpvqa.planning import Planner
from tpvqa.vlm import Reply

__all__ = ["planner"]


@pytest.fixture
def folder(tmp_path: Path, planner: Planner) -> Path:
    """An episode in which much slips while actions run, seen by a VLM that never errs."""
    writer = EpisodeWriter(tmp_path / "e", durable=False)
    config = CONFIG.but(monitor="tpvqa:2", seed=7, simulation={"interruption": 0.6})
    with Trial(config, planner=planner) as trial:
        trial.run(writer)
    writer.close()
    return tmp_path / "e"


def test_one_label_holds_until_time_passes(folder: Path) -> None:
    episode = read_recorded(folder)
    assert episode.timed
    assert max(len(asking.of_vlm) for asking in episode.askings) > 1
    for asking in episode.askings:
        assert len({answer.reply for answer in asking.of_vlm}) == 1, asking


def test_what_is_probable_is_inferred_across_it(folder: Path) -> None:
    forget_truth(folder)
    found = label_episodes([folder])
    assert found.inferred == sum(len(each.of_vlm) for each in read_recorded(folder).askings)
    right = [(row.reply is Reply.YES) == row.truth for row in found.plain]
    assert sum(right) > 0.95 * len(right)


def test_labels_from_before_time_counted_are_refused(folder: Path) -> None:
    episode = read_recorded(folder)
    labels = Labels(episode)
    labels.append(episode.askings[0], "yes")
    labels.close()
    assert read_labels(episode) == {episode.askings[0].key: "yes"}
    line = json.loads((folder / LABELS).read_text())
    (folder / LABELS).write_text(json.dumps(line | {"schema": 1}) + "\n")
    with pytest.raises(CalibrationError, match="did not count the time that passes"):
        label_episodes([folder])
