"""A trial from its beginning, or from where it was interrupted, to its end."""

from tpvqa.drivers.early import EARLY, concluded
from tpvqa.drivers.performing import Performer
from tpvqa.drivers.stepping import SteppingTrial
from tpvqa.events import Ended
from tpvqa.trial import Conclusion

INTERRUPTED = Conclusion("cancelled", "interrupted by the user")


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during an episode, whose log has its end: what runs many ends with it.

    Attributes:
        ended: The last event.
    """

    def __init__(self, ended: Ended):
        super().__init__("interrupted")
        self.ended = ended


def run(trial: SteppingTrial, performer: Performer) -> Ended:
    """Do whatever a trial wants done, until it ends.

    Args:
        trial: The trial; not begun yet.
        performer: Does it. Its `cancel` ends the trial early.

    Returns:
        The last event. `completed` means that all goals hold in truth and that the trial ended
        believing so.

    Raises:
        Interrupted: Ctrl-C. The log is ended first, and can be gone on with.
    """
    interrupted = False
    try:
        trial.begin()
        while trial.pending is not None and not performer.cancel.is_set():
            trial.begun()
            trial.send(performer.perform(trial.pending))
        conclusion = trial.conclusion
    except EARLY as error:
        conclusion = concluded(error)
    except KeyboardInterrupt:
        if trial.replaying:  # the log is right as it is
            raise
        conclusion, interrupted = INTERRUPTED, True
    trial.take_over()
    ended = trial.end(conclusion, goal_holds=performer.goal_holds(), unmet=performer.unmet())
    if interrupted:
        raise Interrupted(ended)
    return ended
