"""VLMs of known habits, as the answers they would give."""

from collections.abc import Iterator
from math import exp

from tpvqa.belief import LabelledAnswer
from tpvqa.chance import chance
from tpvqa.questions import Way
from tpvqa.vlm import Reply


def trials(
    count: int,
    *,
    accuracy: float = 0.8,
    rho: float = 0.0,
    rho_elsewhere: float | None = None,
    base: float = 0.5,
    facts: int = 5,
    until_pleased: bool = False,
    way: Way = Way.EFFECT,
    predicate: str = "on",
    surer: float | None = None,
) -> Iterator[LabelledAnswer]:
    """Answers about facts that stay as they are, at four looks or until the answer is right.

    Args:
        count: Trials.
        accuracy: Of a fresh answer.
        rho: A further look repeats the last answer.
        rho_elsewhere: The same from another view; every other look is from another view then.
        base: Share of facts that are true.
        facts: Facts of a trial.
        until_pleased: Whether only a wrong answer makes it look again.
        way: The way of asking.
        predicate: What is asked about.
        surer: Gives P(yes) with log odds that are so many times what they should be; None for
            none.
    """
    for trial in range(count):
        for fact in range(facts):
            draw = chance(trial, fact, "talk", predicate, way, base)
            truth = draw.random() < base
            yes = truth
            for look in range(12 if until_pleased else 4):
                view = "side" if rho_elsewhere is not None and look % 2 else "front"
                again = rho if rho_elsewhere is None else rho_elsewhere
                if look == 0 or draw.random() >= again:
                    yes = truth == (draw.random() < accuracy)
                odds = 0.0 if surer is None else surer * 1.386 * (1 if yes else -1)
                yield LabelledAnswer(
                    way=way,
                    predicate=predicate,
                    text=f"{predicate} {fact}?",
                    truth=truth,
                    reply=Reply.YES if yes else Reply.NO,
                    p_yes=None if surer is None else 1 / (1 + exp(-odds)),
                    trial=f"{predicate} {way} {base} {trial}",
                    look=look,
                    view=view,
                )
                if until_pleased and yes == truth:
                    break
