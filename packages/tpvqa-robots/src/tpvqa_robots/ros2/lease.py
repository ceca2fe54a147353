"""Who may command a robot: one controller at a time, as long as it is heard."""

from dataclasses import dataclass

EXPIRES = 2.0
"""Seconds after which a controller that is not heard has lost the robot."""


@dataclass
class Lease:
    """One robot's controller.

    Attributes:
        holder: Who has it; None for nobody.
        heard: When that was last heard, in seconds.
    """

    holder: str | None = None
    heard: float = 0.0

    def beat(self, controller: str, now: float) -> bool:
        """A controller was heard, and wants the robot; whether it has it."""
        if self.holder is None or self.expired(now):
            self.holder = controller
        if self.holder != controller:
            return False
        self.heard = now
        return True

    def expired(self, now: float) -> bool:
        """Whether the holder has not been heard for too long."""
        return self.holder is not None and now - self.heard > EXPIRES

    def release(self, controller: str) -> None:
        """A controller gives the robot back."""
        if self.holder == controller:
            self.holder = None
