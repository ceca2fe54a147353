"""How far errors that last belong to a fact, and not to the words in which it is asked about."""

from collections.abc import Callable

from tpvqa.errors import PluginError
from tpvqa.questions.question import FactQuestion, Question

SHARED = 0.5
"""How often what lasts of the answers in another wording is what lasts in the first one. That is
assumed: of no VLM answers to several wordings of one fact were recorded."""
WORDS = "words"
"""What stands before that share in a specification."""


def split_words(arguments: str) -> tuple[str, float]:
    """What a noise model is told, and the share behind `:words:`; `SHARED` where none is written.

    Raises:
        PluginError: It is no number between 0 and 1.
    """
    *before, last = arguments.split(":")
    if before[-1:] != [WORDS] and last != WORDS:
        return arguments, SHARED
    try:
        share = float(last)
    except ValueError:
        share = -1.0
    if not 0 <= share <= 1:
        raise PluginError(
            f"'{arguments}' is not understood: behind 'words:' stands how often what lasts of the "
            "answers in another wording is what lasts in the first one, e.g. words:0.5."
        )
    return ":".join(before[:-1]), share


def with_words(spec: str, share: float) -> str:
    """A specification that says the share, where it is not the usual one."""
    return spec if share == SHARED else f"{spec}:{WORDS}:{share:g}"


def words_drawn_for(question: Question, share: float, drawn: Callable[[str, str], float]) -> str:
    """The words for which what lasts is drawn: its own, or those of the first wording.

    Args:
        question: What is asked.
        share: How often it is the first one's.
        drawn: A number in [0, 1) for a purpose and words.
    """
    if not isinstance(question, FactQuestion) or not question.first:
        return question.text
    return question.first if drawn("other words", question.text) < share else question.text
