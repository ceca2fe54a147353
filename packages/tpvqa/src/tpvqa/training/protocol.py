"""The seam of whatever trains a VLM."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from tpvqa.training.example import Example


@dataclass(frozen=True, slots=True)
class TrainingSettings:
    """How to train; a trainer passes over what means nothing to it.

    Attributes:
        epochs: How often each example is seen.
        rate: The learning rate; None for the trainer's own.
        batch: Examples a step.
        rank: Of an adapter.
        seed: Decides the order of the examples and the first weights.
    """

    epochs: int = 3
    rate: float | None = None
    batch: int = 8
    rank: int = 8
    seed: int = 0

    def plain(self) -> dict[str, Any]:
        """As JSON has it."""
        return asdict(self)


@runtime_checkable
class Noticing(Protocol):
    """A trainer that has something to say of what it learnt, or could not.

    Attributes:
        notices: Sentences, after `fit`.
    """

    notices: Sequence[str]


@runtime_checkable
class Trainer(Protocol):
    """Trains the VLM of a specification."""

    def fit(
        self,
        examples: Sequence[Example],
        folder: Path,
        *,
        settings: TrainingSettings,
        progress: Callable[[int, int], None],
    ) -> None:
        """Train, and leave what was learnt in a folder.

        Stopped at any moment, the same call goes on where it was; nothing of it is lost on Ctrl-C,
        and little when it is killed.

        Args:
            examples: What to learn.
            folder: Is there, and holds what an earlier call with the same arguments left.
            settings: How.
            progress: Told of the steps that are done, and how many there are.

        Raises:
            TpvqaError: It cannot be trained.
            KeyboardInterrupt: Ctrl-C, after everything was kept.
        """

    def save(self, folder: Path) -> str:
        """Write what was learnt into a folder that is not there yet.

        Returns:
            The specification of the trained VLM, for as long as the folder lies there.
        """
