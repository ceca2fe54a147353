"""BLIP for visual question answering (Li et al. 2022): yes and no are tried as its answer."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from tpvqa.vlm.hf.family import Asked, Loaded

if TYPE_CHECKING:
    import torch

ANSWERS = ("yes", "no")


class Blip:
    """Reads how probable each whole answer is, its end included (teacher forcing).

    Each picture is encoded once, however many questions there are about it.

    Args:
        loaded: A `BlipForQuestionAnswering`.
    """

    source = "likelihood"
    several = False

    def __init__(self, loaded: Loaded):
        self._loaded = loaded
        tokenizer = loaded.processor.tokenizer
        self._answers = [
            [*tokenizer(word, add_special_tokens=False).input_ids, tokenizer.sep_token_id]
            for word in ANSWERS
        ]

    def log_masses(self, asked: Sequence[Asked]) -> "torch.Tensor":
        """See `Family`."""
        import torch

        loaded, model = self._loaded, self._loaded.model
        numbers: dict[int, int] = {}
        shown = [numbers.setdefault(id(each.pictures[0]), len(numbers)) for each in asked]
        pictures = {id(each.pictures[0]): each.pictures[0] for each in asked}
        pixels = loaded.processor.image_processor(
            [pictures[key] for key in numbers], return_tensors="pt"
        ).pixel_values.to(loaded.device, model.dtype)
        seen = model.vision_model(pixel_values=pixels).last_hidden_state[shown]
        words = loaded.processor.tokenizer(
            [each.text for each in asked], padding=True, truncation=True, return_tensors="pt"
        ).to(loaded.device)
        question = model.text_encoder(
            input_ids=words.input_ids,
            attention_mask=words.attention_mask,
            encoder_hidden_states=seen,
            encoder_attention_mask=torch.ones(
                seen.shape[:-1], dtype=torch.long, device=loaded.device
            ),
        ).last_hidden_state
        sides = [self._log_of(answer, question, words.attention_mask) for answer in self._answers]
        return torch.stack(sides, -1)

    def _log_of(
        self, answer: Sequence[int], question: "torch.Tensor", mask: "torch.Tensor"
    ) -> "torch.Tensor":
        """The logarithm of the probability of an answer to each question."""
        import torch

        model, device = self._loaded.model, self._loaded.device
        start = model.decoder_start_token_id
        before = torch.tensor([[start, *answer[:-1]]], device=device).expand(len(question), -1)
        said = torch.tensor(answer, device=device).expand(len(question), -1)
        logits = model.text_decoder(
            input_ids=before,
            encoder_hidden_states=question,
            encoder_attention_mask=mask,
            use_cache=False,
        ).logits
        told = logits.float().log_softmax(-1).gather(-1, said[..., None])
        return told.squeeze(-1).sum(-1)

    def at_length(self, asked: Asked) -> None:
        """Its answers are compared, not spoken."""
