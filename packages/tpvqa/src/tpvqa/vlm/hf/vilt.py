"""ViLT (Kim et al. 2021): a classifier over answers; picture and words go through it together."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from tpvqa.errors import AnswerError
from tpvqa.vlm.hf.family import Asked, Loaded
from tpvqa.vlm.yes_no import meaning

if TYPE_CHECKING:
    import torch


class Vilt:
    """Reads the softmax over the classes of answers.

    Args:
        loaded: A `ViltForQuestionAnswering`.

    Raises:
        AnswerError: Yes or no is none of its classes.
    """

    source = "classes"
    several = False

    def __init__(self, loaded: Loaded):
        self._loaded = loaded
        self._classes: dict[str, list[int]] = {"yes": [], "no": []}
        for number, label in loaded.model.config.id2label.items():
            word = meaning(str(label))
            if word is not None:
                self._classes[word].append(int(number))
        if not all(self._classes.values()):
            raise AnswerError(
                f"{loaded.name} answers with classes, and yes and no are not both among them. "
                "Take one that was fine-tuned for visual question answering, e.g. "
                "hf:dandelin/vilt-b32-finetuned-vqa."
            )

    def log_masses(self, asked: Sequence[Asked]) -> "torch.Tensor":
        """See `Family`."""
        import torch

        loaded = self._loaded
        inputs = loaded.processor(
            images=[each.pictures[0] for each in asked],
            text=[each.text for each in asked],
            padding=True,
            truncation=True,
            return_tensors="pt",
        ).to(loaded.device, loaded.model.dtype)
        logits = loaded.model(**inputs).logits.float().log_softmax(-1)
        sides = (logits[:, self._classes[word]].logsumexp(-1) for word in ("yes", "no"))
        return torch.stack(list(sides), -1)

    def at_length(self, asked: Asked) -> None:
        """It has no words."""
