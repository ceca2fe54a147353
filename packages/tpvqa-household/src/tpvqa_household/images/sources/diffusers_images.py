"""Diffusion models on this machine, by the library diffusers."""

import importlib.util
from pathlib import Path
from typing import Any

from tpvqa.errors import GeneratorError, MissingExtraError, PictureRefused
from tpvqa_household import DISTRIBUTION
from tpvqa_household.images.sources.generator import Drawn, Original
from tpvqa_household.images.sources.picture_file import as_png, read_picture, square

PACKAGES = ("diffusers", "transformers", "torch")
STRENGTH = 0.45
"""How much of a picture a variation gives up: more changes what is true in it, less nothing."""


class DiffusersImages:
    """Image-to-image and text-to-image pipelines of one model; seeds decide their pictures.

    Args:
        model: A name on the Hugging Face hub, or a folder that holds a saved pipeline.
        device: "cuda", "mps", "cpu"; by default the best that there is.
        side: Pixels of a picture's side; a multiple of 8.
        steps: Of denoising; None for the pipeline's own number.
        strength: Of a variation, 0 to 1.

    Raises:
        MissingExtraError: A package is not installed.
    """

    remote = False
    price: float | None = 0.0
    requests = 0

    def __init__(
        self,
        model: str,
        *,
        device: str | None = None,
        side: int = 512,
        steps: int | None = None,
        strength: float = STRENGTH,
    ) -> None:
        for package in PACKAGES:
            if importlib.util.find_spec(package) is None:
                raise MissingExtraError(
                    package,
                    "diffusion",
                    f"The generator 'diffusers:{model}'",
                    distribution=DISTRIBUTION,
                )
        self.model = model
        self._device, self._side, self._steps, self._strength = device, side, steps, strength
        self._from_image: Any = None
        self._from_text: Any = None

    @property
    def name(self) -> str:
        """ "diffusers:MODEL"."""
        return f"diffusers:{self.model}"

    @property
    def settings(self) -> str:
        """Side, steps and strength."""
        return f"side={self._side} steps={self._steps} strength={self._strength}"

    def vary(self, original: Original, *, seed: int) -> Drawn:
        """Image to image, from the original and its prompt."""
        if self._from_image is None:
            self._from_image = self._load("AutoPipelineForImage2Image", self._from_text)
        image = square(read_picture(original.data), self._side)
        return self._draw(
            self._from_image,
            seed,
            prompt=original.prompt,
            image=image,
            strength=self._strength,
        )

    def generate(self, prompt: str, *, seed: int) -> Drawn:
        """Text to image."""
        if self._from_text is None:
            self._from_text = self._load("AutoPipelineForText2Image", self._from_image)
        return self._draw(self._from_text, seed, prompt=prompt, width=self._side, height=self._side)

    def close(self) -> None:
        """Let go of the model. Can be called twice."""
        self._from_image = self._from_text = None

    def _load(self, kind: str, sibling: Any) -> Any:
        """A pipeline; from one of the same model its weights are shared."""
        try:
            import diffusers
            import torch

            loader = getattr(diffusers, kind)
            if sibling is not None:
                pipeline = loader.from_pipe(sibling)
            else:
                pipeline = loader.from_pretrained(self.model)
                pipeline = pipeline.to(self._device or _best_device(torch))
            pipeline.set_progress_bar_config(disable=True)
        except (OSError, ValueError, RuntimeError, ImportError) as error:
            folder = Path(self.model).expanduser().is_dir()
            what = "this folder holds no" if folder else "there is no such"
            raise GeneratorError(
                f"{self.name} cannot be loaded: {what} pipeline that makes pictures, or it needs "
                f"more than there is here ({error})"
            ) from error
        return pipeline

    def _draw(self, pipeline: Any, seed: int, **asked: Any) -> Drawn:
        import torch

        if self._steps is not None:
            asked["num_inference_steps"] = self._steps
        try:
            # On the CPU, so that a seed is the same picture's whatever the device.
            made = pipeline(generator=torch.Generator("cpu").manual_seed(seed), **asked)
        except (RuntimeError, ValueError) as error:
            raise GeneratorError(f"{self.name} cannot make a picture: {error}") from error
        if any(getattr(made, "nsfw_content_detected", None) or ()):
            raise PictureRefused("the model's own filter refused what it had made")
        return Drawn(as_png(made.images[0].convert("RGB")))


def _best_device(torch: Any) -> str:
    if torch.cuda.is_available():
        return "cuda"
    return "mps" if torch.backends.mps.is_available() else "cpu"
