"""What performs the requests of a trial: live, asynchronously, or step by step; or replays them.

The asynchronous driver, `drivers.asynchronous`, is imported where it is used: asyncio takes time.
"""

from tpvqa.drivers.journal import Journal, Listener
from tpvqa.drivers.live import Interrupted, run
from tpvqa.drivers.performing import Parts, Performer
from tpvqa.drivers.stepping import SteppingTrial

__all__ = [
    "Interrupted",
    "Journal",
    "Listener",
    "Parts",
    "Performer",
    "SteppingTrial",
    "run",
]
