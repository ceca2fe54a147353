"""How often actions failed in recorded episodes, as what a robot knows before its next trial."""

from collections.abc import Sequence

from tpvqa.belief.calibrating.beta import Beta
from tpvqa.belief.calibrating.counted import LabelledAct, count_faults
from tpvqa.belief.learning.chances import Chances
from tpvqa.belief.learning.experience import Experience
from tpvqa.errors import CalibrationError


def experience_from(acts: Sequence[LabelledAct]) -> Experience:
    """Count the faults of recorded episodes, on top of what is believed of any robot.

    Args:
        acts: What truly came of their actions.

    Raises:
        CalibrationError: Of no action that is known.
    """
    counted = count_faults(acts)
    if counted is None:
        raise CalibrationError(
            "No episode says of an action that could work what truly came of it, as in a simulated "
            "world it would. Leave --experience out: `tpvqa run --experience FILE` learns while "
            "it runs"
        )
    chances, skills = Chances(), counted.skills.values()
    tries = sum(each.failed for each in skills), sum(each.worked for each in skills)
    told: tuple[tuple[Beta, tuple[int, int]], ...] = (
        (chances.failure, tries),
        (chances.disturbance, counted.disturbance),
        (chances.spontaneous, counted.spontaneous),
        (chances.redone, counted.redone),
    )
    for beta, (yes, no) in told:
        beta.yes, beta.no = beta.yes + yes, beta.no + no
    return Experience.of(chances, None, len({act.trial for act in acts}))
