"""Where the robot acts and looks: a `World` protocol and the worlds behind it."""

from tpvqa.worlds.protocol import Execution, Report, Restorable, World

__all__ = ["Execution", "Report", "Restorable", "World"]
