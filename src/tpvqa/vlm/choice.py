"""A VLM by its specification: "embedded", "oracle:0.8", "openai:MODEL" or a plug-in's name."""

from typing import cast

from tpvqa import plugins
from tpvqa.errors import AnswerError
from tpvqa.plugins import Kind
from tpvqa.vlm.protocol import VLM, TruthSource


def make_vlm(
    spec: str,
    *,
    truth: TruthSource | None = None,
    seed: int = 0,
    episode: int = 0,
    base_url: str | None = None,
) -> VLM:
    """Make the VLM that a specification names.

    The truth is given to noise models only: classes that say `noise_model = True`. All others
    are made without it, whatever they ask for.

    Args:
        spec: NAME or NAME:ARGUMENTS, see `tpvqa.plugins`.
        truth: What is true in a simulated world.
        seed: The user's seed, for noise models.
        episode: Number of the episode under this seed, for noise models.
        base_url: Address of the server, for VLMs behind one.

    Raises:
        UnknownNameError: No VLM of that name.
        MissingExtraError: It needs an optional package.
        PluginError: It does not take these arguments.
        AnswerError: A noise model, and there is no truth to be had.
    """
    name, arguments = plugins.split(spec)
    target = plugins.load(Kind.VLM, name)
    context: dict[str, object] = {"base_url": base_url}
    if getattr(target, "noise_model", False):
        if truth is None:
            raise AnswerError(
                f"The VLM {spec!r} is a noise model: it answers from the truth of a simulated "
                "world, and there is none here. Choose one that looks at pictures, "
                "e.g. 'embedded'."
            )
        context |= {"truth": truth, "seed": seed, "episode": episode}
    return cast(VLM, plugins.construct(Kind.VLM, name, target, arguments, context))
