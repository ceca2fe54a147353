"""Answers beside the truth: live, played back from the log, and from pictures."""

import json
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.doubles import configured, truthful
from tests.labelling.robot import label_nothing
from tpvqa.belief import LabelledAnswer
from tpvqa.bench.labelled import Labeller
from tpvqa.bench.labelled_episodes import label_episodes
from tpvqa.bench.labelled_pictures import ask_pictures
from tpvqa.bench.stage import Stage, stage, true_simulation
from tpvqa.config import TrialConfig
from tpvqa.episodes import EpisodeWriter
from tpvqa.episodes.log import LOG
from tpvqa.errors import CalibrationError
from tpvqa.labelling import LABELS, Labels, read_recorded
from tpvqa.labelling.labels import Said
from tpvqa.observation import Observation
from tpvqa.pddl import Atom
from tpvqa.questions import Question, Way
from tpvqa.vlm import Answer, Reply
from tpvqa_household.images.manifest import Manifest, PictureSet, load_pictures

CONFIG = configured(
    monitor="tpvqa",
    task="serve_breakfast",
    world="symbolic",
    vlm="oracle:0.8",
    spontaneous=0.2,
    seed=2,
)


def recorded(config: TrialConfig, folder: Path) -> list[LabelledAnswer]:
    """Run a trial into a folder: its answers, labelled as it ran."""
    assert config.task.name is not None
    here: Stage = stage(config.task.name)
    with here.trial(config) as trial:
        labeller = Labeller(true_simulation(trial), here.actions, str(folder))
        writer = EpisodeWriter(folder, durable=False)
        trial.run(writer, listeners=[labeller])
        writer.close()
    return labeller.rows


@pytest.mark.parametrize("monitor", ["tpvqa:2", "palmevqa", "successvqa"])
@pytest.mark.parametrize("episode", [0, 3])
def test_a_log_gives_the_labels_that_the_running_trial_gave(
    monitor: str, episode: int, tmp_path: Path
) -> None:
    live = recorded(CONFIG.but(monitor=monitor, episode=episode), tmp_path / "e")
    again = label_episodes([tmp_path / "e"])
    assert again.vlm == "oracle:0.8"
    assert again.rows == live
    assert {row.truth for row in live} == {True, False}


def test_labels_are_the_truth_at_the_time_of_asking(tmp_path: Path) -> None:
    """An oracle that never errs agrees with every label, through failures and disturbances."""
    config = CONFIG.but(vlm="oracle", monitor="palmevqa")
    for episode in range(4):
        rows = recorded(config.but(episode=episode), tmp_path / str(episode))
        assert rows
        assert all((row.reply is Reply.YES) == row.truth for row in rows)


def test_one_action_without_truth_is_enough_to_refuse_it(tmp_path: Path) -> None:
    recorded(CONFIG, tmp_path / "e")
    log = tmp_path / "e" / LOG
    events = [json.loads(line) for line in log.read_text().splitlines()]
    next(event for event in events if event["kind"] == "acted").pop("truth")
    log.write_text("".join(json.dumps(event) + "\n" for event in events))
    with pytest.raises(CalibrationError, match="of some actions what was true"):
        label_episodes([tmp_path / "e"])


@pytest.mark.parametrize("said", [None, "cannot see", "yes"])
def test_labels_that_answer_nothing_leave_what_the_world_knows(
    said: Said | None, tmp_path: Path
) -> None:
    live = recorded(CONFIG, tmp_path / "e")
    label_nothing(tmp_path / "e", said)
    found = label_episodes([tmp_path / "e"])
    assert found.rows == live
    assert f"{LABELS} answers none of the episode's questions" in found.fit().notices[-1]


def test_labels_of_no_question_are_told_beside_those_that_count(tmp_path: Path) -> None:
    recorded(CONFIG, tmp_path / "e")
    label_nothing(tmp_path / "e", "yes")
    episode = read_recorded(tmp_path / "e")
    labels = Labels(episode)
    labels.append(episode.askings[0], "yes")
    labels.close()
    found = label_episodes([tmp_path / "e"])
    assert found.by_hand == 1
    told = '1 label is of no question that was asked, and counts for nothing: "What?" (stretch '
    assert told in found.fit().notices[-1]


def test_a_label_goes_before_the_truth_of_its_own_question_alone(tmp_path: Path) -> None:
    live = recorded(CONFIG, tmp_path / "e")
    known = label_episodes([tmp_path / "e"])
    episode = read_recorded(tmp_path / "e")
    told, unseen = episode.askings[0], episode.askings[3]
    right = {(row.look, row.text): row.truth for row in live}
    labels = Labels(episode)
    labels.append(told, "no" if right[told.of_vlm[0].look, told.text] else "yes")
    labels.append(unseen, "cannot see")
    labels.close()
    found = label_episodes([tmp_path / "e"])
    assert found.by_hand == 1
    assert found.own == known.own
    assert found.own.acts
    changed = [row for row in found.rows if row.truth != right[row.look, row.text]]
    assert {row.text for row in changed} == {told.text}
    assert len(changed) == len(told.of_vlm)
    assert len(found.rows) == len(live) - len(unseen.of_vlm)


def test_two_vlms_do_not_mix(tmp_path: Path) -> None:
    recorded(CONFIG, tmp_path / "a")
    recorded(CONFIG.but(vlm="oracle:0.9"), tmp_path / "b")
    with pytest.raises(CalibrationError, match=r"oracle:0\.9 answered in it, not oracle:0\.8"):
        label_episodes([tmp_path / "a", tmp_path / "b"])


class Reader:
    """Says yes to what it was told is true."""

    name = "reader"

    def __init__(self, true: frozenset[Atom]):
        self._true, self.asked = true, list[str]()

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        self.asked += [question.text for question in questions]
        holds = self._true.__contains__
        return [Answer(question, truthful(question, holds)) for question in questions]


def test_every_fact_of_a_picture_is_asked_once_and_counts_both_ways() -> None:
    everything = load_pictures()
    picture = everything.manifest.pictures[0]
    few = Manifest.model_validate(
        everything.manifest.model_dump() | {"pictures": (picture.model_dump(),)}
    )
    one = PictureSet(everything.folder, few)
    vlm = Reader(picture.true_state)
    rows = ask_pictures(vlm, one, hidden=True)
    assert len(vlm.asked) == len(set(vlm.asked)) > 30
    assert sorted(row.text for row in rows) == sorted(2 * vlm.asked)
    assert {row.way for row in rows} == {Way.PRECONDITION, Way.EFFECT}
    assert "free" not in {row.predicate for row in rows}
    assert all((row.reply is Reply.YES) == row.truth for row in rows)
    assert {row.truth for row in rows} == {True, False}
    of_what_is_shown = ask_pictures(Reader(picture.true_state), one)
    texts = {row.text for row in of_what_is_shown}
    assert "(near table)" not in picture.seen
    assert "Is there a table in the image?" in {row.text for row in rows} - texts
    assert "Is there a plate in the image?" in texts
