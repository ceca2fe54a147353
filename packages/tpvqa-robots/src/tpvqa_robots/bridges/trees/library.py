"""What the behaviours derive from, or what is to be installed for it."""

from tpvqa.errors import MissingExtraError
from tpvqa_robots import DISTRIBUTION

try:
    from py_trees.behaviour import Behaviour
    from py_trees.common import Status
except ImportError as error:
    raise MissingExtraError(
        "py_trees", "trees", "A bridge to behaviour trees", distribution=DISTRIBUTION
    ) from error

__all__ = ["GRACE", "PATIENCE", "Behaviour", "Status", "reason"]

PATIENCE = 30.0
"""Seconds for one look with its answers."""
GRACE = 2.0
"""Seconds in which a skill that was told to stop has to stand still."""


def reason(error: BaseException) -> str:
    """What broke, as `feedback_message` says it."""
    return str(error) or type(error).__name__
