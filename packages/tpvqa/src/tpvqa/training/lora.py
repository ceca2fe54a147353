"""LoRA adapters (Hu et al. 2022) for the local models of `--vlm hf:MODEL`."""

import io
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tpvqa.chance import chance
from tpvqa.errors import PictureError, TrainingError, WriteError
from tpvqa.files import write_whole
from tpvqa.pictures import in_colour
from tpvqa.training.example import Example
from tpvqa.training.protocol import TrainingSettings
from tpvqa.training.stopping import between_steps
from tpvqa.vlm.hf.device import AUTO
from tpvqa.vlm.hf.failures import told_plainly
from tpvqa.vlm.hf.family import Asked, Family
from tpvqa.vlm.hf.loading import family_of, load, see_installed
from tpvqa.vlm.hf.quiet import quiet
from tpvqa.vlm.hf.source import source_of

if TYPE_CHECKING:
    from PIL import Image

CHECKPOINT = "checkpoint.pt"
RATE = 2e-4
EVERY = 30.0
"""Seconds between checkpoints."""
_ROOM = "Make room, or name another folder with --out"
_RISING = 0.05
_KEPT = 256
"""Decoded pictures that are kept."""


class LoraTrainer:
    """Fits an adapter of low rank to every linear layer; the model itself stays as it is.

    What is lessened is -log P(right answer) as the VLM reads it: among all of a chat model's first
    tokens, all of ViLT's classes, all that BLIP might answer. Dropout is off, so that a training
    that was stopped and gone on with comes to the same adapter.

    Args:
        model: A folder, or a name on the hub; no adapter.
        device: See `HuggingFaceVLM`.
        dtype: The same; the adapter itself is float32.

    Raises:
        MissingExtraError: torch, transformers or peft is not installed.
        TrainingError: The folder holds an adapter.
    """

    def __init__(self, model: str, *, device: str = AUTO, dtype: str = AUTO):
        self._name = f"hf:{model}"
        see_installed(f"Training {self._name!r}")
        self._source = source_of(model)
        if self._source.adapter is not None:
            raise TrainingError(
                f"{self._name} is an adapter already. Train the model that it is for, "
                f"hf:{self._source.base}, with all pictures together"
            )
        self._model, self._device, self._dtype = model, device, dtype
        self._adapted: Any = None

    @classmethod
    def from_spec(cls, arguments: str, *, device: str = AUTO, dtype: str = AUTO) -> "LoraTrainer":
        """Make it from `hf:MODEL`."""
        return cls(arguments, device=device, dtype=dtype)

    def fit(
        self,
        examples: Sequence[Example],
        folder: Path,
        *,
        settings: TrainingSettings,
        progress: Callable[[int, int], None],
    ) -> None:
        """See `Trainer`."""
        with told_plainly(self._name, "trained"):
            fitting = _Fitting(self._load(settings), examples, settings)
            self._adapted = fitting.adapted
            fitting.restore(folder / CHECKPOINT)
            saved = time.monotonic()
            with between_steps() as stop:
                progress(fitting.done, fitting.steps)
                while fitting.done < fitting.steps:
                    fitting.step()
                    progress(fitting.done, fitting.steps)
                    over = fitting.done == fitting.steps
                    if over or stop() or time.monotonic() - saved > EVERY:
                        fitting.keep(folder / CHECKPOINT)
                        saved = time.monotonic()
                    if stop() and not over:
                        raise KeyboardInterrupt

    def _load(self, settings: TrainingSettings) -> tuple[Family, Any]:
        import torch
        from peft import LoraConfig, get_peft_model

        loaded = load(self._model, device=self._device, dtype=self._dtype)
        torch.manual_seed(settings.seed)
        config = LoraConfig(
            r=settings.rank,
            lora_alpha=2 * settings.rank,
            lora_dropout=0.0,
            target_modules="all-linear",
        )
        with quiet():
            adapted = get_peft_model(loaded.model, config)
        adapted.eval()
        return family_of(loaded), adapted

    def save(self, folder: Path) -> str:
        """See `Trainer`; a model's own folder is written down with its whole path."""
        config = self._adapted.peft_config["default"]
        base = self._source.base
        config.base_model_name_or_path = str(Path(base).resolve()) if self._source.on_disk else base
        try:
            with quiet():
                self._adapted.save_pretrained(str(folder), safe_serialization=True)
            (folder / "README.md").unlink(missing_ok=True)  # a form with nothing filled in
        except OSError as error:
            raise WriteError.of(folder, error, _ROOM) from error
        return f"hf:{folder}"


class _Fitting:
    """The state of a training between two steps."""

    def __init__(
        self, made: tuple[Family, Any], examples: Sequence[Example], settings: TrainingSettings
    ):
        import torch

        self._family, self.adapted = made
        self._examples, self._settings = examples, settings
        self._weights = {n: p for n, p in self.adapted.named_parameters() if p.requires_grad}
        self._rate = RATE if settings.rate is None else settings.rate
        self._optimizer = torch.optim.AdamW(self._weights.values(), weight_decay=0.0)
        self._per_epoch = -(-len(examples) // settings.batch)
        self.steps, self.done = settings.epochs * self._per_epoch, 0
        self._pictures: dict[str, Image.Image] = {}

    def step(self) -> None:
        """Learn from the next few examples."""
        import torch

        torch.manual_seed(self._settings.seed + self.done)  # some architectures draw, as ViLT does
        batch = self._batch()
        for group in self._optimizer.param_groups:
            group["lr"] = self._rate * self._share()
        self._optimizer.zero_grad()
        logs = self._family.log_masses([self._asked(each) for each in batch])
        truth = torch.tensor([0 if each.truth else 1 for each in batch], device=logs.device)
        loss = -logs.gather(-1, truth[:, None]).mean()
        if not bool(torch.isfinite(loss)):
            raise TrainingError(
                f"after {self.done} steps the loss is no number any more. Take a smaller --rate, "
                "or --dtype float32"
            )
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self._weights.values(), 1.0)
        self._optimizer.step()
        self.done += 1

    def _share(self) -> float:
        """Of the learning rate: it rises over the first twentieth and then falls to nothing."""
        return min((self.done + 1) / (_RISING * self.steps), 1 - self.done / self.steps)

    def _batch(self) -> list[Example]:
        epoch, at = divmod(self.done, self._per_epoch)
        order = list(range(len(self._examples)))
        chance(self._settings.seed, 0, "order of training", epoch).shuffle(order)
        size = self._settings.batch
        return [self._examples[number] for number in order[at * size : (at + 1) * size]]

    def _asked(self, example: Example) -> Asked:
        if example.picture not in self._pictures:
            if len(self._pictures) >= _KEPT:
                self._pictures.pop(next(iter(self._pictures)))
            try:
                self._pictures[example.picture] = in_colour(example.data)
            except PictureError as error:
                raise TrainingError(f"A picture {error}") from error
        return Asked((self._pictures[example.picture],), example.text)

    def keep(self, path: Path) -> None:
        """Write everything down that the next step needs."""
        import torch

        file = io.BytesIO()
        state = {
            "done": self.done,
            "weights": {name: weight.detach().cpu() for name, weight in self._weights.items()},
            "optimizer": self._optimizer.state_dict(),
        }
        torch.save(state, file)
        write_whole(path, file.getvalue(), remedy=_ROOM, durable=True)

    def restore(self, path: Path) -> None:
        """Take up what was written down, if anything was.

        Raises:
            TrainingError: It is damaged.
        """
        import torch

        if not path.is_file():
            return
        try:
            state = torch.load(path, map_location="cpu", weights_only=True)
            with torch.no_grad():
                for name, weight in self._weights.items():
                    weight.copy_(state["weights"][name])
            self._optimizer.load_state_dict(state["optimizer"])
            self.done = int(state["done"])
        except Exception as error:  # torch raises of every kind
            raise TrainingError(f"{path} is damaged. Remove its folder to begin anew") from error
