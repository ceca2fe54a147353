"""The folder that holds a trained network, and what must lie in it."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tpvqa.errors import AnswerError
from tpvqa_household.embedded.lexicon import Lexicon

SHIPPED = Path(__file__).with_name("weights")
DESCRIPTION, IMAGE, HEAD = "network.json", "image.onnx", "head.onnx"
FROZEN, LIMITS = "frozen.onnx", "limits.npz"
"""What a network has that knows its limits: the frozen branch, and what is compared."""


@dataclass(frozen=True)
class Weights:
    """A trained network on disk.

    Attributes:
        folder: Where it lies.
        lexicon: The questions it knows.
        temperature: What its logits are divided by, fitted on held-out kitchens.
        side: Side of its square pictures, pixels.
        description: The rest of its description: how it was trained, hashes, versions.
    """

    folder: Path
    lexicon: Lexicon
    temperature: float
    side: int
    description: Mapping[str, Any]

    @property
    def fingerprint(self) -> str:
        """Tells networks apart, with their words and temperature."""
        told = json.dumps(dict(self.description), sort_keys=True)
        return hashlib.sha256(told.encode()).hexdigest()[:16]

    @classmethod
    def read(cls, folder: Path = SHIPPED) -> "Weights":
        """Read the description and check the hashes.

        Raises:
            AnswerError: Something is missing or damaged.
        """
        remedy = (
            "Install tpvqa-household again, or export the weights: "
            "python -m tpvqa_household.training.export"
        )
        try:
            data = json.loads((folder / DESCRIPTION).read_text(encoding="utf-8"))
            for name, expected in data["sha256"].items():
                found = hashlib.sha256((folder / name).read_bytes()).hexdigest()
                if found != expected:
                    raise AnswerError(f"{folder / name} is damaged: its hash differs. {remedy}")
            return cls(
                folder,
                Lexicon.from_json(data["lexicon"]),
                float(data["temperature"]),
                int(data["side"]),
                data,
            )
        except OSError as error:
            raise AnswerError(
                f"The network's weights are missing in {folder} ({error.strerror}). {remedy}"
            ) from error
        except (ValueError, KeyError, TypeError) as error:
            raise AnswerError(
                f"{folder / DESCRIPTION} does not describe a network ({error!r}). {remedy}"
            ) from error
