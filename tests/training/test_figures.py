"""What is held back, and the figures on it."""

from collections import Counter
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn import metrics

from tpvqa.errors import TrainingError
from tpvqa.pddl import Atom
from tpvqa.questions import FactQuestion, Way
from tpvqa.training.example import Example, consistent, together
from tpvqa.training.scoring import balanced_by_predicate, scores
from tpvqa.training.splitting import split
from tpvqa.vlm import Answer, Reply


def example(picture: int, text: str = "Is it?", *, truth: bool = True, group: str = "") -> Example:
    return Example(bytes([picture]), "image/png", text, truth, text, group)


EXAMPLES = st.lists(
    st.builds(
        example, st.integers(0, 9), st.sampled_from(["Is it?", "Was it?"]), truth=st.booleans()
    ),
    max_size=40,
)


@given(EXAMPLES, st.floats(0.01, 0.9), st.integers(0, 5))
def test_no_picture_is_on_both_sides(every: list[Example], share: float, seed: int) -> None:
    pictures = {each.picture for each in every}
    if len(pictures) < 2:
        with pytest.raises(TrainingError, match="too few"):
            split(every, share, seed=seed)
        return
    learnt, held = split(every, share, seed=seed)
    back = {each.picture for each in held}
    assert back
    assert back.isdisjoint({each.picture for each in learnt})
    assert Counter(learnt + held) == Counter(every)
    assert len(back) - share * len(pictures) < 1
    assert split(every, share, seed=seed) == (learnt, held)


GROUPED = st.lists(
    st.builds(example, st.integers(0, 9), group=st.sampled_from(["", "a", "b", "c"])),
    min_size=2,
    max_size=30,
)


@given(GROUPED, st.floats(0.01, 0.9), st.integers(0, 5))
def test_neither_a_picture_nor_a_group_is_on_both_sides(
    every: list[Example], share: float, seed: int
) -> None:
    if len(set(together(every).values())) < 2:
        with pytest.raises(TrainingError, match="too few"):
            split(every, share, seed=seed)
        return
    learnt, held = split(every, share, seed=seed)
    assert learnt
    assert held
    assert {e.picture for e in held}.isdisjoint({e.picture for e in learnt})
    assert {e.group for e in held if e.group}.isdisjoint({e.group for e in learnt if e.group})
    backwards = split(every[::-1], share, seed=seed)
    assert Counter(backwards[1]) == Counter(held)


@given(EXAMPLES)
def test_what_is_said_both_ways_teaches_nothing(every: list[Example]) -> None:
    kept = consistent(every)
    keys = [(each.picture, each.text) for each in kept]
    assert len(set(keys)) == len(keys)
    for each in every:
        others = {o.truth for o in every if (o.picture, o.text) == (each.picture, each.text)}
        assert ((each.picture, each.text) in keys) == (len(others) == 1)


def answers(examples: Sequence[Example], p_yes: Sequence[float]) -> list[Answer]:
    return [
        Answer(
            FactQuestion(each.text, Way.PRECONDITION, Atom("asked")),
            Reply.YES if p > 0.5 else Reply.NO,
            p_yes=p,
        )
        for each, p in zip(examples, p_yes, strict=True)
    ]


@settings(max_examples=20, deadline=None)
@given(st.data())
def test_figures_are_those_of_scikit_learn(data: st.DataObject) -> None:
    every = data.draw(EXAMPLES.filter(lambda some: len({each.truth for each in some}) == 2))
    chances = st.floats(0.01, 0.99).filter(lambda p: p != 0.5)
    p = data.draw(st.lists(chances, min_size=len(every), max_size=len(every)))
    truth, said = [each.truth for each in every], np.array(p) > 0.5
    found = scores(every, answers(every, p))
    assert found.accuracy.value == pytest.approx(metrics.accuracy_score(truth, said))
    assert found.balanced_accuracy.value == pytest.approx(
        metrics.balanced_accuracy_score(truth, said)
    )
    assert found.auroc.value == pytest.approx(metrics.roc_auc_score(truth, p))
    assert found.log_loss.value == pytest.approx(metrics.log_loss(truth, p))
    assert found.abstained.value == 0


@given(st.data())
def test_balanced_accuracy_by_predicate_is_that_of_its_questions(data: st.DataObject) -> None:
    every = data.draw(EXAMPLES)
    p = data.draw(st.lists(st.sampled_from([0.1, 0.9]), min_size=40, max_size=40))[: len(every)]
    found = balanced_by_predicate(every, answers(every, p))
    assert set(found) == {each.predicate for each in every}
    for name, value in found.items():
        of = [(e.truth, x > 0.5) for e, x in zip(every, p, strict=True) if e.predicate == name]
        truth, said = zip(*of, strict=True)
        if len(set(truth)) < 2:
            assert value is None
        else:
            assert value == pytest.approx(metrics.balanced_accuracy_score(truth, said))


def test_an_abstention_is_wrong_and_tells_nothing() -> None:
    every = [example(1), example(2, truth=False)]
    silent = [
        Answer(answer.question, Reply.UNKNOWN, leftover=0.9)
        for answer in answers(every, [0.9, 0.9])
    ]
    found = scores(every, silent)
    assert (found.accuracy.value, found.auroc.value, found.abstained.value) == (0, 0.5, 1)
    assert found.log_loss.value == pytest.approx(np.log(2))


def test_intervals_hold_pictures_together() -> None:
    """Twenty questions about one picture are no more than one."""
    alone = [example(n, truth=n % 2 == 0) for n in range(20)]
    p = [0.9 if n % 4 else 0.2 for n in range(20)]
    together = [example(e.data[0], f"Is it {k}?", truth=e.truth) for e in alone for k in range(20)]
    one, many = (
        scores(alone, answers(alone, p)),
        scores(together, answers(together, [x for x in p for _ in range(20)])),
    )
    assert one.accuracy.value == many.accuracy.value
    assert one.accuracy.low == pytest.approx(many.accuracy.low, abs=0.03)
    assert one.accuracy.high == pytest.approx(many.accuracy.high, abs=0.03)
