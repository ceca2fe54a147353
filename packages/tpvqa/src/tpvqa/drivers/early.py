"""What ends a trial early though nothing is broken: the log is ended, and tells why."""

from tpvqa.errors import BudgetError, HaltedError
from tpvqa.trial import Conclusion

EARLY = (BudgetError, HaltedError)


def concluded(error: BudgetError | HaltedError) -> Conclusion:
    """How the trial ends."""
    spent = isinstance(error, BudgetError)
    return Conclusion("budget spent" if spent else "world refused", str(error))
