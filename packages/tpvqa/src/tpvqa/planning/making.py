"""Planners by name."""

from tpvqa.planning.protocol import Planner
from tpvqa.plugins import Kind, make_from


def make_planner(spec: str) -> Planner:
    """Make the planner of a specification.

    Args:
        spec: NAME or NAME:ARGUMENTS.

    Raises:
        UnknownNameError: Nothing of that name.
        MissingExtraError: An optional package is needed.
        PluginError: It cannot be made, or is no planner.
    """
    made: Planner = make_from(Kind.PLANNER, spec, {}, protocol=Planner)[0]
    return made
