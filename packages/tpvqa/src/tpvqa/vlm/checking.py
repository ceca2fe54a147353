"""Asking a VLM, which may be anybody's: it may break, and give what it must not."""

import math
from collections.abc import Sequence
from dataclasses import replace
from numbers import Real
from typing import Any

from tpvqa.errors import PluginError
from tpvqa.observation import Observation
from tpvqa.protocols import called_at, short
from tpvqa.questions.question import Question
from tpvqa.vlm.answer import Answer, Reply
from tpvqa.vlm.capabilities import kind_of
from tpvqa.vlm.protocol import VLM

LONGEST = 4000
"""Characters of a VLM's own words that are kept."""
_PROBABILITIES = ("p_yes", "p_cannot_see", "leftover")


def ask_checked(
    vlm: VLM,
    observation: Observation | None,
    questions: Sequence[Question],
    *,
    then: str = "Mend it",
) -> list[Answer]:
    """What a VLM answers, one to each question in order; of words without end the first ones.

    Everybody who asks a VLM does it here.

    Args:
        vlm: Asked once.
        observation: What it is shown; a person who looks at the world is shown nothing.
        questions: What it is asked.
        then: What to do where it broke.

    Raises:
        TpvqaError: What it raised itself.
        PluginError: It raised something else, or gave something else than such answers.
    """
    kind = kind_of(vlm)
    shown: Any = observation
    where = f"{kind.__module__}.{kind.__qualname__}.ask"
    given: object = called_at(where, lambda: vlm.ask(shown, questions), then=then)
    if not isinstance(given, list):
        raise PluginError(f"{where} has to return list, not {short(given)}")
    return _checked(vlm, given, questions)


def _checked(vlm: VLM, answers: list[Answer], questions: Sequence[Question]) -> list[Answer]:
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
    return [_kept(vlm, answer) for answer in answers]


def _kept(vlm: VLM, answer: Answer) -> Answer:
    """An answer as a log can hold it: plain numbers, and of its words only so many."""
    plain: dict[str, Any] = {}
    for name in (*_PROBABILITIES, "seconds"):
        value = getattr(answer, name)
        if value is None and name in _PROBABILITIES:
            continue
        if isinstance(value, bool) or not isinstance(value, Real):
            raise PluginError(f"{vlm.name} has to give {name} as a number, not {value!r:.80}")
        number = float(value)
        most = 1.0 if name in _PROBABILITIES else math.inf
        if not 0 <= number <= most or math.isinf(number):
            expected = "between 0 and 1" if most == 1 else "of 0 or more"
            raise PluginError(
                f"{vlm.name} has to give {name} as a number {expected}, not {value!r:.80}"
            )
        plain[name] = number
    for name in ("text", "source"):
        said = getattr(answer, name)
        if not isinstance(said, str):
            raise PluginError(f"{vlm.name} has to give {name} as a text, not {said!r:.80}")
    text = answer.text
    if len(text) > LONGEST:
        length = f" … ({len(text):,} characters)"
        text = text[: LONGEST - len(length)] + length
    return replace(answer, text=text, **plain)
