"""Questions about the same pictures share what stands before them: the pictures go through once.

Sound where a token is changed by nothing that follows it, which is known of the architectures that
are named here; each is tested beside the plain call. Others (PaliGemma and Gemma 3 let tokens look
ahead) are asked with the pictures beside every question.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import torch

SHARING = frozenset({"idefics3", "internvl", "llava", "qwen2_vl", "qwen2_5_vl", "smolvlm"})
"""Architectures of causal attention, by transformers' names."""
_OF_TOKENS = ("input_ids", "attention_mask", "mm_token_type_ids", "token_type_ids")


def last_logits(model: Any, inputs: Mapping[str, "torch.Tensor"]) -> "torch.Tensor | None":
    """Logits after the last token of each prompt, all of which are about the same pictures.

    Args:
        model: Of one of `SHARING`.
        inputs: Prompts that are padded on the right, each with the pictures.

    Returns:
        Prompts × vocabulary; None where the prompts differ before the pictures' end.
    """
    import torch

    ids, mask = inputs["input_ids"], inputs["attention_mask"]
    count, ends = len(ids), mask.sum(-1) - 1
    alike = (ids == ids[0]).all(0) & mask.all(0).bool()
    common = int(alike.long().cumprod(0).sum())
    common = min(common, int(ends.min()))  # of each prompt at least its last token is left
    if common == 0 or bool((ids[:, common:] == model.config.image_token_id).any()):
        return None
    first = {
        name: value[:1, :common] if name in _OF_TOKENS else value[: len(value) // count]
        for name, value in inputs.items()
    }
    begun = model(**first, use_cache=True, logits_to_keep=1)
    begun.past_key_values.batch_repeat_interleave(count)
    places = torch.arange(common, ids.shape[1], device=ids.device).expand(count, -1)
    if hasattr(model.model, "get_rope_index"):  # Qwen numbers patches by row and column
        named = ("image_grid_thw", "attention_mask", "mm_token_type_ids")
        every, _ = model.model.get_rope_index(ids, **{name: inputs[name] for name in named})
        places = every[..., common:]
    kept, place = torch.unique(ends - common, return_inverse=True)
    logits: torch.Tensor = model(
        input_ids=ids[:, common:],
        attention_mask=mask,
        position_ids=places,
        past_key_values=begun.past_key_values,
        use_cache=True,
        logits_to_keep=kept,
    ).logits
    return logits[torch.arange(count, device=logits.device), place]
