"""What one reply says of one question."""

from dataclasses import dataclass

from tpvqa.vlm.answer import Reply


@dataclass(frozen=True, slots=True)
class Reading:
    """What a reply says.

    Attributes:
        reply: Yes, no, or *unknown* for whatever is neither clearly.
        source: "logprobs", "word" or "samples".
        text: The model's words, or why there are none.
        p_yes: P(yes | yes or no); None where it comes from the bare word or is unknown.
        leftover: Probability of neither, where known.
        cut_short: The reply ended at its length limit before a word of the answer.
    """

    reply: Reply
    source: str = "word"
    text: str = ""
    p_yes: float | None = None
    leftover: float | None = None
    cut_short: bool = False
