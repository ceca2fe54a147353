"""What goes wrong with a local model: one sentence, exit code 2, no traceback."""

import importlib.util
import json
import pickle
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
import transformers

from tests.cli.conftest import Run, tpvqa
from tests.vlm.hf import tiny
from tests.vlm.hf.conftest import Saved, picture
from tpvqa.vlm.hf.quiet import quiet

__all__ = ["tpvqa"]


@pytest.fixture
def asked(tpvqa: Run, tmp_path: Path) -> Any:
    """Ask a model about a picture: what is said of why that cannot be."""
    picture().save(tmp_path / "lamps.png")

    def ask(model: object, *words: str) -> str:
        code, out, error = tpvqa("ask", "lamps.png", "Is it lit?", "--vlm", f"hf:{model}", *words)
        assert code == 2, out
        assert "Traceback" not in error
        assert error.startswith("error: ")
        return " ".join(error.split())

    return ask


def changed(folder: Path, to: Path, file: str = "config.json", **values: Any) -> Path:
    """A copy of a model with other values in a file; None takes one out."""
    shutil.copytree(folder, to)
    told = json.loads((to / file).read_text()) | values
    kept = {key: value for key, value in told.items() if value is not None}
    (to / file).write_text(json.dumps(kept))
    return to


def test_the_extra_is_missing(asked: Any, monkeypatch: pytest.MonkeyPatch, saved: Saved) -> None:
    folder, found = saved("vilt"), importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name: None if name == "torch" else found(name)
    )
    said = asked(folder)
    assert "needs the package 'torch'" in said
    assert "pip install -e 'packages/tpvqa[hf]'" in said


@pytest.mark.parametrize("name", ["./nowhere", "a/b/c", "/no/such/folder"])
def test_there_is_no_such_folder(asked: Any, name: str) -> None:
    assert "there is no such folder" in asked(name)


def test_no_model_is_named(asked: Any) -> None:
    assert "does not say which model" in asked("")


def test_a_file_is_no_folder(asked: Any) -> None:
    assert "is a file" in asked("lamps.png")


def test_the_hub_is_not_asked_where_that_is_forbidden(
    asked: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    from huggingface_hub import constants

    monkeypatch.setattr(constants, "HF_HUB_OFFLINE", True)
    said = asked("nobody/no-such-model")
    assert "not in the cache" in said
    assert "HF_HUB_OFFLINE" in said


def test_the_hub_cannot_be_reached(asked: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    from huggingface_hub import constants

    monkeypatch.setattr(constants, "ENDPOINT", "http://127.0.0.1:1")
    monkeypatch.setattr(constants, "HF_HUB_OFFLINE", False)
    slept: list[float] = []
    monkeypatch.setattr(time, "sleep", slept.append)  # between tries
    said = asked("nobody/no-such-model")
    assert not slept
    assert "Retrying" not in said
    assert "Is there a network" in said
    assert "name a folder" in said


def test_a_folder_holds_no_model(asked: Any, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    assert "holds no model" in asked("empty")


def test_pickles_are_not_read(asked: Any, tmp_path: Path, saved: Saved) -> None:
    folder = shutil.copytree(saved("vilt"), tmp_path / "old")
    (folder / "model.safetensors").unlink()
    assert "no weights" in asked(folder)
    harm = tmp_path / "harm"

    class Evil:
        def __reduce__(self) -> Any:
            return Path.touch, (harm,)

    (folder / "pytorch_model.bin").write_bytes(pickle.dumps(Evil()))
    said = asked(folder)
    assert "pickles" in said
    assert "safetensors" in said
    assert not harm.exists()


def test_no_code_of_a_models_makers_is_run(asked: Any, tmp_path: Path, saved: Saved) -> None:
    folder = changed(
        saved("vilt"),
        tmp_path / "own",
        model_type="own_thing",
        auto_map={
            "AutoConfig": "configuration.OwnConfig",
            "AutoModelForImageTextToText": "modeling.Own",
        },
    )
    harm = tmp_path / "harm"
    for name in ("configuration", "modeling"):
        (folder / f"{name}.py").write_text(f"open({str(harm)!r}, 'w')\n")
    assert "brings code of its makers" in asked(folder)
    assert not harm.exists()


def test_an_architecture_is_not_known(asked: Any, tmp_path: Path, saved: Saved) -> None:
    folder = changed(saved("vilt"), tmp_path / "new", model_type="never_heard_of")
    assert "knows no such architecture" in asked(folder)


def test_a_model_takes_no_pictures(asked: Any, tmp_path: Path) -> None:
    words = tiny.tokenizer()
    config = transformers.LlamaConfig(**tiny.text(len(words)))
    with quiet():
        transformers.LlamaForCausalLM(config).save_pretrained(tmp_path / "llama")
    words.save_pretrained(tmp_path / "llama")
    assert "takes no pictures" in asked("llama")


def test_a_model_answers_no_questions(asked: Any, tmp_path: Path, saved: Saved) -> None:
    other = ["ViltForMaskedLM"]
    said = asked(changed(saved("vilt"), tmp_path / "masked", architectures=other))
    assert "ViltForMaskedLM, which answers no questions" in said
    labels = {"0": "cat", "1": "dog", "2": "yes"}
    said = asked(changed(saved("vilt"), tmp_path / "animals", id2label=labels))
    assert "yes and no are not both among them" in said


def test_how_a_model_is_asked_is_not_known(asked: Any, tmp_path: Path, saved: Saved) -> None:
    folder = shutil.copytree(saved("llava"), tmp_path / "base")
    (folder / "chat_template.jinja").unlink()
    assert "no chat template" in asked(folder)


def test_weights_are_damaged(asked: Any, tmp_path: Path, saved: Saved) -> None:
    folder = shutil.copytree(saved("blip"), tmp_path / "torn")
    whole = (folder / "model.safetensors").read_bytes()
    (folder / "model.safetensors").write_bytes(whole[: len(whole) // 2])
    assert "cannot be loaded" in asked(folder)


def test_the_processor_is_missing(asked: Any, tmp_path: Path, saved: Saved) -> None:
    folder = shutil.copytree(saved("blip"), tmp_path / "bare")
    for file in folder.glob("*token*"):
        file.unlink()
    (folder / "processor_config.json").unlink()
    assert "cannot be loaded" in asked(folder) or "missing" in asked(folder)


@pytest.mark.parametrize("family", ["vilt", "blip", "smolvlm"])
def test_the_tokenizer_is_missing(asked: Any, family: str, tmp_path: Path, saved: Saved) -> None:
    folder = shutil.copytree(saved(family), tmp_path / "dumb")
    for file in (*folder.glob("tokenizer*"), *folder.glob("vocab*")):
        file.unlink()
    said = asked(folder)
    assert "its tokenizer is missing" in said
    assert "tokenizer.json" in said


@pytest.mark.parametrize("device", ["cuda", "cuda:7", "mps"])
def test_there_is_no_such_device(asked: Any, device: str, saved: Saved) -> None:
    import torch

    there = torch.backends.mps if device == "mps" else torch.cuda
    if not there.is_available():
        assert f"--device {device}" in asked(saved("vilt"), "--device", device)


def test_the_model_of_an_adapter_is_gone(asked: Any, tmp_path: Path) -> None:
    folder = tmp_path / "adapter"
    folder.mkdir()
    told = {"base_model_name_or_path": "/not/there/now", "peft_type": "LORA"}
    (folder / "adapter_config.json").write_text(json.dumps(told))
    assert "adapter_model.safetensors" in asked(folder)
    (folder / "adapter_model.safetensors").write_bytes(b"")
    assert "is not there. Put it back" in asked(folder)
    importing = {"megatron_config": {"a": 1}, "megatron_core": "this"}
    for other in ({"peft_type": "IA3"}, importing):
        (folder / "adapter_config.json").write_text(json.dumps(told | other))
        assert "only plain LoRA adapters are read" in asked(folder)


_LITTLE_MEMORY = """
import resource, sys
import torch, transformers, peft
from tpvqa.cli import main
torch.set_num_threads(1)
pages = int(open("/proc/self/statm").read().split()[0])
limit = pages * resource.getpagesize() + 700 * 2**20
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
sys.argv = ["tpvqa", *sys.argv[1:]]
main()
"""


@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are Linux's")
def test_memory_does_not_suffice(tmp_path: Path, saved: Saved) -> None:
    """For real: attention over so many patches takes some gigabytes, and there is less."""
    size = {"shortest_edge": 1024}
    file = "processor_config.json"
    told = json.loads((saved("vilt") / file).read_text())
    images = told["image_processor"] | {"size": size}
    folder = changed(saved("vilt"), tmp_path / "large", file, image_processor=images)
    picture(size=64).save(tmp_path / "lamps.png")
    words = ["ask", str(tmp_path / "lamps.png"), "Is it lit?", "--vlm", f"hf:{folder}"]
    done = subprocess.run(
        [sys.executable, "-c", _LITTLE_MEMORY, *words, "--device", "cpu"],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    assert "out of memory. Take a smaller model" in done.stderr
    assert "Traceback" not in done.stderr
