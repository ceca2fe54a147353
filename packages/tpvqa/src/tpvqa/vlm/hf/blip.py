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
            [each.text for each in asked],
            padding=True,
            padding_side="right",
            truncation=True,
            return_tensors="pt",
        ).to(loaded.device)
        question = model.text_encoder(
            input_ids=words.input_ids,
            attention_mask=words.attention_mask,
            encoder_hidden_states=seen,
            encoder_attention_mask=torch.ones(
                seen.shape[:-1], dtype=torch.long, device=loaded.device
            ),
        ).last_hidden_state
        # By length, as the decoder of transformers 5.23 heeds no mask of what it answers.
        lengths = words.attention_mask.sum(-1)
        told = question.new_empty(len(asked), len(ANSWERS), dtype=torch.float32)
        for length in torch.unique(lengths).tolist():
            rows = (lengths == length).nonzero().squeeze(-1)
            sides = [self._log_of(answer, question[rows, :length]) for answer in self._answers]
            told = told.index_copy(0, rows, torch.stack(sides, -1))
        return told

    def _log_of(self, answer: Sequence[int], question: "torch.Tensor") -> "torch.Tensor":
        """The logarithm of the probability of an answer to each question, none of them padded."""
        import torch

        model, device = self._loaded.model, self._loaded.device
        start = model.decoder_start_token_id
        before = torch.tensor([[start, *answer[:-1]]], device=device).expand(len(question), -1)
        said = torch.tensor(answer, device=device).expand(len(question), -1)
        logits = model.text_decoder(
            input_ids=before,
            encoder_hidden_states=question,
            use_cache=False,
        ).logits
        told = logits.float().log_softmax(-1).gather(-1, said[..., None])
        return told.squeeze(-1).sum(-1)

    def at_length(self, asked: Asked) -> None:
        """Its answers are compared, not spoken."""
