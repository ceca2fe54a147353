"""`tpvqa run … --vlm hf:FOLDER`: whole seeded trials of every family, in a world of pictures."""

import json
import math
from pathlib import Path
from typing import Any

import pytest

from tests.cli.conftest import Run, tpvqa
from tests.lamps import DOMAIN, PROBLEM, QUESTIONS, make_set
from tests.vlm.hf import tiny
from tests.vlm.hf.conftest import Saved
from tpvqa.episodes import read_episode
from tpvqa.events.events import Answered, Ended, Started

__all__ = ["tpvqa"]


@pytest.fixture(scope="module")
def lamps(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_set(tmp_path_factory.mktemp("lamps") / "set")


def told(folder: Path) -> list[dict[str, Any]]:
    """The answers of a log, without what differs from run to run."""
    found = []
    for event in read_episode(folder):
        if isinstance(event, Answered):
            found += [each.model_dump(mode="json", exclude={"seconds"}) for each in event.answers]
    return found


@pytest.mark.parametrize("family", tiny.ALL)
def test_a_seeded_trial_runs_and_is_the_same_again(
    family: str, saved: Saved, lamps: Path, tpvqa: Run, tmp_path: Path
) -> None:
    model = saved(family, outspoken=family != "blip")
    words: tuple[object, ...] = (
        "run",
        DOMAIN,
        PROBLEM,
        "--questions",
        QUESTIONS,
        "--world",
        f"pictures:{lamps}",
    )
    words += ("--vlm", f"hf:{model}", "--device", "cpu", "--seed", "3", "--max-actions", "5")
    words += ("--monitor", "tpvqa", "--max-repeats", "2")
    logs = []
    for number in range(2):
        code, _, error = tpvqa(*words, "--out", f"trial{number}")
        assert code in (0, 1), error
        events = read_episode(tmp_path / f"trial{number}")
        assert isinstance(events[0], Started)
        assert isinstance(events[-1], Ended)
        assert events[0].config.vlm.device == "cpu"
        assert events[0].vlm == f"hf:{model}"
        logs.append(told(tmp_path / f"trial{number}"))
    assert logs[0] == logs[1]
    assert logs[0]
    for answer in logs[0]:
        if answer["p_yes"] is not None:
            assert 0 <= answer["p_yes"] <= 1
            assert (answer["reply"] == "yes") == (answer["p_yes"] > 0.5)
    if family != "blip":  # untrained, it has no word that ends after yes
        assert {"yes", "no"} & {answer["reply"] for answer in logs[0]}
    assert "Traceback" not in error


def test_a_picture_is_asked_about(saved: Saved, lamps: Path, tpvqa: Run) -> None:
    words = ("ask", lamps / "left.png", "Is the left lamp lit?", "--vlm", f"hf:{saved('vilt')}")
    code, out, _ = tpvqa(*words, "--device", "cpu", "--dtype", "float32", "--json")
    assert code == 0
    (answer,) = json.loads(out)["answers"]
    assert answer["source"] == "classes"
    assert math.isfinite(answer["p_yes"])
    assert 0 < answer["leftover"] < 1


def test_how_it_runs_is_part_of_the_configuration(tpvqa: Run, tmp_path: Path) -> None:
    Path("trial.yaml").write_text("vlm: {spec: 'hf:x', dtype: bfloat16, batch: 4}\n")
    code, out, _ = tpvqa("config", "--config", "trial.yaml", "--device", "cuda:1")
    assert code == 0
    for line in ("dtype: bfloat16", "batch: 4", "device: cuda:1"):
        assert line in out
    code, _, error = tpvqa("config", "--device", "toaster")
    assert code == 2
    assert "--device" in error
    code, _, error = tpvqa("run", "eat_apple", "--vlm", "oracle", "--dtype", "float16")
    assert code == 2
    assert "dtype" in error
