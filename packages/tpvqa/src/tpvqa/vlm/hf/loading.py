"""From a name to a model that can be asked. No code of a model's makers is ever run."""

import importlib.util
from typing import Any

from tpvqa.errors import AnswerError, MissingExtraError
from tpvqa.vlm.hf.blip import Blip
from tpvqa.vlm.hf.chat import Chat
from tpvqa.vlm.hf.device import device_of, dtype_of
from tpvqa.vlm.hf.failures import told_plainly
from tpvqa.vlm.hf.family import Family, Loaded
from tpvqa.vlm.hf.processors import processor_of
from tpvqa.vlm.hf.quiet import quiet
from tpvqa.vlm.hf.source import CONFIG, Source, source_of
from tpvqa.vlm.hf.vilt import Vilt

PACKAGES = ("torch", "transformers", "peft")

_ANSWERING = {
    "vilt": ("ViltForQuestionAnswering", "hf:dandelin/vilt-b32-finetuned-vqa"),
    "blip": ("BlipForQuestionAnswering", "hf:Salesforce/blip-vqa-base"),
}
"""Architectures with a class for questions, and a model of each."""


def see_installed(purpose: str) -> None:
    """See that the extra is installed, without importing it.

    Raises:
        MissingExtraError: It is not.
    """
    for package in PACKAGES:
        if importlib.util.find_spec(package) is None:
            raise MissingExtraError(package, "hf", purpose)


def load(model: str, *, device: str, dtype: str, trained: bool = True) -> Loaded:
    """Load a model with its processor.

    Args:
        model: A folder, or a name on the hub.
        device: See `device_of`.
        dtype: See `dtype_of`.
        trained: Whether an adapter that the folder holds is put on.

    Raises:
        AnswerError: It is not there, takes no pictures, holds pickles or code, or does not fit.
    """
    name, source = f"hf:{model}", source_of(model)
    where = device_of(device)
    with quiet(), told_plainly(name, "loaded"):
        try:
            _see_had(name, source)
            config = _config(name, source)
            kind = _class_of(name, config)
            made = kind.from_pretrained(
                source.base,
                config=config,
                dtype=dtype_of(dtype, where),
                use_safetensors=True,
                trust_remote_code=False,
            )
            processor = processor_of(source.base, config)
        except (OSError, ConnectionError) as error:
            raise AnswerError(_not_had(name, source, error)) from None
        if source.adapter is not None and trained:
            from peft import PeftModel

            made = PeftModel.from_pretrained(made, str(source.adapter)).get_base_model()
        made.requires_grad_(False).eval().to(where)
    return Loaded(name, made, processor, where)


def family_of(loaded: Loaded) -> Family:
    """How a model is asked.

    Raises:
        AnswerError: It cannot say yes and no.
    """
    kinds: dict[str, type[Vilt] | type[Blip]] = {"vilt": Vilt, "blip": Blip}
    return kinds.get(loaded.model.config.model_type, Chat)(loaded)


def _config(name: str, source: Source) -> Any:
    from transformers import AutoConfig

    try:
        return AutoConfig.from_pretrained(source.base, trust_remote_code=False)
    except ValueError as error:
        if "trust_remote_code" in str(error) or "custom code" in str(error):
            raise AnswerError(
                f"{name} brings code of its makers, which is not run here. Take a model that "
                "transformers knows itself, or serve it and take --vlm openai:MODEL."
            ) from None
        if "model_type" in str(error) or "model type" in str(error):
            import transformers

            raise AnswerError(
                f"{name}: transformers {transformers.__version__} knows no such architecture. "
                "Install a later release of it, or serve the model and take --vlm openai:MODEL."
            ) from None
        raise


def _class_of(name: str, config: Any) -> Any:
    import transformers
    from transformers import AutoModelForImageTextToText

    known = _ANSWERING.get(config.model_type)
    if known is not None:
        kind, example = known
        if config.architectures and kind not in config.architectures:
            raise AnswerError(
                f"{name} is a {config.architectures[0]}, which answers no questions. Take one that "
                f"was fine-tuned for it (a {kind}), e.g. {example}."
            )
        return getattr(transformers, kind)
    if type(config) not in transformers.MODEL_FOR_IMAGE_TEXT_TO_TEXT_MAPPING:
        raise AnswerError(
            f"{name} ({config.model_type}) takes no pictures with a question. Take a model for "
            "images and text to text, e.g. hf:HuggingFaceTB/SmolVLM-256M-Instruct."
        )
    return AutoModelForImageTextToText


def _see_had(name: str, source: Source) -> None:
    """See that a model is here or on the hub: asked once, as transformers tries for half a minute.

    Raises:
        AnswerError: It is not.
    """
    from huggingface_hub import get_hf_file_metadata, hf_hub_url, try_to_load_from_cache

    if source.on_disk or isinstance(try_to_load_from_cache(source.base, CONFIG), str):
        return
    try:
        get_hf_file_metadata(hf_hub_url(source.base, CONFIG))
    except Exception as error:  # noqa: BLE001  of whichever HTTP client the hub's package takes
        raise AnswerError(_not_had(name, source, error)) from None


def _not_had(name: str, source: Source, error: Exception) -> str:
    said = " ".join(str(error).split())[:300]
    if source.on_disk:
        return f"{name}: something is missing in the folder, or damaged: {said}"
    from huggingface_hub import is_offline_mode

    if is_offline_mode():
        return (
            f"{name}: there is no folder of that name here, the model is not in the cache, and "
            "HF_HUB_OFFLINE forbids to ask the hub. Name a folder that holds it, or leave that "
            "variable out."
        )
    return (
        f"{name}: there is no folder of that name here, and the hub did not give such a model. Is "
        "there a network, and is the name right? Without a network, name a folder that holds the "
        f"model. ({said})"
    )
