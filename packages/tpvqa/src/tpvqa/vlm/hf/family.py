"""What families of models have in common: pictures and a question in, probabilities out."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from tpvqa.vlm.reading import Reading

if TYPE_CHECKING:
    import torch
    from PIL import Image


@dataclass(frozen=True, slots=True)
class Asked:
    """One question about pictures.

    Attributes:
        pictures: RGB; several where the model takes several at once.
        text: The question.
    """

    pictures: "tuple[Image.Image, ...]"
    text: str


@dataclass(frozen=True, slots=True)
class Loaded:
    """A model as it was loaded.

    Attributes:
        name: Of the VLM, for messages.
        model: Of transformers; an adapter is part of it already.
        processor: Turns pictures and text into its input.
        device: Where it runs.
    """

    name: str
    model: Any
    processor: Any
    device: "torch.device"


class Family(Protocol):
    """How the models of an architecture are asked."""

    @property
    def source(self) -> str:
        """What `Answer.source` calls its probabilities."""

    @property
    def several(self) -> bool:
        """Whether it takes several pictures in one question."""

    def log_masses(self, asked: Sequence[Asked]) -> "torch.Tensor":
        """The natural logarithms of P(yes) and P(no), each among all that it might say.

        Can be differentiated where gradients are on, so it serves training, too.

        Args:
            asked: Questions, perhaps about different pictures.

        Returns:
            Float32, questions × 2.
        """

    def at_length(self, asked: Asked) -> Reading | None:
        """What it says where its first word is neither yes nor no; None where it has no words."""
