"""What recorded episodes teach: those of a simulated world, and labelled ones."""

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Run, tpvqa
from tests.lamps import DOMAIN, PROBLEM, QUESTIONS, make_set
from tpvqa.labelling import read_recorded
from tpvqa.labelling.labels import Labels
from tpvqa.training.example import consistent
from tpvqa.training.from_episodes import examples_from
from tpvqa.worlds.pictures import load_set

__all__ = ["tpvqa"]


@pytest.fixture
def episode(tpvqa: Run, tmp_path: Path, model: Path) -> Path:
    """A trial in a world of pictures; its log says what truly came of every action."""
    lamps = make_set(tmp_path / "lamps")
    words: tuple[object, ...] = (
        "run",
        DOMAIN,
        PROBLEM,
        "--questions",
        QUESTIONS,
        "--world",
        f"pictures:{lamps}",
    )
    words += ("--vlm", f"hf:{model}", "--seed", "5", "--monitor", "tpvqa", "--max-actions", "12")
    code, _, error = tpvqa(*words, "--out", "episode")
    assert code in (0, 1), error
    return tmp_path / "episode"


def test_a_simulated_worlds_log_tells_what_was_right(episode: Path, tmp_path: Path) -> None:
    pictures = load_set(tmp_path / "lamps")
    states = {pictures.read(each): each for each in pictures.manifest.pictures}
    found = examples_from([episode])
    assert found.untold == 0
    assert found.examples
    for each in found.examples:
        shown = states[each.data]
        lamp = "left" if "left" in each.text else "right"
        if f"(lit {lamp})" in shown.seen:
            assert each.truth == (f"(lit {lamp})" in shown.state), each.text


def test_a_persons_labels_go_first(episode: Path) -> None:
    truly = {(each.picture, each.text): each.truth for each in examples_from([episode]).examples}
    recorded = read_recorded(episode)
    labels = Labels(recorded)
    for asking in recorded.askings:
        labels.append(asking, "yes")
    labels.close()
    found = examples_from([episode])
    assert {each.truth for each in found.examples} == {True}
    assert {(each.picture, each.text) for each in found.examples} == set(truly)
    assert len(consistent(found.examples)) == len(truly)


def test_episodes_are_learnt_from(episode: Path, model: Path, tpvqa: Run) -> None:
    words = ("train", f"hf:{model}", episode, "--out", "adapter", "--epochs", "1", "--json")
    code, out, error = tpvqa(*words)
    assert code == 0, error
    told = json.loads(out)
    assert told["learnt_from"]["pictures"] >= 1
    assert told["held_back"]["pictures"] >= 1
    assert (episode.parent / "adapter" / "adapter_model.safetensors").is_file()
