"""The risk that a belief monitor states: in its specification, and in words."""

from tpvqa.belief.calibrating.risk import RiskBound, confidence
from tpvqa.errors import PluginError

BELIEF = "belief"
IN_DOUBT = "stop in doubt"
"""How a monitor says first of all that it ends so for the sake of the risk."""
_KEY = "risk"
_MOST_PLACES = 12


def split_risk(spec: str) -> tuple[str, float | None]:
    """The specification of a monitor without its risk, and the risk; None where it states none.

    Raises:
        PluginError: The risk is no number between 0 and 1.

    Example:
        >>> split_risk("belief:question=0.1:risk=.02")
        ('belief:question=0.1', 0.02)
    """
    name, *parts = spec.split(":")
    stated = [part for part in parts if part.partition("=")[0].strip() == _KEY]
    if name.strip() != BELIEF or not stated:
        return spec, None
    risks = [risk_from(part.partition("=")[2], spec) for part in stated]
    if len(risks) > 1:
        raise PluginError(f"{spec!r}: {_KEY} is given twice")
    return ":".join((name, *(part for part in parts if part not in stated))), risks[0]


def risk_from(text: str, spec: str) -> float:
    """Read a risk.

    Raises:
        PluginError: It is no number between 0 and 1.
    """
    try:
        risk = float(text)
    except ValueError:
        risk = -1.0
    if not 0 < risk < 1:
        raise PluginError(
            f"{spec!r} is not understood: a risk lies between 0 and 1; write {BELIEF}:{_KEY}=.02, "
            "say"
        )
    return risk


def bound_for(risk: float | None, bound: RiskBound | None) -> RiskBound | None:
    """What a monitor that states a risk was told of it; None for one that states none.

    Raises:
        PluginError: It was told nothing.
    """
    if risk is not None and bound is None:
        raise PluginError(
            f"A risk of {risk:g} can be stated only of trials like others that were run before, "
            "with the same options: `tpvqa risk TASK … --out risk.json` runs them; then name the "
            "file with --risk-file"
        )
    return None if risk is None else bound


def as_stated(goal: float, bound: RiskBound) -> str:
    """What the goal's probability is, and what it has to be for "done"."""
    goal = confidence(goal)
    if bound.above <= 0:
        return f"the goal holds with {goal:.2f} (no threshold is needed: {_at_most(bound)})"
    shown, above = apart(goal, bound.above)
    if bound.allows(goal):
        return f"the goal holds with {shown}, above {above} ({_at_most(bound)})"
    reported = f"done is reported above {above}" if bound.above < 1 else "done is never reported"
    return f"the goal holds with {shown}, and {reported} ({_at_most(bound)})"


def _at_most(bound: RiskBound) -> str:
    return f"risk at most {bound.risk:g}, by {bound.trials} trials"


def apart(first: float, second: float) -> tuple[str, str]:
    """Two probabilities with so many digits, two or more, as tell them apart and from certainty."""
    both = first, second
    certain = [each in (0.0, 1.0) for each in both]
    for places in range(2, _MOST_PLACES + 1):
        said = f"{first:.{places}f}", f"{second:.{places}f}"
        apart = first == second or said[0] != said[1]
        if apart and [float(each) in (0.0, 1.0) for each in said] == certain:
            break
    return said
