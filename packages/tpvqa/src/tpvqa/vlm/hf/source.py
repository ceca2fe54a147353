"""What a model's name means: a folder on disk, or a name on the hub."""

import json
import re
from dataclasses import dataclass
from pathlib import Path

from tpvqa.errors import AnswerError

ADAPTER = "adapter_config.json"
ADAPTER_WEIGHTS = "adapter_model.safetensors"
CONFIG = "config.json"
_HUB_NAME = re.compile(r"[A-Za-z0-9][\w.-]{0,95}(/[A-Za-z0-9][\w.-]{0,95})?")
_LARGEST = 2**20
VOCABULARIES = ("tokenizer.json", "vocab.txt", "vocab.json", "*.model", "*.tiktoken", "tekken.json")
"""Files that hold a tokenizer's words, of which a model has one: without any, transformers makes a
tokenizer that knows none."""


@dataclass(frozen=True, slots=True)
class Source:
    """Where a model comes from.

    Attributes:
        base: The folder or the hub's name of the model itself.
        adapter: A folder with an adapter for it, where one was named.
    """

    base: str
    adapter: Path | None = None

    @property
    def on_disk(self) -> bool:
        """Whether the model is a folder."""
        return Path(self.base).is_dir()


def source_of(model: str) -> Source:
    """Find out what a name means; a folder of that name goes before the hub.

    Raises:
        AnswerError: It is neither a folder of a model or an adapter, nor a name of the hub's form.
    """
    folder = Path(model).expanduser()
    if folder.is_dir():
        if (folder / ADAPTER).is_file():
            return Source(_base_of(folder), folder)
        _see_model(folder)
        return Source(str(folder))
    if folder.exists():
        raise AnswerError(f"hf:{model} is a file. Name the folder that holds the model.")
    if _HUB_NAME.fullmatch(model) is None:
        raise AnswerError(
            f"hf:{model}: there is no such folder. Name one that holds a model (config.json, "
            "weights as safetensors, its processor), or a model of the hub, e.g. "
            "hf:HuggingFaceTB/SmolVLM-256M-Instruct."
        )
    return Source(model)


def _see_model(folder: Path) -> None:
    if not (folder / CONFIG).is_file():
        raise AnswerError(
            f"hf:{folder}: the folder holds no model: it has neither {CONFIG} nor {ADAPTER}. Name "
            "a folder that `save_pretrained`, a download of the hub or `tpvqa train` wrote."
        )
    safe = any(folder.glob("*.safetensors")) or any(folder.glob("*.safetensors.index.json"))
    if not safe and any(folder.glob("*.bin")):
        raise AnswerError(
            f"hf:{folder}: its weights are pickles (*.bin), which can run code when they are "
            "read. Where you trust it, load it with transformers and save it again: "
            "`save_pretrained` writes safetensors."
        )
    if not safe:
        raise AnswerError(f"hf:{folder}: there are no weights (*.safetensors) in it.")
    if not any(any(folder.glob(name)) for name in VOCABULARIES):
        raise AnswerError(
            f"hf:{folder}: its tokenizer is missing: there is none of {', '.join(VOCABULARIES)}. "
            "Put it beside the weights, as `save_pretrained` of the processor or a download of the "
            "hub leaves it."
        )


def _base_of(folder: Path) -> str:
    """The model that an adapter is for; a relative folder is meant from the adapter's."""
    if not (folder / ADAPTER_WEIGHTS).is_file():
        raise AnswerError(f"hf:{folder}: the adapter's weights ({ADAPTER_WEIGHTS}) are missing.")
    try:
        with (folder / ADAPTER).open("rb") as file:
            told = json.loads(file.read(_LARGEST))
        base, kind = told["base_model_name_or_path"], told.get("peft_type")
        # A name of a module would make peft import it.
        if kind != "LORA" or told.get("megatron_config"):
            raise ValueError("only plain LoRA adapters are read")
        if not isinstance(base, str) or not base:
            raise ValueError("no model is named in it")
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise AnswerError(f"hf:{folder}: {ADAPTER} cannot be used ({error}).") from None
    for path in (folder / base, Path(base)):
        if path.is_dir():
            _see_model(path)
            return str(path)
    if _HUB_NAME.fullmatch(base) is None:
        raise AnswerError(
            f"hf:{folder}: the model that this adapter is for, {base}, is not there. Put it back, "
            f"or name its new place in {folder / ADAPTER} (base_model_name_or_path)."
        )
    return base
