"""How good a VLM is on examples, with intervals."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Atom
from tpvqa.questions import FactQuestion, Way
from tpvqa.training.example import Example
from tpvqa.vlm import VLM, Answer, Reply
from tpvqa.vlm.metrics import auroc
from tpvqa.vlm.sight import ask_seeing

DRAWS = 1000
_LEAST = 1e-6
VIEW = "front"


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure with its interval of 95%; None where there is nothing to count.

    Attributes:
        value: The figure.
        low: Its lower end.
        high: Its upper end.
    """

    value: float | None
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True, slots=True)
class Scores:
    """How good answers are.

    Attributes:
        accuracy: Share of right ones; *unknown* and *cannot see* count as wrong.
        balanced_accuracy: Mean of the accuracies where yes and where no is right.
        auroc: Probability that P(yes) is higher where yes is right; without P(yes) it is .5.
        log_loss: Mean of -log of the probability of the right answer, which is at least 10⁻⁶;
            without P(yes) it is taken to be .5.
        abstained: Share of *unknown* and *cannot see*.
    """

    accuracy: Figure
    balanced_accuracy: Figure
    auroc: Figure
    log_loss: Figure
    abstained: Figure

    def plain(self) -> dict[str, Any]:
        """As JSON has it."""
        return asdict(self)


def answers_to(
    vlm: VLM, examples: Sequence[Example], *, done: Callable[[int, int], None]
) -> list[Answer]:
    """What a VLM answers, all about a picture at once.

    Args:
        vlm: Who answers.
        examples: What is asked.
        done: Told how many answers there are, of how many.

    Raises:
        AnswerError: It cannot be asked.
    """
    told: dict[int, Answer] = {}
    by_picture: dict[str, list[int]] = {}
    for number, each in enumerate(examples):
        by_picture.setdefault(each.picture, []).append(number)
    done(0, len(examples))
    for look, numbers in enumerate(by_picture.values()):
        first = examples[numbers[0]]
        frame = Frame(first.picture, VIEW, first.data, first.media_type)
        asked = [
            FactQuestion(examples[n].text, Way.PRECONDITION, Atom(examples[n].predicate or "asked"))
            for n in numbers
        ]
        seen = Observation(look, 0.0, {VIEW: frame})
        told |= dict(zip(numbers, ask_seeing(vlm, seen, asked), strict=True))
        done(len(told), len(examples))
    return [told[number] for number in range(len(examples))]


def scores(examples: Sequence[Example], answers: Sequence[Answer], *, seed: int = 0) -> Scores:
    """Figures with intervals: pictures are drawn anew, as answers about one hang together.

    Args:
        examples: What was asked.
        answers: What was answered.
        seed: Of the draws.
    """
    truth = np.array([each.truth for each in examples], bool)
    replies = [each.reply for each in answers]
    yes = np.array([reply is Reply.YES for reply in replies], bool)
    no = np.array([reply is Reply.NO for reply in replies], bool)
    p = np.array([0.5 if each.p_yes is None else each.p_yes for each in answers], float)
    right = np.where(truth, yes, no)
    loss = -np.log(np.clip(np.where(truth, p, 1 - p), _LEAST, 1.0))
    measures: list[Callable[[NDArray[np.intp]], float | None]] = [
        lambda rows: _mean(right[rows]),
        lambda rows: _balanced(right[rows], truth[rows]),
        lambda rows: auroc(p[rows], truth[rows]),
        lambda rows: _mean(loss[rows]),
        lambda rows: _mean(~(yes | no)[rows]),
    ]
    names = [each.picture for each in examples]
    _, of = np.unique(names, return_inverse=True)
    rows_of = [np.flatnonzero(of == number) for number in range(int(of.max(initial=-1)) + 1)]
    drawn = _drawn(rows_of, seed)
    every = np.arange(len(examples))
    return Scores(*(_figure(measure, every, drawn) for measure in measures))


def balanced_by_predicate(
    examples: Sequence[Example], answers: Sequence[Answer]
) -> dict[str, float | None]:
    """Balanced accuracy of each predicate's questions; None where one of the answers is right in
    all of them. *Unknown* and *cannot see* count as wrong.

    Args:
        examples: What was asked.
        answers: What was answered.
    """
    by: dict[str, list[tuple[bool, bool]]] = {}
    for each, answer in zip(examples, answers, strict=True):
        right = answer.reply is (Reply.YES if each.truth else Reply.NO)
        by.setdefault(each.predicate, []).append((right, each.truth))
    return {
        name: _balanced(*(np.array(column, bool) for column in zip(*pairs, strict=True)))
        for name, pairs in sorted(by.items())
    }


def _drawn(rows_of: Sequence[NDArray[np.intp]], seed: int) -> list[NDArray[np.intp]]:
    random = np.random.default_rng(seed)
    count = len(rows_of)
    if count < 2:
        return []
    return [
        np.concatenate([rows_of[n] for n in random.integers(0, count, count)]) for _ in range(DRAWS)
    ]


def _figure(
    measure: Callable[[NDArray[np.intp]], float | None],
    every: NDArray[np.intp],
    drawn: Sequence[NDArray[np.intp]],
) -> Figure:
    found = [value for rows in drawn if (value := measure(rows)) is not None]
    if not found:
        return Figure(measure(every))
    low, high = np.quantile(found, (0.025, 0.975))
    return Figure(measure(every), float(low), float(high))


def _mean(values: NDArray[Any]) -> float | None:
    return float(values.mean()) if len(values) else None


def _balanced(right: NDArray[Any], truth: NDArray[np.bool_]) -> float | None:
    on_yes, on_no = _mean(right[truth]), _mean(right[~truth])
    return None if on_yes is None or on_no is None else (on_yes + on_no) / 2
