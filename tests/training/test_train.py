"""`tpvqa train hf:MODEL`: it learns, keeps what it has on Ctrl-C, and writes all or nothing."""

import json
import os
import re
import shutil
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import torch
from safetensors.torch import load_file

from tests.cli.conftest import Run, tpvqa
from tests.lamps import DOMAIN, PROBLEM, QUESTIONS
from tests.training.conftest import make_lamp_set
from tests.vlm.hf import tiny
from tpvqa.training.lora import CHECKPOINT, LoraTrainer, _Fitting

__all__ = ["tpvqa"]
WEIGHTS = "adapter_model.safetensors"
OWN = ("--domain", DOMAIN, "--problem", PROBLEM, "--questions", QUESTIONS)
FAST = ("--epochs", "15", "--rate", "0.01", "--device", "cpu", "--seed", "3")
SHORT = ("--epochs", "2")
Words = tuple[object, ...]


def command(model: Path, lamp_set: Path, out: str, *more: str) -> Words:
    return ("train", f"hf:{model}", "--pictures", lamp_set, *OWN, "--out", out, *FAST, *more)


def test_a_tiny_model_learns_what_is_held_back(
    model: Path, lamp_set: Path, tpvqa: Run, tmp_path: Path
) -> None:
    code, out, error = tpvqa(*command(model, lamp_set, "adapter", "--json"))
    assert code == 0, error
    told = json.loads(out)
    before, after = told["before"], told["after"]
    assert told["learnt_from"] == {"questions": 60, "pictures": 60}
    assert told["held_back"] == {"questions": 20, "pictures": 20}
    for name in ("accuracy", "balanced_accuracy"):
        assert before[name]["value"] <= 0.75
        assert after[name]["value"] >= 0.9
        assert before[name]["low"] <= before[name]["value"] <= before[name]["high"]
    assert after["auroc"]["value"] >= 0.95
    assert after["log_loss"]["value"] < 0.5 * before["log_loss"]["value"]
    files = {path.name for path in (tmp_path / "adapter").iterdir()}
    assert files == {WEIGHTS, "adapter_config.json", "training.json"}
    assert not (tmp_path / "adapter.part").exists()
    held = {name: told[name] for name in ("before", "after", "held_back")}
    written = json.loads((tmp_path / "adapter" / "training.json").read_text())
    assert held.items() <= written.items()

    right = 0
    for number in range(12):
        words = ("ask", lamp_set / f"{number}.png", "Is the left lamp lit?", "--json")
        code, out, error = tpvqa(*words, "--vlm", "hf:adapter")
        assert code == 0, error
        right += json.loads(out)["answers"][0]["reply"] == ("yes" if number % 2 == 0 else "no")
    assert right >= 11
    code, _, error = tpvqa(*command(tmp_path / "adapter", lamp_set, "twice"))
    assert code == 2
    assert "is an adapter already" in error


@pytest.mark.parametrize("family", ["blip", "smolvlm"])
def test_other_families_learn_too(family: str, lamp_set: Path, tpvqa: Run, tmp_path: Path) -> None:
    folder = tiny.save(family, tmp_path / "model", seed=3, outspoken=family != "blip")
    words = command(folder, lamp_set, "adapter", "--json", "--rate", "0.005", "--epochs", "8")
    code, out, error = tpvqa(*words)
    assert code == 0, error
    told = json.loads(out)
    assert told["after"]["auroc"]["value"] >= 0.75
    assert told["after"]["log_loss"]["value"] < told["before"]["log_loss"]["value"]


def interrupting(at: int) -> Callable[[_Fitting], None]:
    step = _Fitting.step

    def stepping(self: _Fitting) -> None:
        step(self)
        if self.done == at:
            os.kill(os.getpid(), signal.SIGINT)

    return stepping


def test_ctrl_c_loses_nothing(
    model: Path, lamp_set: Path, tpvqa: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert tpvqa(*command(model, lamp_set, "whole", *SHORT))[0] == 0
    with monkeypatch.context() as patch:
        patch.setattr(_Fitting, "step", interrupting(7))
        code, _, error = tpvqa(*command(model, lamp_set, "broken", *SHORT))
    assert code == 130
    assert "interrupted" in error
    assert not (tmp_path / "broken").exists()
    part = tmp_path / "broken.part"
    assert torch.load(part / CHECKPOINT, weights_only=True)["done"] == 7

    code, _, error = tpvqa(*command(model, lamp_set, "broken", *SHORT, "--rank", "4"))
    assert code == 2
    assert "other pictures or settings" in error
    steps: list[int] = []
    step = _Fitting.step

    def counted(self: _Fitting) -> None:
        steps.append(self.done)
        step(self)

    with monkeypatch.context() as patch:
        patch.setattr(_Fitting, "step", counted)
        code, _, error = tpvqa(*command(model, lamp_set, "broken", *SHORT))
    assert code == 0, error
    assert "going on with broken.part" in error
    assert steps[0] == 7
    assert not part.exists()
    unbroken = load_file(tmp_path / "whole" / WEIGHTS)
    for name, weights in load_file(tmp_path / "broken" / WEIGHTS).items():
        torch.testing.assert_close(weights, unbroken[name], rtol=1e-2, atol=1e-3)


def test_what_is_damaged_under_way_is_said(
    model: Path, lamp_set: Path, tpvqa: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr(_Fitting, "step", interrupting(1))
        assert tpvqa(*command(model, lamp_set, "torn"))[0] == 130
    (tmp_path / "torn.part" / CHECKPOINT).write_bytes(b"torn")
    code, _, error = tpvqa(*command(model, lamp_set, "torn"))
    assert code == 2
    assert "is damaged" in error
    assert "Traceback" not in error


@pytest.mark.parametrize(
    "told", ["", "[]", "{", '{"accuracy": {"x": NaN}}', '{"accuracy": {"value": 1}}', "nan"]
)
def test_figures_that_are_damaged_under_way_are_said(
    model: Path, lamp_set: Path, tpvqa: Run, tmp_path: Path, told: str
) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(_Fitting, "step", interrupting(1))
        assert tpvqa(*command(model, lamp_set, "torn", *SHORT))[0] == 130
    before = tmp_path / "torn.part" / "before.json"
    whole = before.read_text()
    before.write_text(re.sub(r"[0-9.]+", "NaN", whole, count=1) if told == "nan" else told)
    code, _, error = tpvqa(*command(model, lamp_set, "torn", *SHORT))
    assert code == 2
    assert "before.json is damaged. Remove it" in " ".join(error.split())
    assert "Traceback" not in error
    before.unlink()
    assert tpvqa(*command(model, lamp_set, "torn", *SHORT))[0] == 0


def test_a_folder_of_ones_own_is_left_alone(
    model: Path, lamp_set: Path, tpvqa: Run, tmp_path: Path
) -> None:
    own = tmp_path / "own"
    own.mkdir()
    (tmp_path / "linked.part").symlink_to(own)
    (tmp_path / "out.part").mkdir()
    (tmp_path / "out.part" / "thesis.txt").write_text("mine")
    for out in ("out", "linked"):
        code, _, error = tpvqa(*command(model, lamp_set, out, *SHORT))
        assert (code, "Move it away" in " ".join(error.split())) == (2, True), error
    assert (tmp_path / "out.part" / "thesis.txt").read_text() == "mine"
    assert list(own.iterdir()) == []
    (tmp_path / "out.part" / "thesis.txt").unlink()
    assert tpvqa(*command(model, lamp_set, "out", *SHORT))[0] == 0


def test_what_cannot_be_trained_is_said_before_anything(
    model: Path, lamp_set: Path, tpvqa: Run, tmp_path: Path
) -> None:
    def refused(*words: object) -> str:
        code, _, error = tpvqa(*words)
        assert code == 2
        assert "Traceback" not in error
        assert {path.name for path in tmp_path.iterdir()} <= {"there", "few", "alike"}
        return " ".join(error.split())

    good = command(model, lamp_set, "out")
    assert "cannot be trained here" in refused("train", "oracle:0.8", *good[2:])
    assert "There is no VLM 'hv'" in refused("train", f"hv:{model}", *good[2:])
    assert "Give one source" in refused("train", f"hf:{model}", "--out", "out")
    assert "Give one source" in refused("train", f"hf:{model}", "episode", *good[2:])
    assert "beside --pictures" in refused("train", f"hf:{model}", "episode", *OWN, "--out", "out")
    assert "there is no such folder" in refused(*command(model, lamp_set, "no/out"))
    (tmp_path / "there").mkdir()
    assert "is there already" in refused(*command(model, lamp_set, "there"))
    few = make_lamp_set(tmp_path / "few", 1)
    assert "too few" in refused(*command(model, few, "out"))
    alike = make_lamp_set(tmp_path / "alike", 6)
    told: dict[str, Any] = json.loads((alike / "manifest.json").read_text())
    told["pictures"] = told["pictures"][::2]
    (alike / "manifest.json").write_text(json.dumps(told))
    assert "same answer" in refused(*command(model, alike, "out"))


def test_a_loss_that_is_no_number_ends_it(
    model: Path, lamp_set: Path, tpvqa: Run, tmp_path: Path
) -> None:
    folder = shutil.copytree(model, tmp_path / "broken")
    from safetensors.torch import save_file

    weights = load_file(folder / "model.safetensors")
    weights["classifier.3.bias"][:] = float("nan")
    save_file(weights, folder / "model.safetensors", {"format": "pt"})
    code, _, error = tpvqa(*command(folder, lamp_set, "out"))
    assert code == 2
    assert "no number" in error
    assert not (tmp_path / "out").exists()


def test_it_is_a_trainer_by_name(model: Path) -> None:
    from tpvqa.training.making import make_trainer

    assert isinstance(make_trainer(f"hf:{model}", {"device": "cpu"}), LoraTrainer)
