"""Monitors by name."""

from collections.abc import Mapping
from typing import Any

from tpvqa.monitors.protocol import Monitor
from tpvqa.plugins import Kind, make_from


def make_monitor(spec: str, context: Mapping[str, Any]) -> tuple[Monitor, set[str]]:
    """Make the monitor of a specification.

    Args:
        spec: NAME or NAME:ARGUMENTS.
        context: What it may ask for by naming it in its signature.

    Returns:
        The monitor, and the names of what it takes of the context.

    Raises:
        UnknownNameError: Nothing of that name.
        MissingExtraError: An optional package is needed.
        PluginError: It cannot be made, or is no monitor.
    """
    return make_from(Kind.MONITOR, spec, context, protocol=Monitor)
