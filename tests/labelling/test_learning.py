"""What labels, and what came before and after, teach."""

import json
from dataclasses import replace
from math import sqrt
from pathlib import Path
from statistics import fmean

import pytest

from tests.doubles import ScriptedVLM, configured
from tests.labelling.robot import Truths, forget_truth, label_nothing, record
from tpvqa.assembly import Trial
from tpvqa.belief import LabelledAnswer
from tpvqa.belief.calibrating.fitting import fit
from tpvqa.bench.labelled_episodes import label_episodes
from tpvqa.episodes import EpisodeWriter
from tpvqa.episodes.log import LOG
from tpvqa.errors import CalibrationError
from tpvqa.labelling import LABELS, Labels, read_recorded
from tpvqa.labelling.inferring import WEIGHT
from tpvqa.labelling.labels import Said
from tpvqa.labelling.recorded import said_in_trial
from tpvqa.labelling.session import Session
from tpvqa.vlm import Reply


def label_all(folders: list[Path], truths: Truths, most: int = 10_000) -> int:
    """Label as a person who sees everything would; gives how many labels that were."""
    with Session(folders) as session:
        for count in range(most):
            now = session.now
            if now is None:
                return count
            right = truths[str(now.episode), now.of_vlm[0].look, now.text]
            session.say("yes" if right else "no")
    return most


def test_all_labels_are_the_truth(folders: list[Path], truths: Truths) -> None:
    labels = label_all(folders, truths)
    found = label_episodes(folders)
    assert found.by_hand == labels
    assert {(row.trial, row.look, row.text): row.truth for row in found.rows} == truths
    assert {row.weight for row in found.rows} == {1.0}  # none stands for another
    calibration = found.fit()
    assert calibration.by_hand == labels
    assert calibration.inferred == 0
    assert calibration.rows <= labels  # of many answers of a moment the first counts
    error = sqrt(0.8 * 0.2 / (calibration.rows / 2))  # some half of the answers are about facts
    assert abs(calibration.whole.rates.yes_if_true - 0.8) < 3 * error < 0.2


def test_some_labels_are_enough(folders: list[Path], truths: Truths) -> None:
    label_all(folders, truths, 60)
    rates = label_episodes(folders).fit().whole.rates
    assert abs(rates.yes_if_true - 0.8) < 0.15
    assert abs(rates.yes_if_false - 0.2) < 0.15


def test_what_the_pictures_do_not_tell_teaches_nothing(folders: list[Path]) -> None:
    with Session(folders) as session:
        session.say("cannot see")
        session.say("yes")
    found = label_episodes(folders)
    assert found.by_hand == 1
    assert found.unused == 0 or "neither labels nor the truth" in found.fit().notices[-1]
    assert {row.truth for row in found.rows} == {True}


def test_labels_go_before_what_a_world_knows(tmp_path: Path) -> None:
    record(tmp_path, 1)
    folder = tmp_path / "0"
    episode = read_recorded(folder)
    labels = Labels(episode)
    labels.append(episode.askings[0], "no")
    labels.close()
    found = label_episodes([folder, folder / LOG])  # twice the same is once
    assert len(found.rows) == len(episode.askings[0].of_vlm)


@pytest.mark.parametrize("said", [None, "cannot see", "yes"])
def test_where_labels_that_answer_nothing_are_all_there_is_they_are_named(
    said: Said | None, folders: list[Path]
) -> None:
    folder = folders[0]
    label_nothing(folder, said)
    with pytest.raises(CalibrationError, match=rf"{LABELS} answers none.*`tpvqa label {folder}`"):
        label_episodes([folder])
    assert label_episodes(folders).inferred


def test_a_log_whose_domain_cannot_be_read_is_named(folders: list[Path]) -> None:
    log = folders[0] / LOG
    first, *others = log.read_text().splitlines(keepends=True)
    started = json.loads(first)
    started["domain"] = started["domain"].replace(":effect", ":efect", 1)
    log.write_text("".join([json.dumps(started) + "\n", *others]))
    with pytest.raises(CalibrationError, match=f"{folders[0]}: the log holds a domain .* label"):
        label_episodes(folders[:1])
    assert label_episodes(folders).inferred


def test_another_vlm_is_told(folders: list[Path], tmp_path: Path) -> None:
    record(tmp_path / "other", 1, vlm="oracle:0.9")
    with pytest.raises(CalibrationError, match=r"oracle:0\.9 answered in it, not oracle:0\.8"):
        Session([*folders, tmp_path / "other" / "0"])
    with pytest.raises(CalibrationError, match="give the episodes of each apart"):
        label_episodes([*folders, tmp_path / "other" / "0"])


@pytest.mark.parametrize(
    ("monitor", "vlm", "right"),
    [
        ("belief", "oracle:0.8", 0.8),
        ("survey:5", "oracle:0.7", 0.7),
        ("tpvqa:3", "oracle:0.9", 0.9),
    ],
)
def test_without_labels_it_is_inferred_what_was_right(
    tmp_path: Path, monitor: str, vlm: str, right: float
) -> None:
    truths = record(tmp_path, 6, monitor=monitor, vlm=vlm)
    found = label_episodes([tmp_path / str(n) for n in range(6)])
    asked = [row for row in found.plain if (row.trial, row.look, row.text) in truths]
    assert len(asked) == len(found.plain) > 100
    agree = fmean(truths[row.trial, row.look, row.text] == row.truth for row in asked)
    said = fmean((row.reply is Reply.YES) == row.truth for row in _told(asked, truths))
    assert agree > said + 0.05  # surer than the VLM's word
    calibration = found.fit()
    rates = calibration.whole.rates
    assert abs((rates.yes_if_true + 1 - rates.yes_if_false) / 2 - right) < 0.08
    assert calibration.inferred == found.inferred == len(asked)
    assert calibration.by_hand == 0
    assert "nobody has labelled" in calibration.notices[-1]


def _told(rows: list[LabelledAnswer], truths: Truths) -> list[LabelledAnswer]:
    """The answers beside what was true."""
    return [
        LabelledAnswer(
            row.way,
            row.predicate,
            row.text,
            truths[row.trial, row.look, row.text],
            row.reply,
            row.p_yes,
            row.trial,
            row.look,
        )
        for row in rows
    ]


def test_what_is_inferred_counts_for_less(folders: list[Path]) -> None:
    found = label_episodes(folders)
    pairs = zip(found.rows[::2], found.rows[1::2], strict=True)
    assert len(found.rows) == 2 * found.inferred
    by_answer: dict[tuple[str, int, str], float] = {}
    for row in found.rows:
        key = (row.trial, row.look, row.text)
        by_answer[key] = by_answer.get(key, 0.0) + row.weight
    assert all(abs(weight - WEIGHT) < 1e-9 for weight in by_answer.values())
    assert any(one.weight != other.weight for one, other in pairs)


def test_weights_of_one_change_nothing(folders: list[Path], truths: Truths) -> None:
    """What counts twice is two answers."""
    label_all(folders[:2], truths)
    rows = label_episodes(folders[:2]).rows
    doubled = fit([_counting(row, 2.0) for row in rows], "a").whole.rates
    more = [*rows, *(_counting(row, 1.0, trial=f"{row.trial} again") for row in rows)]
    again = fit(more, "a").whole.rates
    assert doubled.yes_if_true == pytest.approx(again.yes_if_true)
    assert doubled.abstain_if_false == pytest.approx(again.abstain_if_false)


def _counting(row: LabelledAnswer, weight: float, trial: str | None = None) -> LabelledAnswer:

    return replace(row, weight=weight, trial=row.trial if trial is None else trial)


def test_what_a_person_answered_in_the_trial_is_a_label(tmp_path: Path) -> None:
    config = configured(task="build_tower", monitor="belief:person=0.02", vlm="oracle:0.6")
    config = config.but(world={"spec": "symbolic"}, seed=3)
    writer = EpisodeWriter(tmp_path / "e", durable=False)
    with Trial(config, person=ScriptedVLM(lambda _: Reply.YES)) as trial:
        trial.run(writer)
    writer.close()
    forget_truth(tmp_path / "e")
    found = label_episodes([tmp_path / "e"])
    asked = [each for each in read_recorded(tmp_path / "e").askings if said_in_trial(each)]
    assert found.by_hand == len(asked) > 0
    assert found.inferred == 0
    assert {row.truth for row in found.rows} == {True}
    with Session([tmp_path / "e"]) as session:
        assert session.progress.labels == found.by_hand
        assert session.now not in asked
