"""The file of labels: appended to, whole, of one log."""

import json
import os
import shutil
from codecs import BOM_UTF8
from pathlib import Path

import pytest

from tests.labelling.robot import Truths
from tpvqa.bench.labelled_episodes import label_episodes
from tpvqa.episodes.log import LOG
from tpvqa.errors import CalibrationError, WriteError
from tpvqa.labelling import LABELS, Labels, read_labels, read_recorded
from tpvqa.labelling.session import Session


def test_a_label_is_there_at_once_and_the_last_one_counts(folders: list[Path]) -> None:
    episode = read_recorded(folders[0])
    log = (folders[0] / LOG).read_bytes()
    first, second = episode.askings[:2]
    labels = Labels(episode)
    assert not (folders[0] / LABELS).exists()  # to look leaves no trace
    labels.append(first, "yes")
    labels.append(second, "cannot see")
    assert read_labels(episode) == {first.key: "yes", second.key: "cannot see"}
    labels.append(first, "no")
    assert read_labels(episode) == {first.key: "no", second.key: "cannot see"} == labels.known
    labels.close()
    assert len((folders[0] / LABELS).read_text().splitlines()) == 3
    assert (folders[0] / LOG).read_bytes() == log


def test_a_torn_line_is_left_out_and_cut_off(folders: list[Path]) -> None:
    episode = read_recorded(folders[0])
    first, second = episode.askings[:2]
    labels = Labels(episode)
    labels.append(first, "yes")
    labels.close()
    path = folders[0] / LABELS
    whole = path.read_bytes()
    path.write_bytes(whole + whole[:20])
    assert read_labels(episode) == {first.key: "yes"}
    labels = Labels(episode)
    labels.append(second, "no")
    labels.close()
    assert read_labels(episode) == {first.key: "yes", second.key: "no"}
    assert path.read_bytes().startswith(whole)


def test_what_an_editor_puts_before_the_labels_is_no_fault(folders: list[Path]) -> None:
    episode = read_recorded(folders[0])
    labels = Labels(episode)
    labels.append(episode.askings[0], "yes")
    labels.close()
    path = folders[0] / LABELS
    path.write_bytes(BOM_UTF8 + path.read_bytes())
    assert read_labels(episode) == {episode.askings[0].key: "yes"}


@pytest.mark.parametrize("mark", [b"", BOM_UTF8])
@pytest.mark.parametrize("several", [False, True])
def test_a_last_line_to_which_an_editor_put_no_end_counts(
    folders: list[Path], mark: bytes, several: bool
) -> None:
    episode = read_recorded(folders[0])
    first, second, third = episode.askings[:3]
    labels = Labels(episode)
    labels.append(first, "yes")
    if several:
        labels.append(second, "no")
    labels.close()
    told = dict(labels.known)
    path = folders[0] / LABELS
    path.write_bytes(mark + path.read_bytes().rstrip())
    assert read_labels(episode) == told
    labels = Labels(episode)
    labels.append(third, "no")
    labels.close()
    assert read_labels(episode) == told | {third.key: "no"}


def test_blank_lines_are_no_fault(folders: list[Path]) -> None:
    episode = read_recorded(folders[0])
    labels = Labels(episode)
    labels.append(episode.askings[0], "yes")
    labels.close()
    path = folders[0] / LABELS
    path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n") + b"\r\n\n  ")
    assert read_labels(episode) == {episode.askings[0].key: "yes"}
    labels = Labels(episode)
    labels.append(episode.askings[1], "no")
    labels.close()
    assert len(read_labels(episode)) == 2


def test_labels_stay_where_an_episode_is_gone_on_with(folders: list[Path]) -> None:
    log = folders[0] / LOG
    lines = log.read_bytes().splitlines(keepends=True)
    log.write_bytes(b"".join(lines[: len(lines) // 2]))
    half = read_recorded(folders[0])
    labels = Labels(half)
    labels.append(half.askings[0], "yes")
    labels.close()
    log.write_bytes(b"".join(lines))
    whole = read_recorded(folders[0])
    assert read_labels(whole) == {half.askings[0].key: "yes"}
    assert len(whole.askings) > len(half.askings)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"log": "0" * 12}, "labels of another episode"),
        ({"schema": 3}, r"labels\.jsonl:1: no label of this version \(schema"),
        ({"label": "maybe"}, r"labels\.jsonl:1: no label of this version \(label"),
        ({"stretch": -1}, "stretch"),
        ({"stretch": 91}, r"labels\.jsonl:1: a label of stretch 91, and the episode.s last is \d"),
        ({"more": 1}, "more"),
    ],
)
def test_what_is_no_label_is_refused(
    folders: list[Path], change: dict[str, object], says: str
) -> None:
    episode = read_recorded(folders[0])
    line = {"schema": 1, "log": episode.log, "stretch": 0, "text": "?", "label": "yes", "at": ""}
    (folders[0] / LABELS).write_text(json.dumps(line | change) + "\n")
    with pytest.raises(CalibrationError, match=says):
        Session(folders)


def test_no_link_is_followed(folders: list[Path], tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.write_text("mine\n")
    episode = read_recorded(folders[0])
    labels = Labels(episode)
    (folders[0] / LABELS).symlink_to(other)
    with pytest.raises(WriteError, match="link"):
        labels.append(episode.askings[0], "yes")
    assert other.read_text() == "mine\n"
    with pytest.raises(CalibrationError, match="cannot be read"):
        read_labels(episode)


def test_two_do_not_write_at_once(folders: list[Path]) -> None:
    episode = read_recorded(folders[0])
    mine, yours = Labels(episode), Labels(episode)
    mine.append(episode.askings[0], "yes")
    with pytest.raises(CalibrationError, match="another process"):
        yours.append(episode.askings[1], "no")
    mine.close()
    yours.append(episode.askings[1], "no")
    yours.close()


def test_what_another_session_labelled_meanwhile_counts(folders: list[Path]) -> None:
    episode = read_recorded(folders[0])
    first, second = episode.askings[:2]
    mine, yours = Labels(episode), Labels(episode)
    assert mine.append(first, "yes")
    assert mine.append(second, "yes")
    mine.close()
    assert not yours.append(first, "no")
    assert yours.known == yours.meanwhile == {first.key: "yes", second.key: "yes"}
    assert read_labels(episode)[first.key] == "yes"
    assert yours.append(first, "no")  # now that it is known
    assert read_labels(episode)[first.key] == "no"
    yours.close()


def test_what_was_damaged_meanwhile_is_told(folders: list[Path]) -> None:
    episode = read_recorded(folders[0])
    labels = Labels(episode)
    (folders[0] / LABELS).write_text("{}\n")
    for _ in range(2):
        with pytest.raises(CalibrationError, match="no label of this version"):
            labels.append(episode.askings[0], "yes")
    assert (folders[0] / LABELS).read_text() == "{}\n"


def test_what_cannot_be_written_is_told_and_what_was_is_kept(
    folders: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    episode = read_recorded(folders[0])
    labels = Labels(episode)
    labels.append(episode.askings[0], "yes")

    def full(_descriptor: int) -> None:
        raise OSError(28, os.strerror(28))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(WriteError, match="labels before are kept"):
        labels.append(episode.askings[1], "no")
    labels.close()
    assert read_labels(episode) == {episode.askings[0].key: "yes"}


def test_an_interrupt_takes_no_label_back(
    folders: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    episode = read_recorded(folders[0])
    labels = Labels(episode)

    def interrupted(_descriptor: int) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", interrupted)
        with pytest.raises(KeyboardInterrupt):
            labels.append(episode.askings[0], "yes")
    labels.close()
    assert labels.known == read_labels(episode) == {episode.askings[0].key: "yes"}


def test_one_label_holds_for_one_truth(folders: list[Path], truths: Truths) -> None:
    """All that is asked in the same words between two actions has one right answer."""
    answers = 0
    for folder in folders:
        for asking in read_recorded(folder).askings:
            right = {truths[str(folder), each.look, asking.text] for each in asking.of_vlm}
            assert len(right) == 1
            answers += len(asking.of_vlm)
    assert answers == len(truths)


def test_a_copy_of_an_episode_does_not_count_twice(folders: list[Path], tmp_path: Path) -> None:
    copy, link = tmp_path / "copy", tmp_path / "link"
    shutil.copytree(folders[0], copy)
    link.symlink_to(folders[0])
    for other in (copy, link):
        with pytest.raises(CalibrationError, match="is a copy of"):
            Session([folders[0], other])
        with pytest.raises(CalibrationError, match="is a copy of"):
            label_episodes([folders[0], other])


def test_two_that_go_on_from_one_episode_do_not_count_twice(folders: list[Path]) -> None:
    lines = (folders[0] / LOG).read_bytes().splitlines(keepends=True)
    half = len(lines) // 2
    event = json.loads(lines[half])
    event["time"] += 0.0001
    other = [*lines[:half], json.dumps(event).encode() + b"\n", *lines[half + 1 :]]
    (folders[1] / LOG).write_bytes(b"".join(other))
    with pytest.raises(CalibrationError, match="both go on from one episode"):
        label_episodes(folders[:2])


def test_episodes_that_only_begin_alike_both_count(folders: list[Path]) -> None:
    """As of one command that was run often: its start took equally long twice."""
    first, second = ((each / LOG).read_bytes().splitlines(keepends=True) for each in folders[:2])
    (folders[1] / LOG).write_bytes(b"".join([first[0], *second[1:]]))
    episodes = [read_recorded(each) for each in folders[:2]]
    assert episodes[0].log == episodes[1].log
    assert label_episodes(folders[:2]).rows
    (folders[1] / LOG).write_bytes(b"".join(first[:-1]))  # one that was gone on with later
    with pytest.raises(CalibrationError, match="is a copy of"):
        label_episodes(folders[:2])
