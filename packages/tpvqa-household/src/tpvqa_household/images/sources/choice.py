"""The generator that a specification names: openai:MODEL, diffusers:MODEL, rerender, none."""

from collections.abc import Mapping
from dataclasses import dataclass

from tpvqa.errors import PluginError, UnknownNameError
from tpvqa_household.images.recipe import Job
from tpvqa_household.images.sources.diffusers_images import STRENGTH, DiffusersImages
from tpvqa_household.images.sources.generator import ImageGenerator
from tpvqa_household.images.sources.openai_images import OpenAIImages
from tpvqa_household.images.sources.rerender import Rerender

NAMES = ("openai", "diffusers", "rerender", "none")


@dataclass(frozen=True, slots=True)
class Options:
    """What can be chosen of generators.

    Attributes:
        base_url: Of an OpenAI-like server.
        price: Dollars a picture of such a server.
        per_minute: Requests a minute to it, at most.
        size: Of the pictures that it is asked for.
        strength: Of a variation by diffusion.
        steps: Of diffusion.
    """

    base_url: str | None = None
    price: float | None = None
    per_minute: float | None = None
    size: str | None = None
    strength: float = STRENGTH
    steps: int | None = None


def generator(
    spec: str, options: Options, jobs: Mapping[str, Job], *, from_prompts: bool
) -> ImageGenerator | None:
    """Make the generator that a specification names; None for "none".

    Args:
        spec: As a user writes it.
        options: For the generators that have them.
        jobs: By visible state, for "rerender".
        from_prompts: Whether it shall make pictures from prompts.

    Raises:
        UnknownNameError: There is no such generator.
        PluginError: It does not say which model, or cannot do what it is chosen for.
        MissingExtraError: It needs a package that is not installed.
    """
    name, _, model = spec.partition(":")
    if name not in NAMES:
        raise UnknownNameError("generator of pictures", name, NAMES)
    if name in ("openai", "diffusers") and not model:
        raise PluginError(f"{spec!r} does not say which model. Write {name}:MODEL.")
    if name in ("rerender", "none") and model:
        raise PluginError(f"{name!r} has no models. Write {name} alone, not {spec!r}.")
    if name == "none":
        return None
    if name == "rerender":
        if from_prompts:
            raise PluginError(
                "'rerender' makes no pictures from prompts. Write --prompts openai:MODEL, "
                "--prompts diffusers:MODEL or --prompts none."
            )
        return Rerender(jobs)
    if name == "diffusers":
        return DiffusersImages(model, strength=options.strength, steps=options.steps)
    return OpenAIImages(
        model,
        base_url=options.base_url,
        price=options.price,
        per_minute=options.per_minute,
        size=options.size,
    )
