"""VLMs by name. Only noise models are given the truth."""

from collections.abc import Mapping
from typing import Any

from tpvqa.errors import PluginError, TpvqaError
from tpvqa.plugins import Kind, class_of, load_spec, make_from, split
from tpvqa.vlm.capabilities import SaidInFull, is_noise_model
from tpvqa.vlm.protocol import VLM


def make_vlm(spec: str, context: Mapping[str, Any]) -> tuple[VLM, set[str]]:
    """Make the VLM of a specification.

    Args:
        spec: NAME or NAME:ARGUMENTS.
        context: What it may ask for by naming it in its signature.

    Returns:
        The VLM, and the names of what it takes of the context.

    Raises:
        UnknownNameError: Nothing of that name.
        MissingExtraError: An optional package is needed.
        PluginError: It cannot be made, or it is a noise model and there is no truth here.
    """
    if not is_noise_model(load_spec(Kind.VLM, spec)):
        return make_from(Kind.VLM, spec, context, protocol=VLM)
    if context.get("truth") is None:
        raise PluginError(
            f"The VLM {spec!r} is a noise model: it answers from the truth of a simulated world, "
            "and there is none here. Choose one that looks at pictures, e.g. 'openai:MODEL'."
        )
    entitled = ("truth", "simulation")
    return make_from(Kind.VLM, spec, context, entitled=entitled, protocol=VLM)


def in_full(spec: str) -> str:
    """A specification with what it leaves open, as logs and rows hold it.

    Raises:
        TpvqaError: There is no such VLM, or its arguments are not understood.
    """
    target = class_of(load_spec(Kind.VLM, spec))
    name, arguments = split(spec)
    return f"{name}:{target.in_full(arguments)}" if issubclass(target, SaidInFull) else spec


def as_logged(spec: str) -> str:
    """What the specification of a log means: in one of before, what it meant then.

    A VLM that is not installed is called as the log calls it.

    Raises:
        PluginError: Its arguments are not understood.
    """
    try:
        target = class_of(load_spec(Kind.VLM, spec))
    except TpvqaError:
        return spec
    name, arguments = split(spec)
    return f"{name}:{target.of_before(arguments)}" if issubclass(target, SaidInFull) else spec
