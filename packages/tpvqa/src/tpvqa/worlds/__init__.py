"""Where the robot acts and looks: a `World` protocol and the worlds behind it."""

from tpvqa.worlds.capabilities import Restorable
from tpvqa.worlds.protocol import Execution, Report, World

__all__ = ["Execution", "Report", "Restorable", "World"]
