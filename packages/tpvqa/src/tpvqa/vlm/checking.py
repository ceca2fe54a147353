"""Whether a VLM, which may be anybody's, gave what it has to give."""

from collections.abc import Sequence
from dataclasses import replace
from numbers import Real

from tpvqa.errors import PluginError
from tpvqa.questions.question import Question
from tpvqa.vlm.answer import Answer, Reply
from tpvqa.vlm.protocol import VLM

LONGEST = 4000
"""Characters of a VLM's own words that are kept."""


def checked_answers(vlm: VLM, answers: list[Answer], questions: Sequence[Question]) -> list[Answer]:
    """The same answers, one to each question in order; of words without end the first ones.

    Raises:
        PluginError: They are something else.
    """
    if len(answers) != len(questions) or not all(isinstance(each, Answer) for each in answers):
        kinds = ", ".join(sorted({type(each).__name__ for each in answers})) or "nothing"
        raise PluginError(
            f"{vlm.name} has to give {len(questions)} Answers to {len(questions)} questions, "
            f"and gave {len(answers)} ({kinds})"
        )
    for question, answer in zip(questions, answers, strict=True):
        if answer.question != question:
            raise PluginError(
                f"{vlm.name} has to answer each question in its place, and gave to "
                f"{question.text!r} an answer to {getattr(answer.question, 'text', None)!r}"
            )
        if not isinstance(answer.reply, Reply):
            raise PluginError(f"{vlm.name} has to give a Reply, and gave {answer.reply!r:.80}")
        for name in ("p_yes", "p_cannot_see", "leftover"):
            value = getattr(answer, name)
            if value is not None and (isinstance(value, bool) or not isinstance(value, Real)):
                raise PluginError(f"{vlm.name} has to give {name} as a number, not {value!r:.80}")
    if any(len(answer.text) > LONGEST for answer in answers):
        return [_shorter(answer) for answer in answers]
    return answers


def _shorter(answer: Answer) -> Answer:
    """An answer of whose words only so many are kept as a log can hold."""
    if len(answer.text) <= LONGEST:
        return answer
    said = f" … ({len(answer.text):,} characters)"
    return replace(answer, text=answer.text[: LONGEST - len(said)] + said)
