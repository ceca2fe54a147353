"""Worlds by name. Only those that declare that they are simulated are given a simulation."""

from collections.abc import Mapping
from typing import Any

from tpvqa.plugins import Kind, load_spec, make_from
from tpvqa.worlds.capabilities import is_simulated
from tpvqa.worlds.protocol import World


def make_world(spec: str, context: Mapping[str, Any]) -> tuple[World, set[str]]:
    """Make the world of a specification.

    Args:
        spec: NAME or NAME:ARGUMENTS.
        context: What it may ask for by naming it in its signature.

    Returns:
        The world, and the names of what it takes of the context.

    Raises:
        UnknownNameError: Nothing of that name.
        MissingExtraError: An optional package is needed.
        PluginError: It cannot be made.
    """
    simulated = is_simulated(load_spec(Kind.WORLD, spec))
    entitled = ("simulation",) if simulated else ()
    return make_from(Kind.WORLD, spec, context, entitled=entitled, protocol=World)
