"""An answer beside the truth: what a calibration is learnt from."""

from dataclasses import dataclass

from tpvqa.questions.question import Way
from tpvqa.vlm.answer import Reply


@dataclass(frozen=True, slots=True)
class LabelledAnswer:
    """One answer and whether yes was right. Rows of a trial stand in the order of asking.

    Attributes:
        way: The way of asking.
        predicate: The predicate asked about, or the action where a whole action is.
        text: What was asked.
        truth: Whether yes was right when it was asked.
        reply: What the VLM said.
        p_yes: Its P(yes | yes or no), where it gave one.
        trial: Tells trials apart; answers of different trials are independent.
        look: Number of the look within the trial.
        view: Where the picture was taken from, where known.
        part: Tells apart stretches of a trial that are labelled by themselves: answers of two of
            them are never taken for answers about one unchanged fact.
        weight: How many answers it counts for.
        scene: Tells apart the true states of a trial in which it was asked, where that is known.
    """

    way: Way
    predicate: str
    text: str
    truth: bool
    reply: Reply
    p_yes: float | None
    trial: str
    look: int
    view: str | None = None
    part: str = ""
    weight: float = 1.0
    scene: str = ""
